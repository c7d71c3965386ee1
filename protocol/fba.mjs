// SPDX-License-Identifier: MIT
// FBA: face animation parameters at a few kilobits a second. fba.md describes the coding; fba.c is the same in C.
import { FAP_COUNT, faps } from './fap.mjs';

export const FBA_QUALITY = 5;
export const FBA_QUALITY_MAX = 31;
export const FBA_FRAMES_MAX = 64;
const VALUE_MAX = 1 << 24;

const GROUPS = 7;
const CLASSES = 4;
const UNARY = 14;
const PREFIX = 32;
const LONG_BITS = 30;
const CTX_SIGN = (FAP_COUNT + 1) * 6;
const CTX_SIZE = CTX_SIGN + (FAP_COUNT + 1) * 3;
const CTX_LONG = CTX_SIZE + GROUPS * CLASSES * UNARY;
const CTX_MASK = CTX_LONG + GROUPS * PREFIX;
const CTX_HIGH = CTX_MASK + 3;
const CTX_COUNT = CTX_HIGH + 10;

/** The FAP that a FAP moves like; 0 = none. */
const like = new Uint8Array(FAP_COUNT + 1);
for (const [fap, model] of [
  [5, 3], [7, 6], [8, 4], [9, 8], [10, 5], [11, 10], [13, 12], [20, 19], [21, 19], [22, 21], [24, 23], [26, 25],
  [28, 27], [30, 29], [32, 31], [33, 31], [34, 33], [35, 33], [36, 35], [38, 37], [40, 39], [42, 41], [51, 4], [52, 5],
  [53, 6], [54, 7], [55, 8], [56, 9], [57, 10], [58, 11], [59, 12], [60, 13], [62, 61], [66, 65], [68, 67],
])
  like[fap] = model;

const quarters = (n) => {
  if (n >= 43 && n <= 46) return 16;
  if ((n >= 16 && n <= 18) || n === 37 || n === 38 || (n >= 61 && n <= 64)) return 8;
  return n >= 48 && n <= 50 ? 2 : 4;
};

const firsts = [61, 48, 43, 39, 31, 19, 3];
const groupOf = (n) => (n >= 51 && n <= 60 ? GROUPS - 1 : firsts.findIndex((first) => n >= first));

/** The quantiser step of FAP n (3..68), in FAP units. */
export const fbaStep = (n, quality) => Math.max(1, Math.trunc((faps[n].quant_step * quality * quarters(n)) / 4));

const clamp = (x, limit) => Math.max(-limit, Math.min(limit, x));

/** Adaptive probabilities, of 4096, that a bit is 0. */
class Contexts {
  constructor() {
    this.zero = new Uint16Array(CTX_COUNT);
    this.seen = new Uint8Array(CTX_COUNT);
  }

  reset() {
    this.zero.fill(2048).fill(3000, 0, CTX_SIGN);
    this.seen.fill(0);
  }

  learn(at, bit) {
    const rate = Math.min(5, 2 + (this.seen[at] >> 1));
    const p = this.zero[at];
    if (this.seen[at] < 20) this.seen[at]++;
    this.zero[at] = Math.max(16, Math.min(4080, bit ? p - (p >> rate) : p + ((4096 - p) >> rate)));
  }
}

const TOP = 0x1000000;

class RangeEncoder {
  constructor(contexts, out) {
    this.contexts = contexts;
    this.out = out;
    this.start = out.length;
    this.low = 0;
    this.range = 0xffffffff;
  }

  shift() {
    if (this.low >= 2 ** 32) {
      let i = this.out.length - 1;
      while (i >= this.start && ++this.out[i] === 256) this.out[i--] = 0;
      this.low -= 2 ** 32;
    }
    this.out.push(Math.floor(this.low / TOP));
    this.low = (this.low % TOP) * 256;
  }

  #put(bound, bit) {
    if (bit) {
      this.low += bound;
      this.range -= bound;
    } else {
      this.range = bound;
    }
    while (this.range < TOP) {
      this.shift();
      this.range *= 256;
    }
  }

  put(at, bit) {
    this.#put((this.range >>> 12) * this.contexts.zero[at], bit);
    this.contexts.learn(at, bit);
  }

  even(bit) {
    this.#put(this.range >>> 1, bit);
  }

  finish() {
    this.low = Math.ceil(this.low / TOP) * TOP;
    this.shift();
    while (this.out.length > this.start && this.out.at(-1) === 0) this.out.pop();
  }
}

class RangeDecoder {
  constructor(contexts, bytes, at) {
    this.contexts = contexts;
    this.bytes = bytes;
    this.at = at;
    this.range = 0xffffffff;
    this.code = 0;
    for (let i = 0; i < 4; i++) this.code = this.code * 256 + this.#next();
  }

