// SPDX-License-Identifier: MIT
import { FAP_VALUES } from './face-track.mjs';

const CHANGE_MS = 90; // of the mouth, from one source to the next: at rest within a tenth of a second after a stop
const UPPER_CHANGE_MS = 250; // of head, eyes and brows
const MOOD_MS = 400; // time in which a still face takes on a mood; slow enough to pass no other motion
const STALL_MS = 160; // how long a face waits for late frames before it goes to rest

/** The FAPs that speech moves also when the face is to keep still: jaw, lips and tongue. */
const moving = (n) => (n >= 3 && n <= 18) || (n >= 43 && n <= 47) || (n >= 51 && n <= 60);

/** FAPs of gaze, pupils and head: idle movement, not mood. */
const looking = (n) => (n >= 23 && n <= 30) || (n >= 48 && n <= 50);

/** @param {Record<number, number>} faps by number @returns {Float32Array} all of them */
export function faceValues(faps) {
  const values = new Float32Array(FAP_VALUES);
  for (const [number, value] of Object.entries(faps)) values[number] = value;
  return values;
}

const ease = (x) => x * x * (3 - 2 * x);

/**
 * Chooses the FAPs to show: those of the audible speech, else of the idle track, else rest. When the source changes (speech
 * ends, is
 * stopped, stalls) it blends from the last values shown.
 */
export class FaceMixer {
  #still = false;

  constructor() {
    this.values = new Float32Array(FAP_VALUES);
    this.pose = null; // values that take the place of all sources
    this.ease = false; // whether a pose is gone over to smoothly, or taken at once
    this.from = new Float32Array(FAP_VALUES);
    this.target = new Float32Array(FAP_VALUES);
    this.mood = new Float32Array(FAP_VALUES); // what a face that keeps still shows beside its lips: that of the idle track
    this.source = null;
    this.since = -Infinity;
    this.seen = -Infinity;
    this.before = -Infinity; // the update before
  }

  get still() {
    return this.#still;
  }

  set still(on) {
    if (on === this.#still) return;
    this.#still = on;
    this.source = undefined; // a change like any other
  }

  /**
   * @param {number} now milliseconds
   * @param {{track: import('./face-track.mjs').FaceTrack, seconds: number, running: boolean, still?: boolean}|null} heard
   *   still: made to keep still, so that what it shows beside the lips are the affects of its text
   * @param {{track: import('./face-track.mjs').FaceTrack, seconds: number}|null} idle
   * @returns {boolean} whether the values have changed
   */
  update(now, heard, idle = null) {
    const shown = this.values.slice();
    if (this.pose) {
      this.#change(now, this.pose);
      if (!this.ease) this.since = -Infinity;
      this.target.set(this.pose);
    } else if (heard && heard.running && heard.track.sample(heard.seconds, this.target)) {
      this.#change(now, heard.track);
      this.seen = now;
    } else if (!heard || now - this.seen > STALL_MS) {
      if (idle && idle.track.sample(idle.seconds, this.target)) {
        this.#change(now, idle.track);
      } else {
        this.#change(now, null);
        this.target.fill(0);
      }
      this.#settle(now);
    }
    const weight = (milliseconds) => ease(Math.min(1, Math.max(0, (now - this.since) / milliseconds)));
    const [mouth, upper] = [weight(CHANGE_MS), weight(UPPER_CHANGE_MS)];
    const affects = !this.pose && this.source === heard?.track && heard?.still;
    for (let n = 0; n < FAP_VALUES; n++) {
      const w = moving(n) ? mouth : upper;
      const target = this.still && !this.pose && !moving(n) ? this.#held(n, affects) : this.target[n];
      this.values[n] = w === 1 ? target : this.from[n] + w * (target - this.from[n]);
    }
    this.before = now;
    return this.values.some((value, n) => value !== shown[n]);
  }

  /** What a still face shows beside the lips: the mood, or a stronger affect of the text. */
  #held(n, affects) {
    const [mood, affect] = [this.mood[n], affects && !looking(n) ? this.target[n] : 0];
    return Math.abs(affect) > Math.abs(mood) ? affect : mood;
  }

  /** The mood of a face that keeps still follows what the idle track shows on the whole. */
  #settle(now) {
    const share = this.still ? 1 - Math.exp(-Math.max(0, Math.min(100, now - this.before)) / MOOD_MS) : 1;
    for (let n = 0; n < FAP_VALUES; n++) {
      const target = looking(n) ? 0 : this.target[n];
      const left = target - this.mood[n];
      this.mood[n] = Math.abs(left) < 0.5 ? target : this.mood[n] + share * left;
    }
  }

  /** Whether it still goes over from one source to another. */
  changing(now) {
    return now - this.since < UPPER_CHANGE_MS;
  }

  #change(now, source) {
    if (source === this.source) return;
    this.source = source;
    this.from.set(this.values);
    this.since = Math.max(this.before, now - CHANGE_MS / 2); // on its way in this frame already
  }
}
