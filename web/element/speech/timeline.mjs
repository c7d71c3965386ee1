// SPDX-License-Identifier: MIT

/**
 * What is on the player's stream of samples: one utterance after the other, each with the place where it begins, and
 * the messages that are due when a place is heard. Positions are samples of the player.
 *
 * @typedef {Object} Item
 * @property {any} utterance whatever the caller gave
 * @property {number} start position of its first sample
 * @property {number} rate positions in a second
 * @property {{position: number, message: any, last: boolean}[]} due in the order of their positions; last: when the
 *   sound has ended, too
 */
export class Timeline {
  constructor() {
    /** @type {Item[]} */
    this.items = [];
  }

  /** Begins an utterance. @returns {Item} */
  add(utterance, start, rate) {
    const item = { utterance, start, rate, due: [] };
    this.items.push(item);
    return item;
  }

  /** Has `message` come up at a time of the utterance, after those of the same time that are there. */
  schedule(item, seconds, message) {
    const position = item.start + seconds * item.rate;
    let at = item.due.length;
    while (at && item.due[at - 1].position > position) at--;
    item.due.splice(at, 0, { position, message, last: false });
  }

  /**
   * Has `message` come up when all before `position` was heard: the utterance's end. What was due later comes up with it:
   * words are told ahead of their sound, and no more sound comes. With `cut` it does not, for nobody hears those words.
   */
  close(item, position, message, cut = false) {
    if (cut) item.due = item.due.filter((entry) => entry.position < position);
    for (const entry of item.due) if (entry.position >= position) Object.assign(entry, { position, last: true });
    item.due.push({ position, message, last: true });
  }

  /**
   * Takes out what is due: [item, message] in their order. What begins at `position` is due when it is running.
   * @param {{position: number, running: boolean}} heard
   */
  take({ position, running }) {
    const taken = [];
    const due = (entry) => entry.position < position || (entry.position === position && (running || entry.last));
    for (const item of this.items) while (item.due.length && due(item.due[0])) taken.push([item, item.due.shift().message]);
    return taken;
  }

  /** Nothing of an utterance that is due after `position` will be. */
  forgetAfter(position) {
    for (const item of this.items) item.due = item.due.filter((entry) => entry.position <= position);
  }

  remove(item) {
    this.items = this.items.filter((other) => other !== item);
  }

  /** The utterance that is heard, and the time in it. @returns {{item: Item, seconds: number}|null} */
  at(position) {
    let found = null;
    for (const item of this.items) if (item.start <= position) found = item;
    return found && { item: found, seconds: (position - found.start) / found.rate };
  }
}
