// SPDX-License-Identifier: MIT

/** How long to wait before the next attempt: doubling, up to a limit, with chance so that not all come back at once. */
export class Backoff {
  constructor({ first = 500, limit = 15000, random = Math.random } = {}) {
    Object.assign(this, { first, limit, random, attempt: 0 });
  }

  /** @returns {number} milliseconds, between half of and the whole step */
  next() {
    const step = Math.min(this.limit, this.first * 2 ** this.attempt++);
    return step * (0.5 + 0.5 * this.random());
  }

  reset() {
    this.attempt = 0;
  }
}
