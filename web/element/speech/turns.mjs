// SPDX-License-Identifier: MIT

/**
 * Orders the speech of the page's heads: one head after the other, first come, first served. Utterances of one head may be
 * in flight together; those of another head wait until all of them were heard. A paused or disconnected head blocks no other.
 *
 * A speaker has `polite`, `paused`, `reachable`, and `grant(utterance)`.
 */
export class Turns {
  #active = new Map(); // utterance -> its speaker
  #waiting = []; // {speaker, utterance}

  /**
   * Asks for a turn: now, or later by `grant`.
   * @param {object} speaker @param {object} utterance @param {boolean} [first] before the others of the same speaker
   */
  ask(speaker, utterance, first = false) {
    const own = this.#waiting.findIndex((entry) => entry.speaker === speaker);
    const goesOn = first && [...this.#active.values()].includes(speaker) && !this.#othersThan(speaker);
    if (!speaker.polite || goesOn) this.enter(speaker, utterance);
    else this.#waiting.splice(first && own >= 0 ? own : this.#waiting.length, 0, { speaker, utterance });
    if (this.has(utterance)) speaker.grant(utterance);
    else this.next();
  }

  /** Whether it is its turn. */
  has(utterance) {
    return this.#active.has(utterance);
  }

  /** Speaks whether or not it is its turn: what others have asked for, say. */
  enter(speaker, utterance) {
    this.#active.set(utterance, speaker);
  }

  /** Has had its turn, or does not want it any more. */
  leave(utterance) {
    this.#active.delete(utterance);
    this.#waiting = this.#waiting.filter((entry) => entry.utterance !== utterance);
    this.next();
  }

  /** Could not use its turn: waits again, before all others. */
  giveBack(speaker, utterance) {
    if (!this.#active.delete(utterance)) return;
    const behind = this.#waiting.findIndex((entry) => !entry.returned);
    this.#waiting.splice(behind < 0 ? this.#waiting.length : behind, 0, { speaker, utterance, returned: true });
    this.next();
  }

  /** Something has changed: perhaps it is another's turn. */
  next() {
    for (let i = 0; i < this.#waiting.length; ) {
      const { speaker, utterance } = this.#waiting[i];
      if (!speaker.reachable) i++;
      else if (speaker.polite && this.#othersThan(speaker)) return;
      else {
        this.#waiting.splice(i, 1);
        this.enter(speaker, utterance);
        speaker.grant(utterance);
      }
    }
  }

  #othersThan(speaker) {
    return [...this.#active.values()].some((other) => other !== speaker && !other.paused);
  }
}