  #next() {
    return this.at < this.bytes.length ? this.bytes[this.at++] : 0;
  }

  #get(bound) {
    const bit = this.code >= bound ? 1 : 0;
    if (bit) {
      this.code -= bound;
      this.range -= bound;
    } else {
      this.range = bound;
    }
    while (this.range < TOP) {
      this.code = (this.code % TOP) * 256 + this.#next();
      this.range *= 256;
    }
    return bit;
  }

  get(at) {
    const bit = this.#get((this.range >>> 12) * this.contexts.zero[at]);
    this.contexts.learn(at, bit);
    return bit;
  }

  even() {
    return this.#get(this.range >>> 1);
  }
}

/** Thrown for a packet that cannot be decoded; all are refused then up to the next one to begin with. */
export class FbaError extends Error {
  name = 'FbaError';
}

/**
 * One frame as this coding has it.
 * @typedef {{mask: Uint8Array, values: Int32Array, viseme: Uint8Array, expression: Uint8Array}} FbaFrame mask: 69
 *   flags by FAP number; values by FAP number; FAP 1 and FAP 2 as in chunk.mjs
 */

/** @returns {FbaFrame} */
export const fbaFrame = () => ({
  mask: new Uint8Array(FAP_COUNT + 1),
  values: new Int32Array(FAP_COUNT + 1),
  viseme: new Uint8Array(4),
  expression: new Uint8Array(6),
});

class State {
  sequence = 0;
  contexts = new Contexts();
  level = new Int32Array(FAP_COUNT + 1);
  slope = new Int32Array(FAP_COUNT + 1);
  weight = new Int32Array(FAP_COUNT + 1);
  mask = new Uint8Array(FAP_COUNT + 1);
  high = new Uint8Array(10);
  steps = new Int32Array(FAP_COUNT + 1);

  reset(quality) {
    this.quality = quality;
    this.contexts.reset();
    for (const array of [this.level, this.slope, this.mask, this.high]) array.fill(0);
    for (let n = 3; n <= FAP_COUNT; n++) {
      this.weight[n] = like[n] ? 256 : 90;
      this.steps[n] = fbaStep(n, quality);
    }
  }

  guess(n) {
    const own = clamp(this.slope[n], 65535);
    const size = Math.abs(own);
    const model = like[n];
    const source = model ? clamp(Math.trunc((clamp(this.slope[model], 65535) * this.steps[model]) / this.steps[n]), 65535) : own;
    const step = (this.weight[n] * source + 128) >> 8;
    return {
      source,
      step,
      zero: n * 6 + Math.min(size, 2) + ((model ? source : step) ? 3 : 0),
      sign: CTX_SIGN + n * 3 + 1 + Math.sign(step || own),
      size: CTX_SIZE + (groupOf(n) * CLASSES + (size > 4 ? 3 : size > 1 ? 2 : size)) * UNARY,
      long: CTX_LONG + groupOf(n) * PREFIX,
    };
  }

  follow(n, guess, step) {
    const weight = this.weight[n] + Math.sign(step - guess.step) * Math.sign(guess.source) * 6;
    this.weight[n] = like[n] ? Math.max(-256, Math.min(400, weight)) : Math.max(-64, Math.min(300, weight));
    this.level[n] += step;
    this.slope[n] = step;
  }
}

const quantise = (value, step) => {
  const v = clamp(value, VALUE_MAX);
  return Math.sign(v) * Math.trunc((Math.abs(v) + (step >> 1)) / step);
};

/** Writes packets; the first of a stream, and any on request, is one that a decoder can begin with. */
export class FbaEncoder {
  #state = new State();
  #started = false;

  constructor(quality = FBA_QUALITY) {
    this.quality = Math.max(0, Math.min(FBA_QUALITY_MAX, quality));
  }

  /**
   * @param {FbaFrame[]} frames up to FBA_FRAMES_MAX
   * @param {boolean} intra a packet to begin with
   * @returns {Uint8Array}
   */
  encode(frames, intra = false) {
    if (frames.length > FBA_FRAMES_MAX) throw new FbaError('more frames than a packet can have');
    const s = this.#state;
    const begins = intra || !this.#started;
    const out = [s.sequence | (begins ? 0x80 : 0)];
    this.#started = true;
    if (begins) {
      out.push(this.quality);
      s.reset(this.quality);
    }
    s.sequence = (s.sequence + 1) & 0x7f;
    const coder = new RangeEncoder(s.contexts, out);
    for (const frame of frames) putFrame(s, coder, frame);
    coder.finish();
    return Uint8Array.from(out);
  }
}

