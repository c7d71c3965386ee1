// SPDX-License-Identifier: MIT

/** A ring buffer of samples. It grows when it must, so that nothing that arrived is ever lost. */
export class Ring {
  /** @param {number} capacity in samples, rounded up to a power of two */
  constructor(capacity = 65536) {
    this.data = new Float32Array(2 ** Math.ceil(Math.log2(capacity)));
    this.head = 0;
    this.length = 0;
  }

  /** @param {Float32Array} block */
  push(block) {
    if (this.length + block.length > this.data.length) this.#grow(this.length + block.length);
    const tail = (this.head + this.length) & (this.data.length - 1);
    const first = Math.min(block.length, this.data.length - tail);
    this.data.set(block.subarray(0, first), tail);
    this.data.set(block.subarray(first), 0);
    this.length += block.length;
  }

  /** Moves up to `count` samples to `out`, from `at` on. Returns how many there were. */
  read(out, at = 0, count = out.length - at) {
    count = Math.min(count, this.length);
    const first = Math.min(count, this.data.length - this.head);
    out.set(this.data.subarray(this.head, this.head + first), at);
    out.set(this.data.subarray(0, count - first), at + first);
    return this.skip(count);
  }

  /** Drops up to `count` samples. Returns how many there were. */
  skip(count) {
    count = Math.min(count, this.length);
    this.head = (this.head + count) & (this.data.length - 1);
    this.length -= count;
    return count;
  }

  #grow(wanted) {
    const grown = new Float32Array(2 ** Math.ceil(Math.log2(wanted)));
    const length = this.length;
    this.read(grown, 0, length);
    this.data = grown;
    this.head = 0;
    this.length = length;
  }
}
