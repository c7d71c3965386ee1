// SPDX-License-Identifier: MIT
// Reads the face part of an FBA bitstream (ISO/IEC 14496-2, 6.2.10 and 7.12), predictive coding, as web/docs/protocol/fba.md
// describes it. Written apart from the C of this folder, and with other means (sums in an array, one object for each model):
// the tests compare the two.

import { faps } from '../fap.mjs';

const GROUPS = [2, 16, 12, 8, 4, 5, 3, 10, 4, 4]; // FAPs in each
const FAPS = 68;
/** Ranges that hold unless the stream states others, in quantiser steps by FAP number. */
const ranges = (steps) => faps.map((fap) => Math.ceil(fap[steps] / 60) * 60);

const VISEME = [14, 14, 63];
const EXPRESSION = [6, 63, 6, 63];

const OBJECT_START = [0x1ba, 0x101];
const PLANE_START = [0x1bb, 0x103];
const SEQUENCE_END = 0x1b1;

/** A stream that breaks the format; `at` is the byte and `bit` the bit in it where. */
export class FbaError extends Error {
  constructor(message, position) {
    super(`${message} (byte ${position >> 3}, bit ${position & 7})`);
    this.name = 'FbaError';
    this.reason = message;
    this.at = position >> 3;
    this.bit = position & 7;
  }
}

class Bits {
  constructor(bytes, byte) {
    this.bytes = bytes;
    this.at = byte * 8;
    this.size = bytes.length * 8;
  }
  one() {
    const at = this.at++;
    return at < this.size ? (this.bytes[at >> 3] >> (7 - (at & 7))) & 1 : 0;
  }
  take(count) {
    let value = 0;
    for (let i = 0; i < count; i++) value = value * 2 + this.one();
    if (this.at > this.size) throw new FbaError('the stream ends within a frame', this.size);
    return value;
  }
  marker() {
    if (!this.take(1)) throw new FbaError('a marker bit is 0', this.at - 1);
  }
  /** The start code after the stuffing, or -1. */
  code() {
    const byte = (this.at >> 3) + 1;
    const bit = (n) => (this.bytes[(this.at + n) >> 3] >> (7 - ((this.at + n) & 7))) & 1;
    if (byte * 8 - this.at >= 6 && !bit(1) && bit(2)) return -1; // a frame of 6 bits before the code
    if (byte + 4 > this.bytes.length) return -1;
    return this.bytes.slice(byte, byte + 4).reduce((sum, b) => sum * 256 + b, 0);
  }
  skipCode() {
    this.at = ((this.at >> 3) + 5) * 8;
  }
}

/** Frequencies of min..max. */
class Model {
  constructor(min, max) {
    this.min = min;
    this.counts = new Uint16Array(max - min + 1).fill(1);
    this.total = this.counts.length;
  }
  add(symbol) {
    if (this.total === 16383) {
      this.counts.forEach((count, i) => (this.counts[i] = (count + 1) >> 1));
      this.total = this.counts.reduce((sum, count) => sum + count, 0);
    }
    this.counts[symbol]++;
    this.total++;
  }
}

/** A codeword of the arithmetic coder. The first symbol has the top of the interval. */
class Codeword {
  constructor(bits) {
    Object.assign(this, { bits, low: 0, high: 0xffff, code: 0, zeros: 0, ends: [], bad: Infinity });
    for (let i = 0; i < 16; i++) this.next();
  }
  next() {
    if (this.zeros === 22) {
      if (!this.bits.one()) this.bad = Math.min(this.bad, this.bits.at - 1);
      this.zeros = 0;
    }
    const bit = this.bits.one();
    this.zeros = bit ? 0 : this.zeros + 1;
    this.code = this.code * 2 + bit;
    this.ends.push(this.bits.at);
    if (this.ends.length > 16) this.ends.shift();
  }
  /** @param {Model} model @param {boolean} adapt */
  read(model, adapt) {
    const range = this.high - this.low + 1;
    const cumulative = Math.floor(((this.code - this.low + 1) * model.total - 1) / range);
    let symbol = 0;
    let above = model.total; // of the symbol and those after it
    while (above - model.counts[symbol] > cumulative) above -= model.counts[symbol++];
    this.high = this.low - 1 + Math.floor((range * above) / model.total);
    this.low += Math.floor((range * (above - model.counts[symbol])) / model.total);
    for (;;) {
      let base;
      if (this.high < 0x8000) base = 0;
      else if (this.low >= 0x8000) base = 0x8000;
      else if (this.low >= 0x4000 && this.high < 0xc000) base = 0x4000;
      else break;
      this.low = 2 * (this.low - base);
      this.high = 2 * (this.high - base) + 1;
      this.code -= base;
      this.next();
    }
    if (adapt) model.add(symbol);
    return model.min + symbol;
  }
  /** Ends a codeword: of the 16 bits in the register, the encoder wrote two. */
  end() {
    const end = this.ends[1];
    if (this.bad < Math.min(end, this.bits.size)) throw new FbaError('no stuffing bit after 22 zeros', this.bad);
    if (end > this.bits.size) throw new FbaError('the stream ends within a frame', this.bits.size);
    this.bits.at = end;
  }
}

