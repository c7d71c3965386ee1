// SPDX-License-Identifier: GPL-3.0-or-later
/** Marker positions over time, from any supported file. */
import { FileError, MOST } from '../import/limits.mjs';

const UNITS = { mm: 1, cm: 10, dm: 100, m: 1000, in: 25.4, millimeters: 1, meters: 1000 };

export class Tracks {
  #places = new Float32Array(3072);

  #count = 0;

  /** @param {string[]} names @param {number} rate frames per second @param {string} [unit] default: mm */
  constructor(names, rate, unit = 'mm') {
    const word = unit.trim().toLowerCase();
    if (word && !UNITS[word]) throw new FileError('', `lengths in ${JSON.stringify(unit.slice(0, 20))}: ${Object.keys(UNITS).slice(0, 5).join(', ')} are known`);
    Object.assign(this, { names, rate, unit: word || 'mm', times: [] });
  }

  /** @param {number} time s @param {(marker: number) => number[]|null} place in the file's unit; null: not seen */
  add(time, place) {
    const width = 3 * this.names.length;
    if (this.#count + width > MOST.numbers) throw new FileError(`frame ${this.times.length + 1}`, `more than ${MOST.numbers / 3} places are not read`);
    if (this.#count + width > this.#places.length) {
      const more = new Float32Array(Math.min(MOST.numbers, 2 * (this.#count + width)));
      more.set(this.#places.subarray(0, this.#count));
      this.#places = more;
    }
    this.names.forEach((_, m) => {
      const seen = place(m);
      for (let k = 0; k < 3; k++) this.#places[this.#count + 3 * m + k] = seen && seen.every(Number.isFinite) ? seen[k] * UNITS[this.unit] : NaN;
    });
    this.#count += width;
    this.times.push(time);
  }

  /** @returns {number[]|null} mm */
  at(frame, marker) {
    const from = 3 * (frame * this.names.length + marker);
    const p = this.#places.subarray(from, from + 3);
    return Number.isNaN(p[0]) ? null : [...p];
  }
}
