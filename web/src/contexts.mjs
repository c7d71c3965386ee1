// SPDX-License-Identifier: MIT

const MOST = 8; // browsers have 8 (phones) or 16 for a page, and take the oldest away from those who want more

/**
 * Who may have a context of the graphics processor: the faces that can be seen, up to a number, and others while there are
 * some left. One that comes into sight takes the place of one that is out of sight.
 *
 * A stage has `visible`, `enter()`, `leave()`, and `refuse()`.
 */
export class Contexts {
  #most;
  #in = new Set();
  #out = new Set(); // in the order in which they have asked

  constructor(most = MOST) {
    this.#most = most;
  }

  /** It wants one, or has changed in `visible`. */
  ask(stage) {
    if (this.#in.has(stage)) {
      if (!stage.visible) this.#serve();
      return;
    }
    this.#out.add(stage);
    this.#serve();
    if (this.#out.has(stage) && stage.visible) stage.refuse();
  }

  leave(stage) {
    this.#out.delete(stage);
    if (this.#in.delete(stage)) this.#serve();
  }

  #serve() {
    for (const stage of [...this.#out].sort((a, b) => b.visible - a.visible)) {
      if (this.#in.size >= this.#most && !(stage.visible && this.#vacate())) return;
      this.#out.delete(stage);
      this.#in.add(stage);
      stage.enter();
    }
  }

  /** @returns {boolean} whether somebody who is not seen has made room */
  #vacate() {
    const unseen = [...this.#in].find((stage) => !stage.visible);
    if (!unseen) return false;
    this.#in.delete(unseen);
    this.#out.add(unseen);
    unseen.leave();
    return true;
  }
}

export const contexts = new Contexts();
