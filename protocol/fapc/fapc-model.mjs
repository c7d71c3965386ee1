// SPDX-License-Identifier: MIT
// Predicts FAPC values and codes the prediction errors; fapc_model.c is the same in C. Integers only.
import prior from './fapc-prior.json' with { type: 'json' };
import { FAP_COUNT, faps } from '../fap.mjs';
import { Contexts } from './rangecoder.mjs';

export const VALUE_MAX = 1 << 24;
export const WEIGHTS = 7;
export const ZEROS = 24;
export const SIGNS = 15;
export const CLASSES = 6;
export const UNARY = 12;
const LONG = 32;
const LONG_BITS = 30;
const INPUT_MAX = 1 << 20;
const SEEN = 6; // how much the probabilities of the table count for
const ACTIVE = 16; // where the activity begins
export const GROUPS = prior.zero.length;

export const CTX_SIGN = (FAP_COUNT + 1) * ZEROS;
export const CTX_SIZE = CTX_SIGN + (FAP_COUNT + 1) * SIGNS;
export const CTX_LONG = CTX_SIZE + GROUPS * CLASSES * UNARY;
export const CTX_MASK = CTX_LONG + GROUPS * LONG;
export const CTX_HIGH = CTX_MASK + 3;
export const CTX_COUNT = CTX_HIGH + 10;

/** Upper bounds of the activity classes. */
const bounds = [5, 16, 48, 160, 500, Infinity];

const empty = { group: 0, models: [], eighths: 8, weights: Array(WEIGHTS).fill(0), exact: Array(WEIGHTS).fill(0) };
/** Entries of the prior table, by FAP. */
export const habits = Array.from({ length: FAP_COUNT + 1 }, (_, n) => prior.faps.find((fap) => fap.number === n) ?? empty);

/** The quantiser step of FAP n (3..68), in FAP units. */
export const fapcStep = (n, quality) => Math.max(1, (faps[n].quant_step * quality * habits[n].eighths) >> 3);

/** Thrown for a packet that cannot be decoded; all are refused then up to the next one to begin with. */
export class FapcError extends Error {
  name = 'FapcError';
}

const clamp = (x, limit) => Math.max(-limit, Math.min(limit, x));

function begin(contexts) {
  contexts.zero.fill(32768);
  contexts.seen.fill(0);
  const from = (at, values) => {
    contexts.zero.set(values, at);
    contexts.seen.fill(SEEN, at, at + values.length);
  };
  for (let n = 3; n <= FAP_COUNT; n++) {
    from(n * ZEROS, prior.zero[habits[n].group]);
    from(CTX_SIGN + n * SIGNS, prior.sign[habits[n].group]);
  }
  prior.size.forEach((values, group) => from(CTX_SIZE + group * CLASSES * UNARY, values));
}

/** State shared by encoder and decoder: both update it in the same way with every frame. */
export class State {
  sequence = 0;
  quality = 0;
  contexts = new Contexts(CTX_COUNT);
  level = new Int32Array(FAP_COUNT + 1); // of the latest frame, in steps
  value = [0, 1, 2, 3].map(() => new Int32Array(FAP_COUNT + 1)); // of the latest frame and those before it
  error = new Int32Array(FAP_COUNT + 1); // of the guesses of this frame, in steps
  activity = new Int32Array(FAP_COUNT + 1);
  steps = new Int32Array(FAP_COUNT + 1);
  mask = new Uint8Array(FAP_COUNT + 1);
  high = new Uint8Array(10); // FAP 1 and FAP 2

  reset(quality) {
    this.quality = quality;
    begin(this.contexts);
    for (const array of [this.level, ...this.value, this.mask, this.high]) array.fill(0);
    this.activity.fill(ACTIVE);
    for (let n = 3; n <= FAP_COUNT; n++) this.steps[n] = fapcStep(n, quality);
  }