/** Returns the offset behind the start codes of the face object, or -1. */
function findObject(bytes) {
  for (let i = 0; i + 4 <= bytes.length; i++) {
    if (bytes[i] || bytes[i + 1] || bytes[i + 2] !== 1) {
      if (!i) return -1;
      continue;
    }
    if (bytes[i + 3] === (OBJECT_START[0] & 255) || (!i && bytes[3] === (OBJECT_START[1] & 255))) return i + 4;
    if (![0xb0, 0xb2, 0xb5].includes(bytes[i + 3])) return -1;
  }
  return -1;
}

/** @param {Uint8Array} bytes */
export const isFba = (bytes) => findObject(bytes) > 0;

class Reader {
  constructor(bits, most) {
    this.bits = bits;
    this.most = most;
    this.fps = 30;
    this.ranges = [ranges('i_steps'), ranges('i_steps'), ranges('p_steps'), ranges('p_steps')]; // I and P, highest and (negative) lowest
    this.shown = new Int32Array(FAPS + 1);
    this.parts = { viseme: [0, 0, 0], expression: [0, 0, 0, 0] };
    this.mask = null;
    this.interpolated = new Uint8Array(FAPS + 1); // left to the receiver at some time
  }

  times(intra) {
    const { bits } = this;
    if (intra && bits.take(1)) {
      const at = bits.at;
      const rate = bits.take(8) + bits.take(4) / 16;
      const fps = bits.take(1) ? (rate * 1000) / 1001 : rate;
      if (!fps) throw new FbaError('the frame rate is 0', at);
      if (this.mask && fps !== this.fps) throw new FbaError('the frame rate changes', at);
      this.fps = fps;
    }
    if (intra && bits.take(1)) {
      bits.take(11);
      bits.marker();
      bits.take(6);
    }
    let skip = 0;
    if (!bits.take(1)) return skip;
    const at = bits.at;
    for (let more = 15; more === 15; ) {
      skip += more = bits.take(4);
      if (skip > this.most) throw new FbaError('more frames than one file may have', at);
    }
    return skip;
  }

  intraHeader() {
    const { bits } = this;
    this.quant = bits.take(5);
    const mask = new Uint8Array(FAPS + 1);
    let n = 1;
    for (const size of GROUPS) {
      bits.marker();
      const type = bits.take(2);
      for (let i = 0; i < size; i++, n++) {
        mask[n] = type === 3 || (type && bits.take(1)) ? 1 : 0;
        if (type === 2 && !mask[n]) this.interpolated[n] = 1;
      }
    }
    this.mask = mask;
    bits.take(1); // suggested_gender
    if (bits.take(1)) throw new FbaError('segments of 16 frames (DCT coding) are not read', bits.at - 1);
    const stated = [0, 1, 2, 3].map(() => bits.take(1));
    stated.forEach((given, which) => given && this.newRange(this.ranges[which]));
    const levels = (which, k) => Math.trunc(this.ranges[which][k] / (this.quant || 1));
    const models = (high, low) => Array.from({ length: FAPS + 1 }, (_, k) => k > 2 && mask[k] && new Model(-levels(low, k), levels(high, k)));
    [this.intra, this.inter] = [models(0, 1), models(2, 3)];
    const most = (list) => list.map((value) => (value === 63 && this.quant ? Math.trunc((63 + (this.quant >> 1)) / this.quant) : value));
    const high = (sign) => ({ viseme: most(VISEME).map((m) => new Model(sign * m, m)), expression: most(EXPRESSION).map((m) => new Model(sign * m, m)) });
    [this.intraHigh, this.interHigh] = [high(0), high(-1)];
  }

  newRange(range) {
    let n = 3;
    for (const size of GROUPS.slice(1))
      for (let i = 0; i < size; i++, n++) {
        if (i % 4 === 0) this.bits.marker();
        if (this.mask[n]) range[n] = this.bits.take(5) * 60;
      }
  }