function putFrame(s, coder, frame) {
  const changed = frame.mask.some((flag, n) => n > 0 && flag !== s.mask[n]);
  coder.put(CTX_MASK, changed ? 1 : 0);
  for (let n = 1; changed && n <= FAP_COUNT; n++) coder.put(CTX_MASK + 1 + s.mask[n], frame.mask[n]);
  for (let i = 0; i < 10; i++) {
    const value = i < 4 ? frame.viseme[i] : frame.expression[i - 4];
    if (!frame.mask[i < 4 ? 1 : 2]) continue;
    coder.put(CTX_HIGH + i, value !== s.high[i] ? 1 : 0);
    for (let b = 7; value !== s.high[i] && b >= 0; b--) coder.even((value >> b) & 1);
    s.high[i] = value;
  }
  s.mask.set(frame.mask);
  for (let n = 3; n <= FAP_COUNT; n++) if (frame.mask[n]) putStep(s, coder, n, quantise(frame.values[n], s.steps[n]) - s.level[n]);
}

function putStep(s, coder, n, step) {
  const guess = s.guess(n);
  const error = step - guess.step;
  coder.put(guess.zero, error ? 1 : 0);
  if (error) {
    const rest = Math.abs(error) - 1;
    coder.put(guess.sign, error < 0 ? 1 : 0);
    let i = 0;
    for (; i < UNARY && i < rest; i++) coder.put(guess.size + i, 1);
    if (i < UNARY) {
      coder.put(guess.size + i, 0);
    } else {
      const x = rest - UNARY + 1;
      const bits = 31 - Math.clz32(x);
      for (let b = 0; b < bits; b++) coder.put(guess.long + b, 1);
      coder.put(guess.long + bits, 0);
      for (let b = bits - 1; b >= 0; b--) coder.even((x >>> b) & 1);
    }
  }
  s.follow(n, guess, step);
}

/** Reads packets. */
export class FbaDecoder {
  #state = new State();
  #ready = false;

  /** Has had a packet to begin with, and lost none since. */
  get ready() {
    return this.#ready;
  }

  /**
   * @param {Uint8Array} bytes one packet
   * @param {number} count how many frames it has
   * @returns {FbaFrame[]}
   */
  decode(bytes, count) {
    const was = this.#ready;
    this.#ready = false;
    if (count > FBA_FRAMES_MAX) throw new FbaError('more frames than a packet can have');
    if (!bytes.length) throw new FbaError('an empty packet');
    const s = this.#state;
    const sequence = bytes[0] & 0x7f;
    const begins = bytes[0] >= 0x80;
    if (begins) {
      if (bytes.length < 2 || bytes[1] > FBA_QUALITY_MAX) throw new FbaError('a packet without its quality');
      s.reset(bytes[1]);
    } else if (!was) {
      throw new FbaError('no packet to begin with has come yet');
    } else if (sequence !== s.sequence) {
      throw new FbaError('a packet was lost');
    }
    s.sequence = (sequence + 1) & 0x7f;
    const coder = new RangeDecoder(s.contexts, bytes, begins ? 2 : 1);
    const frames = Array.from({ length: count }, () => getFrame(s, coder));
    this.#ready = true;
    return frames;
  }
}

function getFrame(s, coder) {
  if (coder.get(CTX_MASK)) for (let n = 1; n <= FAP_COUNT; n++) s.mask[n] = coder.get(CTX_MASK + 1 + s.mask[n]);
  for (let i = 0; i < 10; i++) {
    if (!s.mask[i < 4 ? 1 : 2] || !coder.get(CTX_HIGH + i)) continue;
    let value = 0;
    for (let b = 0; b < 8; b++) value = (value << 1) | coder.even();
    s.high[i] = value;
  }
  const frame = fbaFrame();
  frame.mask.set(s.mask);
  if (s.mask[1]) frame.viseme.set(s.high.subarray(0, 4));
  if (s.mask[2]) frame.expression.set(s.high.subarray(4));
  for (let n = 3; n <= FAP_COUNT; n++) {
    if (!s.mask[n]) continue;
    getStep(s, coder, n);
    frame.values[n] = s.level[n] * s.steps[n];
  }
  return frame;
}

function getStep(s, coder, n) {
  const guess = s.guess(n);
  let error = 0;
  if (coder.get(guess.zero)) {
    const negative = coder.get(guess.sign);
    let rest = 0;
    while (rest < UNARY && coder.get(guess.size + rest)) rest++;
    if (rest === UNARY) {
      let bits = 0;
      while (coder.get(guess.long + bits)) if (++bits > LONG_BITS) throw new FbaError('a damaged packet');
      let x = 1;
      for (let b = 0; b < bits; b++) x = x * 2 + coder.even();
      rest = x + UNARY - 1;
    }
    if (rest > 4 * VALUE_MAX) throw new FbaError('a damaged packet');
    error = negative ? -(rest + 1) : rest + 1;
  }
  const step = guess.step + error;
  if (Math.abs(s.level[n] + step) > Math.trunc(VALUE_MAX / s.steps[n]) + 1) throw new FbaError('a damaged packet');
  s.follow(n, guess, step);
}
