// SPDX-License-Identifier: MIT
// The learner's microphone, and the camera if it is allowed. Both are off outside of a recording; pictures stay in the page.
import { Capture, CAPTURE_RATE } from '../../element/audio/capture.mjs';
import { audio } from './take.js';

const MOST_SECONDS = 15;
const PICTURES_A_SECOND = 25;
const LOUD = 0.3; // level that fills the meter
const SETTLE_MS = 150; // after the camera's first picture

/** A mono WAV file of 16 bits. @param {Int16Array[]} blocks */
export function wavOf(blocks, rate = CAPTURE_RATE) {
  const count = blocks.reduce((sum, { length }) => sum + length, 0);
  const view = new DataView(new ArrayBuffer(44 + 2 * count));
  const word = (at, text) => [...text].forEach((letter, i) => view.setUint8(at + i, letter.charCodeAt(0)));
  for (const [at, text] of [[0, 'RIFF'], [8, 'WAVEfmt '], [36, 'data']]) word(at, text);
  const sizes = [[4, 36 + 2 * count], [16, 16], [24, rate], [28, 2 * rate], [40, 2 * count]];
  for (const [at, value] of sizes) view.setUint32(at, value, true);
  for (const [at, value] of [[20, 1], [22, 1], [32, 2], [34, 16]]) view.setUint16(at, value, true);
  let at = 44;
  for (const block of blocks)
    for (const sample of block) {
      view.setInt16(at, sample, true);
      at += 2;
    }
  return view.buffer;
}

export class Recorder {
  #stream = null;
  #capture = null;
  #timer = 0;
  #ended = null;

  /** @param {HTMLVideoElement} preview @param {{level(share: number): void, seconds(n: number): void}} ports */
  constructor(preview, ports) {
    Object.assign(this, { preview, ports });
  }

  get on() {
    return Boolean(this.#stream);
  }

  /**
   * Records until stop(), or for MOST_SECONDS. Fails as getUserMedia does.
   * @param {boolean} camera
   * @returns {Promise<{wav: ArrayBuffer, pictures: {at: number, bitmap: ImageBitmap}[]}>} at: seconds of the sound
   */
  async record(camera) {
    const blocks = [], pictures = [];
    const [echoCancellation, noiseSuppression, autoGainControl] = [false, false, false]; // they change sounds
    const sound = { channelCount: 1, echoCancellation, noiseSuppression, autoGainControl };
    const video = camera && { width: 640, height: 480, facingMode: 'user' };
    this.#stream = await navigator.mediaDevices.getUserMedia({ audio: sound, video });
    try {
      if (camera) await this.#look();
      let began = 0, count = 0;
      const source = audio().createMediaStreamSource(this.#stream);
      this.#capture = await Capture.open(source, (samples) => {
        began ||= performance.now() - (1000 * samples.length) / CAPTURE_RATE;
        blocks.push(samples);
        count += samples.length;
        this.ports.level(Math.min(1, samples.reduce((most, x) => Math.max(most, Math.abs(x)), 0) / 32768 / LOUD));
        this.ports.seconds(Math.floor(count / CAPTURE_RATE));
        if (count >= MOST_SECONDS * CAPTURE_RATE) this.stop();
      });
      const ended = new Promise((resolve) => (this.#ended = resolve));
      if (camera) this.#timer = setInterval(() => this.#keep(pictures, began), 1000 / PICTURES_A_SECOND);
      await ended;
      await Promise.all(pictures.map((picture) => picture.made));
    } finally {
      this.#close();
    }
    return { wav: wavOf(blocks), pictures: pictures.filter(({ bitmap }) => bitmap) };
  }

  stop() {
    this.#ended?.();
  }

  async #look() {
    this.preview.srcObject = this.#stream;
    await this.preview.play();
    await new Promise((resolve) => setTimeout(resolve, SETTLE_MS));
  }

  #keep(pictures, began) {
    if (!began) return;
    const picture = { at: (performance.now() - began) / 1000, bitmap: null };
    picture.made = createImageBitmap(this.preview).then((bitmap) => (picture.bitmap = bitmap), () => {});
    pictures.push(picture);
  }

  #close() {
    clearInterval(this.#timer);
    this.#capture?.close();
    for (const track of this.#stream?.getTracks() ?? []) track.stop();
    this.preview.srcObject = null;
    this.#stream = this.#capture = this.#ended = null;
  }
}
