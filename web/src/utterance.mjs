// SPDX-License-Identifier: MIT
import { Resampler } from './audio/resampler.mjs';
import { CaptionTrack } from './captions.mjs';
import { FaceTrack } from './face-track.mjs';

/** One `speak`, from the call to its end. */
export class Utterance {
  /** @param {string} key what the server is told as its id @param {string} text @param {object} options of `speak` */
  constructor(key, text, options) {
    this.key = key;
    this.text = text;
    this.options = options;
    this.number = null; // the server's, from `begin` on
    this.sent = false;
    this.cancelled = false;
    this.answer = null; // its `end`, from the server or made here
    this.item = null; // its place on the programme
    this.promise = new Promise((resolve) => (this.resolve = resolve));
  }

  /** @param {{rate: number, fps: number, markup: string}} begin the server's message @param {number} rate of the player */
  begin(begin, rate) {
    this.number = begin.utterance;
    this.track = new FaceTrack(begin.fps);
    this.captions = new CaptionTrack(this.text, begin.markup);
    this.resampler = new Resampler(begin.rate, rate);
  }

  /**
   * Takes a chunk in. @param {import('../../protocol/chunk.mjs').Chunk} chunk
   * @returns {Float32Array} samples for the player
   */
  take(chunk) {
    this.track.put(chunk.firstFrame, chunk.frames);
    let audio = chunk.audio ?? new Int16Array(chunk.samples);
    const gap = chunk.start - this.resampler.received;
    if (gap > 0) {
      const padded = new Int16Array(gap + audio.length);
      padded.set(audio, gap);
      audio = padded;
    } else if (gap < 0) {
      audio = audio.subarray(Math.min(-gap, audio.length));
    }
    return this.resampler.push(audio);
  }
}
