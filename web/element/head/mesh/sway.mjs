// SPDX-License-Identifier: MIT
// Free ends of hair come after the head: a spring follows how the head is turned, and what it is behind turns them.
import { HEAD_FAPS } from '../model/model.mjs';

const RADIANS = 1e-5; // of a unit of the head's FAPs
const STIFFNESS = (2 * Math.PI * 1.7) ** 2; // 1.7 swings a second
const DAMPING = 2 * 0.4 * Math.sqrt(STIFFNESS); // of which one and a half can be seen
const SHARES = [0.6, 1, 0.8]; // of pitch, yaw and roll: the neck is behind hair that nods
const MOST = 0.13; // radians that ends are behind at most
const STEP = 1 / 120; // seconds
const PAUSE = 0.2; // seconds between pictures, beyond which nothing has been seen to move
const LEAP = 0.3; // radians from a picture to the next: a cut, no movement
const REST = 4e-4; // radians, and ten times that in a second, below which nothing can be seen
const LONG_MM = 200; // from where hair begins to swing to its ends, at most

const AT_REST = [0, 0, 0];

/** The lag of free ends. */
export class Sway {
  #at = null; // seconds
  #follower = [0, 0, 0]; // radians, about x, y and z
  #speed = [0, 0, 0];
  lag = AT_REST; // radians that ends turn about the same axes, seen from the head

  /** Whether it goes on moving while the head stands. */
  get moves() {
    return this.lag !== AT_REST;
  }

  /** How fast ends move, in mm a second, at most. */
  get pace() {
    return LONG_MM * Math.max(...this.#speed.map((speed, k) => SHARES[k] * Math.abs(speed)));
  }

  /**
   * @param {Float32Array} faps by number @param {number|null} seconds of the picture, on any clock; null: nothing sways
   * @returns {number[]} the lag
   */
  follow(faps, seconds) {
    const head = HEAD_FAPS.map((fap) => faps[fap] * RADIANS);
    const gone = this.#at === null || seconds === null ? -1 : seconds - this.#at;
    this.#at = seconds;
    const leaps = head.some((angle, k) => Math.abs(angle - this.#follower[k]) > LEAP);
    if (gone < 0 || gone > PAUSE || leaps) return this.#settle(head);
    for (let left = gone; left > 0; left -= STEP) {
      const step = Math.min(STEP, left);
      for (let k = 0; k < 3; k++) {
        this.#speed[k] += step * (STIFFNESS * (head[k] - this.#follower[k]) - DAMPING * this.#speed[k]);
        this.#follower[k] += step * this.#speed[k];
      }
    }
    const behind = this.#follower.map((angle, k) => angle - head[k]);
    const rests = (values, least) => values.every((x) => Math.abs(x) < least);
    if (rests(behind, REST) && rests(this.#speed, 10 * REST)) return this.#settle(head);
    this.lag = behind.map((x, k) => MOST * Math.tanh((SHARES[k] * x) / MOST));
    return this.lag;
  }

  #settle(head) {
    this.#follower = head;
    this.#speed = [0, 0, 0];
    this.lag = AT_REST;
    return this.lag;
  }
}
