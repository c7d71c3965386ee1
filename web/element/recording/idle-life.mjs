// SPDX-License-Identifier: MIT
import { FAP_VALUES } from '../face/face-track.mjs';

// Figures and their sources: server/face/life. Seconds, degrees.
const WAIT = { median: 2.9, deviation: 0.65, shortest: 0.6 }; // from blink to blink
const BLINK = { closing: 0.085, closed: 0.025, opening: 0.165, upper: 900, lower: 124 };
const STAY = { median: 2.7, deviation: 0.6, shortest: 1.2 }; // at the listener
const GONE = { median: 1.25, deviation: 0.5, shortest: 0.35, longest: 3 }; // away from the listener
const AWAY = { smallest: 5, each: 6.9, largest: 20, up: 9, down: 12 };
const SACCADE = { shortest: 0.021, perDegree: 0.0022 };
const POSE = { median: 5.5, deviation: 0.6, shortest: 2, turn: 1.2, pitch: 0.8, yaw: 1.3, roll: 1 };
const BREATH = { seconds: 4, pitch: 0.25 };
const DEGREE = (Math.PI / 180) * 1e5; // in units of the FAPs of turns
const [LIDS_UPPER, LIDS_LOWER, GAZE_YAW, GAZE_PITCH] = [[19, 20], [21, 22], [23, 24], [25, 26]];
const [HEAD_PITCH, HEAD_YAW, HEAD_ROLL] = [48, 49, 50];

const smooth = (x) => {
  const t = Math.min(1, Math.max(0, x));
  return t * t * (3 - 2 * t);
};

/** A movement from one place to another. */
class Shift {
  constructor(size) {
    this.from = this.to = new Array(size).fill(0);
    this.begin = this.seconds = 0;
  }

  at(time) {
    const share = this.seconds ? smooth((time - this.begin) / this.seconds) : 1;
    return this.to.map((end, i) => this.from[i] + share * (end - this.from[i]));
  }

  go(time, to, seconds) {
    Object.assign(this, { from: this.at(time), to, begin: time, seconds });
  }
}

/** Blinks, glances, small movements of the head and breath, for a face that has no server. */
export class IdleLife {
  #random;
  #gaze = new Shift(2); // yaw to the left, pitch down
  #pose = new Shift(3); // pitch, yaw, roll
  #away = false;
  #next = { blink: 1, gaze: 1.5, pose: 1 };
  #blink = -1; // when the last one began

  /** @param {number} life strength, 0 to 2 @param {() => number} random 0 to 1 */
  constructor(life = 1, random = Math.random) {
    this.life = life;
    this.#random = random;
  }

  /** Call with times that only grow. @param {number} time seconds @returns {Int32Array} values by FAP number */
  face(time) {
    const frame = new Int32Array(FAP_VALUES);
    const put = (faps, value) => faps.forEach((n) => (frame[n] = Math.round(this.life * value)));
    this.#plan(time);
    const closed = Math.min(1, this.life) * this.#closed(time - this.#blink);
    for (const n of LIDS_UPPER) frame[n] = Math.round(closed * BLINK.upper);
    for (const n of LIDS_LOWER) frame[n] = Math.round(closed * BLINK.lower);
    const [yaw, pitch] = this.#gaze.at(time);
    put(GAZE_YAW, yaw * DEGREE);
    put(GAZE_PITCH, pitch * DEGREE);
    const [down, left, roll] = this.#pose.at(time);
    put([HEAD_PITCH], (down - BREATH.pitch * Math.sin((2 * Math.PI * time) / BREATH.seconds)) * DEGREE);
    put([HEAD_YAW], left * DEGREE);
    put([HEAD_ROLL], roll * DEGREE);
    return frame;
  }

  #normal() {
    return Math.sqrt(-2 * Math.log(1 - this.#random())) * Math.cos(2 * Math.PI * this.#random());
  }

  #wait({ median, deviation, shortest, longest = Infinity }) {
    return Math.min(longest, Math.max(shortest, median * Math.exp(deviation * this.#normal())));
  }

  #closed(since) {
    const { closing, closed, opening } = BLINK;
    return since < closing ? smooth(since / closing) : 1 - smooth((since - closing - closed) / opening);
  }

  #plan(time) {
    if (time >= this.#next.blink) {
      this.#blink = time;
      this.#next.blink = time + this.#wait(WAIT);
    }
    if (time >= this.#next.gaze) this.#look(time);
    if (time >= this.#next.pose) {
      const to = [POSE.pitch, POSE.yaw, POSE.roll].map((size) => size * this.#normal());
      this.#pose.go(time, to, POSE.turn);
      this.#next.pose = time + this.#wait(POSE);
    }
  }

  #look(time) {
    this.#away = !this.#away;
    const angle = 2 * Math.PI * this.#random();
    const size = this.#away ? Math.min(AWAY.largest, AWAY.smallest - AWAY.each * Math.log(1 - this.#random())) : 0;
    const pitch = Math.min(AWAY.down, Math.max(-AWAY.up, size * Math.sin(angle)));
    this.#gaze.go(time, [size * Math.cos(angle), pitch], SACCADE.shortest + SACCADE.perDegree * size);
    this.#next.gaze = time + this.#wait(this.#away ? GONE : STAY);
  }
}
