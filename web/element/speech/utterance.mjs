// SPDX-License-Identifier: MIT
import { Resampler } from '../audio/resampler.mjs';
import { CaptionTrack, HeardCaptions } from '../captions/captions.mjs';
import { FaceTrack } from '../face/face-track.mjs';

/** One `speak`, from the call to its end. */
export class Utterance {
  /**
   * @param {string|null} key what the server is told as its id; null = somebody else's
   * @param {string} text @param {object} options of `speak` @param {object} [captions] where the text is not known
   * @param {import('./writing.mjs').Writing} [writing] who writes the text, while it is spoken
   */
  constructor(key, text, options, captions = null, writing = null) {
    this.key = key;
    this.text = text;
    this.options = options;
    this.captions = captions;
    this.writing = writing;
    this.number = null; // the server's, from `begin` on
    this.sent = false;
    this.cancelled = false;
    this.answer = null; // its `end`, from the server or made here
    this.item = null; // its place on the timeline
    this.promise = new Promise((resolve) => (this.resolve = resolve));
  }

  /** @param {{rate: number, fps: number, markup: string}} begin the server's message @param {number} rate of the player */
  begin(begin, rate) {
    this.number = begin.utterance;
    this.track = new FaceTrack(begin.fps);
    this.captions ??= this.writing ? new HeardCaptions(this.#written(begin.markup)) : new CaptionTrack(this.text, begin.markup);
    this.playerRate = rate;
    this.resampler = null; // from the first sound on, whose rate may be the codec's
  }

  #written(markup) {
    return markup === 'plain' && this.options.markup !== 'plain' ? 'markdown' : markup;
  }

  /** It goes on elsewhere: what comes does not follow from what was, so that the face goes over to it (face-mixer.mjs). */
  jump() {
    this.track = new FaceTrack(this.track.fps);
  }

  /**
   * Takes a chunk in. @param {import('../../../protocol/chunk.mjs').Chunk} chunk; with `audioRate` and `audioStart` where the
   *   sound runs on a clock of its own
   * @returns {Float32Array} samples for the player
   */
  take(chunk) {
    this.track.put(chunk.firstFrame, chunk.frames);
    this.resampler ??= new Resampler(chunk.audioRate ?? chunk.sampleRate, this.playerRate);
    let audio = chunk.audio ?? new Int16Array(chunk.samples);
    const gap = (chunk.audioStart ?? chunk.start) - this.resampler.received;
    if (gap > 0) {
      const padded = new audio.constructor(gap + audio.length);
      padded.set(audio, gap);
      audio = padded;
    } else if (gap < 0) {
      audio = audio.subarray(Math.min(-gap, audio.length));
    }
    return this.resampler.push(audio);
  }

  /** What the resampler still holds, after the last chunk. */
  rest() {
    return this.resampler?.finish() ?? new Float32Array(0);
  }
}
