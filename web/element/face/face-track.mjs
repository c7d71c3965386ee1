// SPDX-License-Identifier: MIT

export const FAP_VALUES = 69; // by FAP number; entry 0 is the breath: see breath.mjs
const KEPT_SECONDS = 2;

/** The slope that a curve through three points, equally far apart, may have at the middle one without overshooting. */
function slope(before, here, after) {
  const left = here - before;
  const right = after - here;
  return left * right <= 0 ? 0 : (2 * left * right) / (left + right);
}

/**
 * The FAP frames of one utterance, and the face between them: cubic pieces that pass through every frame, smooth and
 * without overshoot, so that a closure stays exactly closed (Fritsch and Carlson 1980, with harmonic mean slopes).
 */
export class FaceTrack {
  /** @param {number} fps */
  constructor(fps) {
    this.fps = fps;
    this.frames = new Map();
    this.first = Infinity;
    this.last = -Infinity;
  }

  /** @param {number} number of the first frame @param {Int32Array[]} frames values by FAP number */
  put(number, frames) {
    frames.forEach((frame, i) => this.frames.set(number + i, frame));
    if (!frames.length) return;
    this.first = Math.min(this.first, number);
    this.last = Math.max(this.last, number + frames.length - 1);
  }

  /** Forgets what lies well before that time. */
  forgetBefore(seconds) {
    for (const end = Math.floor((seconds - KEPT_SECONDS) * this.fps); this.first < Math.min(end, this.last); this.first++)
      this.frames.delete(this.first);
  }

  /** Frame k or, beyond what there is, the nearest. */
  #frame(k) {
    return this.frames.get(Math.min(this.last, Math.max(this.first, k)));
  }

  /**
   * Interpolates the face at a time of the utterance.
   * @param {number} seconds @param {Float32Array} out FAP_VALUES of them
   * @returns {boolean} false before the first frame has come
   */
  sample(seconds, out) {
    const place = seconds * this.fps;
    if (!this.frames.size || place < this.first - 1 || place > this.last + 1) return false;
    const k = Math.floor(Math.min(this.last, Math.max(this.first, place)));
    const t = Math.min(1, Math.max(0, place - k));
    const [a, b, c, d] = [this.#frame(k - 1), this.#frame(k), this.#frame(k + 1), this.#frame(k + 2)];
    if (!a || !b || !c || !d) return false; // a hole
    const toB = 1 - t * t * (3 - 2 * t);
    const slopeB = t * (1 - t) * (1 - t);
    const slopeC = t * t * (t - 1);
    for (let n = 0; n < FAP_VALUES; n++) {
      if (b[n] === c[n]) out[n] = b[n];
      else out[n] = b[n] * toB + c[n] * (1 - toB) + slopeB * slope(a[n], b[n], c[n]) + slopeC * slope(b[n], c[n], d[n]);
    }
    return true;
  }
}
