// SPDX-License-Identifier: MIT
// The operator hears what is said in the room, live, and the last minute of it again. The sound stays in this page.
import { OpusSound } from '../../element/audio/opus.mjs';

const LAST = 60; // s
const AHEAD = 0.15; // s by which sound is scheduled, against jitter
const GAP = 0.4; // s: longer silence is cut when the last minute is played again
const OPUS = 48000; // Hz

const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));

/** Mono samples of 16-bit ones, little-endian. */
function samplesOf(bytes, channels) {
  const view = new DataView(bytes.buffer), frames = Math.floor(bytes.length / 2 / channels);
  return Float32Array.from({ length: frames }, (_, i) => {
    let sum = 0;
    for (let c = 0; c < channels; c++) sum += view.getInt16(2 * (i * channels + c), true);
    return sum / channels / 32768;
  });
}

export class Overhear {
  #sound = new OpusSound();
  #decoding = Promise.resolve(); // the pieces before
  #utterance = { id: null, number: 0, packets: 0 };
  #last = []; // {samples, rate, at}
  #context = null;
  #until = 0; // time of the context
  #again = [];

  /**
   * @param {{hear: HTMLInputElement, again: HTMLElement}} parts
   * @param {object} ports head; log(what, text); changed(on)
   */
  constructor({ hear, again }, { head, log }) {
    Object.assign(this, { hear, again, head });
    hear.addEventListener('change', () => {
      this.#tell();
      log('overhear', hear.checked ? 'on' : 'off');
      if (hear.checked) this.#open();
      else this.forget();
    });
    again.addEventListener('click', () => this.#playAgain());
    head.addEventListener('joined', () => hear.checked && this.#tell());
    head.addEventListener('overheard', ({ detail }) => (this.#decoding = this.#decoding.then(() => this.#take(detail))));
    this.#show();
  }

  /** Without consent nothing is kept. */
  forget() {
    this.#last = [];
    for (const source of this.#again.splice(0)) source.stop();
    this.#show();
  }

  /** How much of the last minute there is, in seconds. */
  get seconds() {
    return this.#last.reduce((sum, { samples, rate }) => sum + samples.length / rate, 0);
  }

  #tell() {
    this.head.overhear(this.hear.checked);
  }

  #open() {
    this.#context ??= new AudioContext();
    this.#context.resume();
  }

  async #take({ id, codec, rate, channels, data }) {
    if (!this.hear.checked) return;
    const bytes = bytesOf(data);
    const samples = codec === 'opus' ? await this.#decode(id, bytes) : samplesOf(bytes, channels);
    if (!samples?.length || !this.hear.checked) return;
    const piece = { samples, rate: codec === 'opus' ? OPUS : rate, at: performance.now() / 1000 };
    this.#last.push(piece);
    while (this.#last.length && this.#last[0].at < piece.at - LAST) this.#last.shift();
    this.#until = this.#play(piece, this.#until);
    this.#show();
  }

  #decode(id, packet) {
    const now = this.#utterance;
    if (now.id !== id) Object.assign(now, { id, number: now.number + 1, packets: 0 });
    return this.#sound.decode({ utterance: now.number, firstPacket: now.packets++, audio: [packet] }).catch(() => null);
  }

  /** @returns {number} when it ends */
  #play({ samples, rate }, from, list) {
    const context = this.#context;
    if (!context) return 0;
    const buffer = context.createBuffer(1, samples.length, rate), source = context.createBufferSource();
    buffer.copyToChannel(samples, 0);
    source.buffer = buffer;
    source.connect(context.destination);
    const at = from < context.currentTime ? context.currentTime + AHEAD : from;
    source.start(at);
    list?.push(source);
    return at + buffer.duration;
  }

  #playAgain() {
    this.#open();
    for (const source of this.#again.splice(0)) source.stop();
    let until = 0, before = null;
    for (const piece of this.#last) {
      if (before !== null && piece.at - before > GAP) until += GAP;
      until = this.#play(piece, until, this.#again);
      before = piece.at;
    }
  }

  #show() {
    this.again.disabled = !this.#last.length;
  }
}