  nextFrame() {
    for (let age = 3; age > 0; age--) this.value[age].set(this.value[age - 1]);
    this.error.fill(0);
  }

  /** Inputs of the prediction. */
  inputs(n) {
    const [now, a, b, c] = this.value;
    const [m, k] = habits[n].models;
    return [a[n] - b[n], b[n] - c[n], m ? now[m] - a[m] : 0, k ? now[k] - a[k] : 0, a[n], m ? a[m] : 0, k ? a[k] : 0];
  }

  guess(n) {
    const { models, group } = habits[n];
    const weights = this.quality ? habits[n].weights : habits[n].exact;
    const unit = 4096 * this.steps[n];
    const inputs = this.inputs(n);
    let sum = this.value[1][n] * 4096;
    for (let i = 0; i < WEIGHTS; i++) sum += weights[i] * clamp(inputs[i], INPUT_MAX);
    const level = Math.floor((2 * sum + unit) / (2 * unit));
    const rest = sum - level * unit; // from -unit/2 up to unit/2
    const active = this.activity[n];
    const size = bounds.findIndex((bound) => active < bound);
    const model = models.length ? Math.sign(this.error[models[0]]) : 0;
    return {
      level,
      zero: n * ZEROS + Math.min(size, 3) * 6 + (model ? 3 : 0) + Math.min(2, Math.floor((6 * Math.abs(rest)) / unit)),
      sign: CTX_SIGN + n * SIGNS + (model + 1) * 5 + clamp(Math.floor((10 * rest + unit) / (2 * unit)), 2) + 2,
      size: CTX_SIZE + (group * CLASSES + size) * UNARY,
      long: CTX_LONG + group * LONG,
    };
  }

  follow(n, level, error) {
    this.level[n] = level;
    this.value[0][n] = level * this.steps[n];
    this.error[n] = error;
    this.activity[n] = ((this.activity[n] * 5) >> 3) + 16 * Math.min(255, Math.abs(error));
  }
}

/** To the nearest step, halves away from 0. */
function quantise(value, step) {
  const v = clamp(value, VALUE_MAX);
  return Math.sign(v) * Math.trunc((Math.abs(v) + (step >> 1)) / step);
}

export function putValue(s, coder, n, value) {
  const guess = s.guess(n);
  const level = quantise(value, s.steps[n]);
  const error = level - guess.level;
  coder.put(guess.zero, error ? 1 : 0);
  if (error) {
    const rest = Math.abs(error) - 1;
    coder.put(guess.sign, error < 0 ? 1 : 0);
    for (let i = 0; i < UNARY && i <= rest; i++) coder.put(guess.size + i, i < rest ? 1 : 0);
    if (rest >= UNARY) {
      const x = rest - UNARY + 1;
      const bits = 31 - Math.clz32(x);
      for (let b = 0; b < bits; b++) coder.put(guess.long + b, 1);
      coder.put(guess.long + bits, 0);
      for (let b = bits - 1; b >= 0; b--) coder.even((x >>> b) & 1);
    }
  }
  s.follow(n, level, error);
}

export function getValue(s, coder, n) {
  const guess = s.guess(n);
  let error = 0;
  if (coder.get(guess.zero)) {
    const negative = coder.get(guess.sign);
    let rest = 0;
    while (rest < UNARY && coder.get(guess.size + rest)) rest++;
    if (rest === UNARY) {
      let bits = 0;
      while (coder.get(guess.long + bits)) if (++bits > LONG_BITS) throw new FapcError('a damaged packet');
      let x = 1;
      for (let b = 0; b < bits; b++) x = x * 2 + coder.even();
      rest = x + UNARY - 1;
    }
    error = negative ? -(rest + 1) : rest + 1;
  }
  const level = guess.level + error;
  if (Math.abs(level) > Math.trunc(VALUE_MAX / s.steps[n]) + 1) throw new FapcError('a damaged packet');
  s.follow(n, level, error);
}
