// SPDX-License-Identifier: MIT

const ZERO_CROSSINGS = 16; // of the kernel, to each side
const KAISER_BETA = 9; // about 90 dB
const PHASES_MAX = 4096;

/** Modified Bessel function of the first kind, order 0, by its power series. */
function bessel0(x) {
  let sum = 1;
  for (let term = 1, k = 1; term > 1e-12 * sum; k++) {
    term *= (x / (2 * k)) ** 2;
    sum += term;
  }
  return sum;
}

const gcd = (a, b) => (b ? gcd(b, a % b) : a);

/**
 * Changes the sampling rate of a stream by a windowed-sinc filter. Output sample m stands at the input's time
 * m / to, so that nothing is shifted, and a stream cut into blocks gives the same as in one piece.
 */
export class Resampler {
  /** @param {number} from @param {number} to rates in Hz */
  constructor(from, to) {
    const divisor = gcd(Math.round(from), Math.round(to));
    this.step = Math.round(from) / divisor; // the input advances step/phases samples for each output sample
    this.phases = Math.round(to) / divisor;
    this.cutoff = Math.min(1, to / from) * 0.97;
    this.half = Math.ceil(ZERO_CROSSINGS / Math.min(1, to / from));
    this.input = new Float32Array(this.half - 1); // silence before the first sample
    this.base = 1 - this.half; // number of the sample input[0]
    this.next = 0; // number of the next output sample
    this.received = 0;
    if (this.phases !== this.step) this.#makeTable();
  }

  /** Returns the number of output samples for `samples` input samples. */
  outputLength(samples) {
    return Math.ceil((samples * this.phases) / this.step);
  }

  /** @param {Int16Array|Float32Array} block 16 bit, or -1..1 @returns {Float32Array} output that is ready */
  push(block) {
    const scale = block instanceof Int16Array ? 1 / 32768 : 1;
    const joined = new Float32Array(this.input.length + block.length);
    joined.set(this.input);
    for (let i = 0; i < block.length; i++) joined[this.input.length + i] = block[i] * scale;
    this.input = joined;
    this.received += block.length;
    const known = this.table ? this.received - this.half : this.received;
    return this.#make(this.outputLength(Math.max(0, known)));
  }

  /** The rest, after the last block. */
  finish() {
    const received = this.received;
    const rest = new Float32Array(this.half);
    const joined = new Float32Array(this.input.length + rest.length);
    joined.set(this.input);
    this.input = joined;
    return this.#make(this.outputLength(received));
  }

  #makeTable() {
    this.taps = 2 * this.half;
    this.rows = Math.min(this.phases, PHASES_MAX);
    this.table = new Float32Array(this.rows * this.taps);
    for (let row = 0; row < this.rows; row++) {
      const fraction = row / this.rows;
      for (let tap = 0; tap < this.taps; tap++) {
        const x = tap - (this.half - 1) - fraction;
        const window = bessel0(KAISER_BETA * Math.sqrt(Math.max(0, 1 - (x / this.half) ** 2))) / bessel0(KAISER_BETA);
        const angle = Math.PI * x * this.cutoff;
        this.table[row * this.taps + tap] = this.cutoff * (angle ? Math.sin(angle) / angle : 1) * window;
      }
    }
  }

  #make(until) {
    const out = new Float32Array(Math.max(0, until - this.next));
    for (let i = 0; i < out.length; i++, this.next++) {
      const numerator = this.next * this.step;
      const whole = Math.floor(numerator / this.phases);
      if (!this.table) {
        out[i] = this.input[whole - this.base];
        continue;
      }
      const row = Math.floor(((numerator - whole * this.phases) * this.rows) / this.phases) * this.taps;
      const first = whole - this.half + 1 - this.base;
      let sum = 0;
      for (let tap = 0; tap < this.taps; tap++) sum += this.table[row + tap] * this.input[first + tap];
      out[i] = sum;
    }
    const keep = Math.floor((this.next * this.step) / this.phases) - this.half + 1;
    if (keep > this.base) {
      this.input = this.input.slice(keep - this.base);
      this.base = keep;
    }
    return out;
  }
}
