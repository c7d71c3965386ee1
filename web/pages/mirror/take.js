// SPDX-License-Identifier: MIT
// A recording of FAPs as they came, which becomes a .fap file at even steps. No page needed: tests/web reads this.
import { FAPS, writeFap } from '../player/file.js';

export const SECONDS_MAX = 600;
const FPS = 25;

export class Take {
  #frames = []; // {time, faps}

  /** @param {number} time seconds @param {Record<number, number>} faps @returns {boolean} false: it is full */
  add(time, faps) {
    if (this.#frames.length && time <= this.#frames.at(-1).time) return true;
    this.#frames.push({ time, faps });
    return this.seconds < SECONDS_MAX;
  }

  get seconds() {
    return this.#frames.length ? this.#frames.at(-1).time - this.#frames[0].time : 0;
  }

  /** @param {string} name @returns {string} */
  file(name) {
    const [first] = this.#frames;
    let at = 0;
    const frames = Array.from({ length: Math.floor(this.seconds * FPS) + 1 }, (_, k) => {
      const time = first.time + k / FPS;
      while (at + 2 < this.#frames.length && this.#frames[at + 1].time <= time) at++;
      const [a, b] = [this.#frames[at], this.#frames[Math.min(at + 1, this.#frames.length - 1)]];
      const share = b.time > a.time ? Math.min(1, Math.max(0, (time - a.time) / (b.time - a.time))) : 0;
      const frame = new Int32Array(FAPS + 1);
      for (const [fap, value] of Object.entries(a.faps))
        frame[fap] = Math.round(value + share * ((b.faps[fap] ?? value) - value));
      return frame;
    });
    return writeFap({ name, fps: FPS, frames, high: [] });
  }
}
