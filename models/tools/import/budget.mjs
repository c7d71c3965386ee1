// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * What one file may ask for, whatever its kind: numbers that are kept at once, and steps of work. A small file can ask for much (a node that is used
 * again and again, a list that is unpacked, a face of ten thousand corners), so that a reader says what it is about to do before it does it.
 */
import { FileError, MOST } from './file-error.mjs';

const STEPS = 4e8; // a few seconds of work

export class Budget {
  #numbers = 0;
  #steps = 0;

  /** @param {{numbers?: number, steps?: number}} [most] */
  constructor({ numbers = MOST.numbers, steps = STEPS } = {}) {
    this.most = { numbers, steps };
  }

  /** How many numbers may still be kept. */
  get left() {
    return this.most.numbers - this.#numbers;
  }

  /** Before `count` numbers are kept. @param {string|(() => string)} place of what wants them @throws {FileError} */
  keep(count, place) {
    this.#numbers += count;
    if (!(this.#numbers <= this.most.numbers)) throw new FileError(placeOf(place), `more than ${this.most.numbers} numbers are wanted up to here: no head has so many`);
  }

  /** Before `steps` are done. @param {string|(() => string)} place @throws {FileError} */
  work(steps, place) {
    this.#steps += steps;
    if (!(this.#steps <= this.most.steps)) throw new FileError(placeOf(place), 'what is wanted up to here takes longer than any head');
  }
}

const placeOf = (place) => (typeof place === 'function' ? place() : place);