  /** A codeword for FAP 1 or 2, and the bits that follow it. */
  high(which, limits, flags, intra) {
    const codeword = new Codeword(this.bits);
    const parts = this.parts[which];
    limits.forEach((limit, i) => {
      const value = codeword.read((intra ? this.intraHigh : this.interHigh)[which][i], !intra) * (limit === 63 ? this.quant || 1 : 1);
      parts[i] = intra ? value : parts[i] + value;
    });
    codeword.end();
    return [...parts.map((value, i) => Math.min(limits[i], Math.max(0, value))), ...Array.from({ length: flags }, () => this.bits.take(1))];
  }

  frame() {
    const { bits } = this;
    if (PLANE_START.includes(bits.code())) bits.skipCode();
    const at = bits.at;
    const intra = bits.take(1) === 1;
    const object = bits.take(2);
    if (object & 2) throw new FbaError('body animation (BAPs) is not read', at + 1);
    if (!object) throw new FbaError('a frame without FAPs', at + 1);
    if (!intra && !this.mask) throw new FbaError('the first frame is no I frame', at);
    const skip = this.times(intra);
    if (intra) {
      this.intraHeader();
      this.shown.fill(0);
    }
    const high = [this.mask[1] ? this.high('viseme', VISEME, 1, intra) : undefined, this.mask[2] ? this.high('expression', EXPRESSION, 2, intra) : undefined];
    const codeword = new Codeword(bits);
    for (let n = 3; n <= FAPS; n++) {
      if (!this.mask[n]) continue;
      const value = codeword.read((intra ? this.intra : this.inter)[n], !intra) * (this.quant ? this.quant * faps[n].quant_step : 1);
      this.shown[n] = intra ? value : this.shown[n] + value;
    }
    codeword.end();
    return { skip, high, values: Int32Array.from(this.shown) };
  }
}

function ended(bits) {
  const left = bits.size - bits.at;
  if (!left || bits.code() === SEQUENCE_END) return true;
  if (left > 8) return false;
  const rest = Array.from({ length: left }, (_, i) => (bits.bytes[(bits.at + i) >> 3] >> (7 - ((bits.at + i) & 7))) & 1);
  return rest.every((bit, i) => bit === (i ? 1 : 0)) || !rest.includes(1);
}

/**
 * @param {Uint8Array} bytes @param {number} most frames
 * @returns {{fps: number, frames: Int32Array[], high: number[][][], masks: Uint8Array[], interpolated: Uint8Array}} values by FAP number, from 3
 *   on; FAPs that are not in a frame's mask are 0. high: FAP 1 and 2 of each frame, where they are in its mask; interpolated: what the
 *   stream leaves to the receiver
 * @throws {FbaError}
 */
export function readFba(bytes, most) {
  const begin = findObject(bytes);
  if (begin < 0) throw new FbaError('no start code of a face object (00 00 01 BA)', 0);
  const bits = new Bits(bytes, begin);
  const next = bytes.slice(begin, begin + 4).reduce((sum, b) => sum * 256 + b, 0);
  if (PLANE_START.includes(next)) bits.at += 32;
  const reader = new Reader(bits, most);
  const [frames, high, masks] = [[], [], []];
  while (!ended(bits)) {
    const { skip, ...frame } = reader.frame();
    for (let i = 0; i <= skip; i++) {
      if (frames.length === most) throw new FbaError('more frames than one file may have', bits.at);
      frames.push(frame.values);
      high.push(frame.high);
      masks.push(reader.mask);
    }
  }
  if (!frames.length) throw new FbaError('there are no frames', bits.at);
  return { fps: reader.fps, frames, high, masks, interpolated: reader.interpolated };
}

/** FAPs whose equal values go together: inner and outer lips, then left and right. */
const LIPS = Array.from({ length: 10 }, (_, i) => [i + 4, i + 51]);
const SIDES = [6, 8, 10, 12, 19, 21, 23, 25, 27, 29, 31, 33, 35, 37, 39, 41, 53, 55, 57, 59, 61, 65, 67].map((n) => [n, n + 1]);

/** Gives frames the FAPs that the stream leaves to the receiver: the other lip's value, or the other side's. @param {ReturnType<typeof readFba>} face */
export function supplyFba(face) {
  const known = new Map(); // a skipped frame is the one before, repeated
  const frames = face.frames.map((values, k) => {
    const mask = face.masks[k];
    if (known.has(values)) return known.get(values);
    const [out, has] = [values.slice(), mask.slice()];
    for (let changed = true; changed; ) {
      changed = false;
      for (const pair of [...LIPS, ...SIDES])
        for (const [n, from] of [pair, [pair[1], pair[0]]]) {
          if (!face.interpolated[n] || has[n] || !has[from]) continue;
          out[n] = out[from];
          has[n] = 1;
          changed = true;
        }
    }
    known.set(values, out);
    return out;
  });
  return { ...face, frames };
}
