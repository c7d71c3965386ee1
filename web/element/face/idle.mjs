// SPDX-License-Identifier: MIT
import { FaceTrack } from './face-track.mjs';

const AHEAD = 0.15; // seconds that a chunk is to come before it is shown
const DRIFT = 0.05; // of the difference, for every chunk
const LOST = 1; // seconds behind at which nothing is made up for

/** @typedef {{track: FaceTrack, begin: number, end: number}} Stretch seconds of the idle clock */

/**
 * The face while nobody speaks. Its media come on a clock of their own and are shown on the page's; they pause for an
 * utterance and go on after it where that ended.
 */
export class IdleFace {
  constructor() {
    this.reset();
  }

  /** Forgets everything: the server begins anew. */
  reset() {
    /** @type {Stretch|null} */
    this.shown = null;
    /** @type {Stretch|null} */
    this.next = null; // to be shown when what is spoken has been heard
    this.base = 0; // the page's time of the idle clock's 0, s
    this.away = false;
  }

  /** @param {import('../../../protocol/chunk.mjs').Chunk} chunk of utterance 0 @param {number} now seconds */
  take(chunk, now) {
    const begin = chunk.start / chunk.sampleRate;
    const stretch = this.next ?? this.shown;
    const follows = stretch && stretch.track.fps === chunk.fps && Math.abs(begin - stretch.end) < 0.01;
    const behind = now - this.base - begin;
    if (!follows || (stretch === this.shown && behind < -LOST)) this.#begin(begin, chunk.fps);
    else if (stretch === this.shown) this.#steer(begin, now);
    const into = this.next ?? this.shown;
    into.track.put(chunk.firstFrame, chunk.frames);
    into.end = begin + chunk.samples / chunk.sampleRate;
    if (!stretch) this.base = now - begin + AHEAD;
  }

  /** Something else is shown: an utterance. */
  leave() {
    this.away = true;
  }

  /**
   * @param {number} now seconds @param {number} ahead seconds
   * @returns {{track: FaceTrack, seconds: number}|null} what to show then
   */
  at(now, ahead = 0) {
    if (!this.shown) return null;
    const time = () => now + ahead - this.base;
    if (this.next && (this.away || time() > this.shown.end)) {
      this.shown = this.next;
      this.next = null;
      this.base = now - this.shown.begin;
    }
    this.away = false;
    const { track, begin, end } = this.shown;
    track.forgetBefore(time());
    return { track, seconds: Math.max(begin, Math.min(time(), end - 1 / track.fps)) };
  }

  #begin(begin, fps) {
    const stretch = { track: new FaceTrack(fps), begin, end: begin };
    if (this.shown) this.next = stretch;
    else this.shown = stretch;
  }

  /** When all has been shown before more came, it goes on from there; small differences are worked off slowly. */
  #steer(begin, now) {
    this.base = Math.max(this.base, now - this.shown.end);
    this.base += DRIFT * (now - begin + AHEAD - this.base);
  }
}
