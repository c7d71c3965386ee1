// SPDX-License-Identifier: MIT
// Binary arithmetic coding with a 32-bit range, one bit at a time, each with its own adaptive probability; rangecoder.c is the same in C.
// Numbers of up to 2^32 are doubles, which represent them exactly.

const TOP = 0x1000000;
const ONE = 65536;
const LEAST = 64;
const SEEN_MAX = 60;

/** Adaptation step, of 65536, by how often the context was used. */
const rates = Uint16Array.from({ length: SEEN_MAX + 1 }, (_, seen) => Math.trunc((10 * ONE) / (10 * seen + 16)));

/** Adaptive probabilities, of 65536, that a bit is 0. */
export class Contexts {
  constructor(count) {
    this.zero = new Uint16Array(count);
    this.seen = new Uint8Array(count);
  }

  learn(at, bit) {
    const p = this.zero[at];
    const rate = rates[this.seen[at]];
    if (this.seen[at] < SEEN_MAX) this.seen[at]++;
    const next = bit ? p - Math.floor((p * rate) / ONE) : p + Math.floor(((ONE - p) * rate) / ONE);
    this.zero[at] = Math.max(LEAST, Math.min(ONE - LEAST, next));
  }
}

export class RangeEncoder {
  constructor(contexts, out) {
    this.contexts = contexts;
    this.out = out;
    this.start = out.length;
    this.low = 0;
    this.range = 0xffffffff;
  }

  /** The top byte of low leaves; what it carries over goes into the bytes before it. */
  #shift() {
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
      this.#shift();
      this.range *= 256;
    }
  }

  put(at, bit) {
    this.#put((this.range >>> 16) * this.contexts.zero[at], bit);
    this.contexts.learn(at, bit);
  }

  /** Both values are as likely. */
  even(bit) {
    this.#put(this.range >>> 1, bit);
  }

  /** Ends the code with as few bytes as it takes; zeros at the end are left out. */
  finish() {
    this.low = Math.ceil(this.low / TOP) * TOP;
    this.#shift();
    while (this.out.length > this.start && this.out.at(-1) === 0) this.out.pop();
  }
}

export class RangeDecoder {
  /** @param {Uint8Array} bytes beyond their end there are zeros */
  constructor(contexts, bytes, at) {
    this.contexts = contexts;
    this.bytes = bytes;
    this.at = at; // of the next byte; may lie beyond the last
    this.range = 0xffffffff;
    this.code = 0;
    for (let i = 0; i < 4; i++) this.code = this.code * 256 + this.#next();
  }

  #next() {
    return this.bytes[this.at++] ?? 0;
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
    const bit = this.#get((this.range >>> 16) * this.contexts.zero[at]);
    this.contexts.learn(at, bit);
    return bit;
  }

  even() {
    return this.#get(this.range >>> 1);
  }

  /** Bytes are left that no encoder would have written. */
  get early() {
    return this.at - 3 < this.bytes.length;
  }
}
