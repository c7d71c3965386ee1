// SPDX-License-Identifier: MIT
// Movements of a head in company, in FAP units: it turns to the other head, nods and raises its brows after a sentence that it
// has heard, and blinks while its idle movement rests.

const DEGREE = 1745.33; // of the FAPs for angles
const TURN_S = 0.22; // time constant of each of two filters
/** Degrees to the partner's side. A face that speaks stays nearly in front, for those who read lips. */
const LISTENING = { head: 10, eyes: 12 };
const SPEAKING = { head: 4, eyes: 5 };

const NOD_DEGREES = [2.5, 5];
const NOD_S = [0.4, 0.6];
const NOD_AFTER_S = [0.1, 0.45]; // after the sentence has been heard
const NOD_SHARE = 0.65; // of the sentences
const TWICE_SHARE = 0.35; // of the nods; the second one is smaller
const BROWS = { faps: [31, 32, 33, 34, 35, 36], amount: 70, seconds: 1.1 };

/** As in server/face/life. */
const BLINK = { upper: 940, lower: 84, closing: 0.085, closed: 0.025, opening: 0.165, every: [2.2, 5.5] };

const smooth = (x) => x * x * (3 - 2 * x);

/** A bump from 0 to 1 to 0. */
const bump = (x) => (x <= 0 || x >= 1 ? 0 : Math.sin(Math.PI * x) ** 2);

export class Company {
  #turn = [0, 0]; // head and eyes, degrees, filtered once and twice
  #eyes = [0, 0];
  #before = null;
  #moves = []; // of this listener: {at, seconds, degrees} or {at, seconds, brows}
  #blink = 0;
  #random;

  /** @param {() => number} [random] from 0 to 1 */
  constructor(random = Math.random) {
    this.#random = random;
  }

  /** Whether it moves. */
  get moving() {
    return this.#moves.length > 0 || [...this.#turn, ...this.#eyes].some((degrees) => Math.abs(degrees) > 0.05);
  }

  /**
   * A sentence has been heard by this listener.
   * @param {number} now seconds @param {string} text of it
   */
  heardSentence(now, text) {
    const asked = /\?["'»”’)\s]*$/u.test(text);
    const at = now + this.#between(NOD_AFTER_S);
    if (asked) this.#moves.push({ at, seconds: BROWS.seconds, brows: BROWS.amount });
    else if (this.#random() < NOD_SHARE) {
      const [degrees, seconds] = [this.#between(NOD_DEGREES), this.#between(NOD_S)];
      this.#moves.push({ at, seconds, degrees });
      if (this.#random() < TWICE_SHARE) this.#moves.push({ at: at + 0.9 * seconds, seconds, degrees: 0.6 * degrees });
    }
  }

  /**
   * @param {number} now seconds @param {Float32Array} values of the face, which are added to
   * @param {{side: number, speaks: boolean, blinks: boolean}} how side: where the other is, 1: to the right of the picture,
   *   -1: to the left, 0: nowhere; blinks: the face has no idle movement of its own
   */
  add(now, values, { side, speaks, blinks }) {
    const step = this.#before === null ? 0 : Math.min(0.1, Math.max(0, now - this.#before));
    this.#before = now;
    const { head, eyes } = speaks ? SPEAKING : LISTENING;
    const yaw = this.#follow(this.#turn, side * head, step);
    const look = this.#follow(this.#eyes, side * eyes, step);
    values[49] += DEGREE * yaw; // to the subject's left, the picture's right
    values[23] += DEGREE * look;
    values[24] += DEGREE * look;
    this.#moves = this.#moves.filter(({ at, seconds }) => now < at + seconds);
    if (speaks) this.#moves.length = 0;
    for (const { at, seconds, degrees = 0, brows = 0 } of this.#moves) {
      const share = bump((now - at) / seconds);
      values[48] += DEGREE * degrees * share;
      values[25] -= DEGREE * degrees * share; // the eyes stay where they look
      values[26] -= DEGREE * degrees * share;
      for (const n of BROWS.faps) values[n] += brows * share;
    }
    if (blinks) this.#addBlink(now, values);
  }

  #follow(filter, to, step) {
    const share = 1 - Math.exp(-step / TURN_S);
    filter[0] += share * (to - filter[0]);
    filter[1] += share * (filter[0] - filter[1]);
    return filter[1];
  }

  #addBlink(now, values) {
    const { upper, lower, closing, closed, opening, every } = BLINK;
    const into = now - this.#blink;
    if (into > closing + closed + opening + 10) this.#blink = now + this.#random() * every[0]; // it begins to listen
    else if (into > closing + closed + opening) this.#blink = now + this.#between(every);
    if (into <= 0) return;
    const after = into - closing - closed;
    const shut = into < closing ? smooth(into / closing) : after < 0 ? 1 : 1 - smooth(Math.min(1, after / opening));
    for (const n of [19, 20]) values[n] += shut * upper;
    for (const n of [21, 22]) values[n] += shut * lower;
  }

  #between([from, to]) {
    return from + this.#random() * (to - from);
  }
}
