// SPDX-License-Identifier: MIT

const MOST = 8; // browsers have 8 (phones) or 16 for a page, and take the oldest away from a page that wants more

/**
 * Allots WebGL contexts: to visible faces up to a limit, and to others while some are left. A face that becomes visible takes
 * the context of a hidden one.
 *
 * A stage has `visible`, `enter()`, `leave()`, and `refuse()`.
 */
export class Contexts {
  #most;
  #later;
  #in = new Set();
  #out = new Set(); // in the order of their requests
  #due = false;

  /** @param {number} most @param {(call: () => void) => void} later calls when all that are seen at once have said so */
  constructor(most = MOST, later = (call) => setTimeout(call)) {
    this.#most = most;
    this.#later = later;
  }

  /** It wants one, or has changed in `visible`. */
  ask(stage) {
    if (!this.#in.has(stage)) this.#out.add(stage);
    this.#fill();
    if (!this.#out.size || this.#due) return;
    this.#due = true;
    this.#later(() => {
      this.#due = false;
      this.#exchange();
    });
  }

  /** Whether it may have one now. */
  has(stage) {
    return this.#in.has(stage);
  }

  leave(stage) {
    this.#out.delete(stage);
    this.#in.delete(stage);
    this.#fill();
  }

  /** Grants free contexts. */
  #fill() {
    for (const stage of this.#wanting()) if (this.#in.size < this.#most) this.#enter(stage);
  }

  /** Those in sight take the places of those out of sight. */
  #exchange() {
    for (const stage of this.#wanting()) {
      if (!stage.visible) return;
      const unseen = [...this.#in].find((other) => !other.visible);
      if (!unseen) stage.refuse();
      else {
        this.#in.delete(unseen);
        this.#out.add(unseen);
        unseen.leave();
        this.#enter(stage);
      }
    }
  }

  #wanting() {
    return [...this.#out].sort((a, b) => b.visible - a.visible);
  }

  #enter(stage) {
    this.#out.delete(stage);
    this.#in.add(stage);
    stage.enter();
  }
}

export const contexts = new Contexts();
