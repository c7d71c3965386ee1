// SPDX-License-Identifier: GPL-3.0-or-later
/** Errors with their place in a file, and the limits of what a file may ask for. */

/** An error in a file with its place: a line, a byte, or a member such as "accessors[3]". */
export class FileError extends Error {
  constructor(place, what) {
    super(place ? `${place}: ${what}` : what);
    this.place = place;
  }
}

/** Limits: more than any head needs, but little enough for memory. */
export const MOST = { bytes: 256 << 20, numbers: 12e6, meshes: 512, depth: 64, image: 8 << 20 };

const STEPS = 4e8; // a few seconds of work

/**
 * Limits for one file of any format: numbers in memory, and steps of work. A small file can require much (a node used again and again, a compressed
 * list, a face of ten thousand corners), so readers must declare memory and work in advance.
 */
export class Budget {
  #numbers = 0;
  #steps = 0;

  /** @param {{numbers?: number, steps?: number}} [most] */
  constructor({ numbers = MOST.numbers, steps = STEPS } = {}) {
    this.most = { numbers, steps };
  }

  /** Numbers that may still be stored. */
  get left() {
    return this.most.numbers - this.#numbers;
  }

  /** Call before storing `count` numbers. @param {string|(() => string)} place in the file @throws {FileError} */
  keep(count, place) {
    this.#numbers += count;
    if (!(this.#numbers <= this.most.numbers)) throw new FileError(placeOf(place), `more than ${this.most.numbers} numbers are wanted up to here: no head has so many`);
  }

  /** Call before doing `steps` of work. @param {string|(() => string)} place @throws {FileError} */
  work(steps, place) {
    this.#steps += steps;
    if (!(this.#steps <= this.most.steps)) throw new FileError(placeOf(place), 'what is wanted up to here takes longer than any head');
  }
}

const placeOf = (place) => (typeof place === 'function' ? place() : place);
