// SPDX-License-Identifier: MIT
// Breath of chest and shoulders. FAPs have none; heads that say what a breath moves (protocol/head-model.md) show it.
import { FAP_VALUES } from './face-track.mjs';

const PERIOD_S = [3.6, 4.5]; // at rest
const [IN, OUT] = [0.34, 0.46]; // of a period: breathing out takes longer, then the chest rests
const REST = 0.85; // how deep breaths at rest are
const DRAWN_S = 0.28; // time constant of a breath drawn for speech,
const SPENT_S = 3.2; // and of what a phrase uses
const LEFT = 0.2; // of the breath, at the end of a long phrase
const RESTING_S = 0.35; // time constant at rest, and from speech to rest
const AHEAD_S = [0.12, 0.28, 0.44]; // a breath begins before the phrase: lips that rest at these times do so in a pause
const SPEAKS = 30; // FAP units that lips move in between, which do not rest
const NOD = 5000; // 1e-5 rad of a nod that is a whole beat
const BEAT = 0.14; // of a breath
const SLOW_S = 0.8; // time constant of where the head is held
const LAPSE_S = 0.25; // at most, between pictures
const GONE = 2e-3;

const MOUTH = [3, 4, 5, 6, 7, 8, 9, 10, 11, 51, 52, 59, 60];

const smooth = (x) => x * x * (3 - 2 * x);

/** The same number, 0 to 1, for the same breath. */
const varied = (n) => Math.abs((Math.sin(n * 127.1 + 311.7) * 43758.5453) % 1);

/** How full the lungs are of one who rests. @param {number} phase of a period, 0 to 1 */
export const restingBreath = (phase) =>
  phase < IN ? smooth(phase / IN) : phase < IN + OUT ? 1 - smooth((phase - IN) / OUT) : 0;

export class Breath {
  #level = 0; // 0: breathed out, 1: full
  #phase = 0; // in the breath at rest
  #count = 0; // breaths at rest
  #pitch = 0; // where the head is held, slowly
  #before = -Infinity; // seconds
  #samples = AHEAD_S.map(() => new Float32Array(FAP_VALUES));

  /**
   * @param {number} now seconds
   * @param {{track: import('./face-track.mjs').FaceTrack, seconds: number}|null} speech what is heard, if anything is spoken
   * @param {number} amount of breath at rest and beats: 0 to 1; 0 ends it
   * @param {number} pitch FAP 48 as it is shown
   * @returns {number} how far chest and shoulders have risen: about 0 to 1
   */
  at(now, speech, amount, pitch) {
    const passed = Math.min(LAPSE_S, Math.max(0, now - this.#before));
    this.#before = now;
    const nod = Math.max(-1, Math.min(1, (pitch - this.#pitch) / NOD));
    this.#pitch += (pitch - this.#pitch) * (1 - Math.exp(-passed / SLOW_S));
    const [goal, slow] = speech ? this.#spoken(speech, amount) : [amount * REST * this.#rested(passed), RESTING_S];
    this.#level += (goal - this.#level) * (1 - Math.exp(-passed / slow));
    if (!goal && this.#level < GONE) this.#level = 0;
    return this.#level && this.#level - amount * (speech ? BEAT * nod : 0); // a nod goes down
  }

  /** Whether it still shows. */
  get shows() {
    return this.#level > 0;
  }

  #rested(passed) {
    const [least, most] = PERIOD_S;
    this.#phase += passed / (least + (most - least) * varied(this.#count));
    if (this.#phase >= 1) {
      this.#phase %= 1;
      this.#count++;
    }
    return restingBreath(this.#phase);
  }

  /** Drawn while the mouth is about to rest, used while it speaks. @returns {[number, number]} goal, and time constant */
  #spoken({ track, seconds }, amount) {
    this.#phase = 1 - 1e-6; // after speech, a new breath
    if (seconds < AHEAD_S[1]) return [amount, DRAWN_S];
    const known = AHEAD_S.every((ahead, i) => track.sample(seconds + ahead, this.#samples[i]));
    const [a, b, c] = this.#samples;
    const moved = () => MOUTH.reduce((sum, n) => sum + Math.abs(b[n] - a[n]) + Math.abs(c[n] - b[n]), 0);
    return known && moved() < SPEAKS ? [amount, DRAWN_S] : [amount * LEFT, SPENT_S];
  }
}
