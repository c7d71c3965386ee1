// SPDX-License-Identifier: MIT
// Finds where somebody begins and ends to speak, by loudness over the noise of the room.
const OVER = 10; // dB over the noise
const LEAST = -52; // dB of full scale: quieter is nobody
const BEGIN = 0.1; // s of loud sound
const END = 0.8; // s of quiet
const RISE = 3; // dB/s by which the noise may grow; it falls at once
const RISE_SPEAKING = 0.5;

const levelOf = (samples) => 10 * Math.log10(samples.reduce((sum, x) => sum + x * x, 0) / samples.length / 32768 ** 2 + 1e-10);

export class Endpoint {
  speaking = false;
  #noise = -45; // dB
  #loud = 0; // s
  #quiet = 0; // s

  /** Seconds of quiet within what is being said. */
  get quiet() {
    return this.speaking ? this.#quiet : 0;
  }

  /** @param {number} rate samples a second */
  constructor(rate) {
    this.rate = rate;
  }

  /**
   * @param {Int16Array} samples some 20 ms
   * @param {number} [more] dB over the noise in addition, while the page itself makes a sound
   * @returns {'begin'|'end'|null}
   */
  push(samples, more = 0) {
    if (!samples.length) return null;
    const seconds = samples.length / this.rate, level = levelOf(samples);
    const loud = level > Math.max(this.#noise + OVER, LEAST) + more;
    this.#noise = Math.min(level, this.#noise + (this.speaking ? RISE_SPEAKING : RISE) * seconds);
    this.#noise = Math.max(this.#noise, -90);
    this.#loud = Math.max(0, this.#loud + (loud ? seconds : -seconds));
    this.#quiet = loud ? 0 : this.#quiet + seconds;
    if (!this.speaking && this.#loud >= BEGIN) return this.#change(true);
    if (this.speaking && this.#quiet >= END) return this.#change(false);
    return null;
  }

  #change(speaking) {
    this.speaking = speaking;
    this.#loud = this.#quiet = 0;
    return speaking ? 'begin' : 'end';
  }
}
