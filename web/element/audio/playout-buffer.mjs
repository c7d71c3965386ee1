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

const PREROLL_SECONDS = 0.08;
const PREROLL_MAX_SECONDS = 0.4;
const FADE_SECONDS = 0.005;

/**
 * Plays samples out, quantum by quantum, and says when its output starts and stops running. Positions count the
 * samples of speech that were ever pushed; frames count those of the clock that pulls them. While it runs the two
 * advance together, so that one report for each start and stop tells the other side the position at any time.
 * When samples are late it plays silence at a fixed position, and waits until a little more has arrived than last time.
 *
 * Runs in the audio thread, and without one in the page.
 */
export class PlayoutBuffer {
  /**
   * @param {number} rate in Hz
   * @param {(report: {frame: number, position: number, running: boolean, underruns: number}) => void} report
   */
  constructor(rate, report) {
    this.rate = rate;
    this.report = report;
    this.ring = new Ring(rate);
    this.position = 0;
    this.running = false;
    this.complete = true; // all samples of the speech so far have arrived: do not wait for more
    this.underruns = 0;
    this.preroll = Math.round(PREROLL_SECONDS * rate);
    this.fade = Math.round(FADE_SECONDS * rate);
    this.residue = new Float32Array(0); // what is still to sound of something cut
    this.last = 0;
    this.cut = false;
    this.held = false;
    this.rising = 0; // samples that are still to be faded in
  }

  push(block) {
    this.ring.push(block);
    this.complete = false;
  }

  /** Nothing follows what was pushed, for now. */
  finish() {
    this.complete = true;
  }

  /** Forgets what was not played yet; the rest fades out at once, so that it does not click. */
  flush() {
    if (this.running) {
      const residue = new Float32Array(this.fade);
      this.position += this.ring.read(residue);
      this.residue = residue.map((sample, i) => sample * (1 - (i + 1) / this.fade));
    }
    this.position += this.ring.skip(this.ring.length);
    this.complete = true;
    this.cut = true;
  }

  /** Silence at once; the position stands still until `release`. */
  hold() {
    this.held = true;
  }

  /** Goes on where it was held. */
  release() {
    this.held = false;
  }

  /** Takes out what was not played yet, so that another buffer can go on with it. */
  drain() {
    const rest = new Float32Array(this.ring.length);
    this.ring.read(rest);
    return rest;
  }

  /** Fills `out` with what sounds from clock frame `frame` on. */
  render(out, frame) {
    out.fill(0);
    if (this.cut) this.#stop(frame);
    if (this.held && this.running) this.#halt(frame);
    const ready = this.ring.length && (this.complete || this.ring.length >= this.preroll);
    if (!this.held && !this.running && ready) this.#start(frame);
    if (this.running) this.#play(out, frame);
    if (this.residue.length) this.#fadeOut(out);
  }

  #fadeOut(out) {
    const count = Math.min(out.length, this.residue.length);
    for (let i = 0; i < count; i++) out[i] += this.residue[i];
    this.residue = this.residue.subarray(count);
  }

  #play(out, frame) {
    const got = this.ring.read(out);
    this.position += got;
    for (let i = 0; i < got && this.rising; i++, this.rising--) out[i] *= 1 - this.rising / this.fade;
    if (got) this.last = out[got - 1];
    if (got === out.length) return;
    if (!this.complete) {
      this.underruns++;
      this.preroll = Math.min(Math.round(this.preroll * 1.5), PREROLL_MAX_SECONDS * this.rate);
    }
    this.residue = new Float32Array(got + this.fade).fill(0, 0, got);
    for (let i = 0; i < this.fade; i++) this.residue[got + i] = this.last * (1 - (i + 1) / this.fade);
    this.#stop(frame + got);
  }

  #halt(frame) {
    this.residue = Float32Array.from({ length: this.fade }, (_, i) => this.last * (1 - (i + 1) / this.fade));
    this.rising = this.fade;
    this.#stop(frame);
  }

  #start(frame) {
    this.running = true;
    this.#tell(frame);
  }

  #stop(frame) {
    this.running = false;
    this.cut = false;
    this.#tell(frame);
  }

  #tell(frame) {
    this.report({ frame, position: this.position, running: this.running, underruns: this.underruns });
  }
}
