// SPDX-License-Identifier: MIT
// Attention to somebody who speaks: she looks at them, holds her head almost still, and nods where they pause.
const EASE_MS = 350; // to look at the speaker, and away
const LEFT = 0.2; // of the idle movement of eyes and head
const NOD_MS = 620; // down and up
const NOD = 7500; // 1e-5 rad, some 4 degrees
const APART_MS = 1600; // between nods

const LOOKING = [23, 24, 25, 26, 49, 50]; // FAPs of eyes and head; 48 has the nod
const PITCH = 48;

export class Attention {
  #on = false;
  #weight = 0;
  #before = -Infinity;
  #nodded = -Infinity;

  /** Somebody speaks to her, or has ended. */
  set on(on) {
    this.#on = on;
  }

  /** Whether eyes or head still move for it. */
  active(now) {
    return this.#on || this.#weight > 0 || now - this.#nodded < NOD_MS;
  }

  /** @param {number} now milliseconds */
  nod(now) {
    if (this.#on && now - this.#nodded > APART_MS) this.#nodded = now;
  }

  /** @param {Float32Array} values FAPs of her own @param {number} now @returns {Float32Array} those to show */
  apply(values, now) {
    const step = Math.max(0, Math.min(100, now - this.#before)) / EASE_MS;
    this.#before = now;
    this.#weight = Math.max(0, Math.min(1, this.#weight + (this.#on ? step : -step)));
    if (!this.active(now)) return values;
    const shown = values.slice(), w = this.#weight * this.#weight * (3 - 2 * this.#weight);
    for (const n of [...LOOKING, PITCH]) shown[n] *= 1 - w * (1 - LEFT);
    const t = (now - this.#nodded) / NOD_MS;
    if (t < 1) shown[PITCH] += NOD * Math.sin(Math.PI * t) ** 2;
    return shown;
  }
}
