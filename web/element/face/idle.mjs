// SPDX-License-Identifier: MIT
import { readMix } from './expression.mjs';
import { FaceTrack } from './face-track.mjs';

const AHEAD = 0.15; // seconds that a chunk is to come before it is shown,
const AHEAD_LIVE = 0.06; // or one of a face that is driven, which is short
const LIVE = 0.05; // seconds of such a chunk, at most
const DRIFT = 0.05; // of the difference, for every chunk
const LOST = 1; // seconds behind at which nothing is made up for

/** @typedef {{track: FaceTrack, begin: number, end: number}} Stretch seconds of the idle clock */

/**
 * The face between utterances. Idle media have a clock of their own, which is mapped to the page's; they pause during an
 * utterance and resume where it ended.
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

  /** @param {import('../../../protocol/chunk/chunk.mjs').Chunk} chunk of utterance 0 @param {number} now seconds */
  take(chunk, now) {
    const begin = chunk.start / chunk.sampleRate;
    const ahead = chunk.samples / chunk.sampleRate <= LIVE ? AHEAD_LIVE : AHEAD;
    const stretch = this.next ?? this.shown;
    const follows = stretch && stretch.track.fps === chunk.fps && Math.abs(begin - stretch.end) < 0.01;
    const behind = now - this.base - begin;
    if (!follows || (stretch === this.shown && behind < -LOST)) this.#begin(begin, chunk.fps);
    else if (stretch === this.shown) this.#steer(begin, now, ahead);
    const into = this.next ?? this.shown;
    into.track.put(chunk.firstFrame, chunk.frames);
    into.end = begin + chunk.samples / chunk.sampleRate;
    if (!stretch) this.base = now - begin + ahead;
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

  /** Continues from the last frame shown after an underrun; corrects small clock differences slowly. */
  #steer(begin, now, ahead) {
    this.base = Math.max(this.base, now - this.shown.end);
    this.base += DRIFT * (now - begin + ahead - this.base);
  }
}

/**
 * Asks the server for idle movement and for a mood. It remembers both, and repeats them on a new connection.
 */
export class IdleController {
  /** @param {(message: object) => boolean} send @param {() => void} [changed] there is a mood now, or none any more */
  constructor(send, changed = () => {}) {
    this.send = send;
    this.changed = changed;
    this.face = new IdleFace();
    this.wanted = null; // what idling is to be: null, or further members of the message
    this.asked = 'null'; // the last request, as JSON
    this.mix = []; // what was wished here
    this.room = []; // what the server has told of the room
  }

  /** Whether the face is to show a mood. */
  get moody() {
    return [...this.mix, ...this.room].some(({ intensity }) => intensity !== 0);
  }

  /** The link is new: nothing has been asked for. */
  linked() {
    this.face.reset();
    this.asked = 'null';
    if (this.mix.length) this.send({ type: 'express', mix: this.mix, ease: 0 });
    this.#ask();
  }

  unlinked() {
    this.face.reset();
    this.asked = 'null';
    this.room = []; // told anew
  }

  /** @param {object|null} wanted members of the idle message; null: no idling */
  idle(wanted) {
    this.wanted = wanted;
    this.#ask();
  }

  /**
   * A chunk that was under way when idling was turned off would stay on the face.
   * @param {import('../../../protocol/chunk/chunk.mjs').Chunk} chunk of utterance 0 @param {number} now seconds
   */
  take(chunk, now) {
    if (this.wanted) this.face.take(chunk, now);
  }

  /** @param {object|object[]|string} mix see readMix @param {{ease?: number}} options seconds */
  express(mix, { ease } = {}) {
    this.mix = readMix(mix);
    this.send({ type: 'express', mix: this.mix, ...(ease === undefined ? {} : { ease }) });
    this.changed();
  }

  /** Takes the mood of the room. It replaces the mood requested here, which must not return with the next connection. */
  heard(mix) {
    if (this.mix.length) this.mix = mix;
    this.room = mix;
    this.changed();
  }

  #ask() {
    const wish = JSON.stringify(this.wanted);
    if (wish === this.asked || !this.send({ type: 'idle', on: Boolean(this.wanted), ...this.wanted })) return;
    this.asked = wish;
    if (!this.wanted) this.face.reset();
  }
}
