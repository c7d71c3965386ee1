// SPDX-License-Identifier: MIT
import { Resampler } from '../audio/resampler.mjs';
import { CaptionTrack, HeardCaptions } from '../captions/captions.mjs';
import { FaceTrack } from '../face/face-track.mjs';

/** One `speak`, from the call to its end. */
export class Utterance {
  /**
   * @param {string|null} key id sent to the server; null: another client's utterance
   * @param {string} text @param {object} options of `speak` @param {object} [captions] for an unknown text
   * @param {import('./writing.mjs').Writing} [writing] source of a text that is still being written
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
    this.captions ??= this.writing
      ? new HeardCaptions(this.#written(begin.markup))
      : new CaptionTrack(begin.text ?? this.text, begin.markup);
    this.playerRate = rate;
    this.resampler = null; // from the first sound on, whose rate may be the codec's
    this.skipped = 0; // seconds before the resampler's first sample
  }

  #written(markup) {
    return markup === 'plain' && this.options.markup !== 'plain' ? 'markdown' : markup;
  }

  /** It goes on elsewhere: what comes does not follow from what was, so that the face goes over to it (face-mixer.mjs). */
  jump() {
    this.track = new FaceTrack(this.track.fps);
  }

  /** It goes on at another time of its own. */
  seek(seconds) {
    this.jump();
    this.resampler = null;
    this.skipped = seconds;
  }

  /**
   * Takes a chunk. @param {import('../../../protocol/chunk/chunk.mjs').Chunk} chunk with `audioRate` and `audioStart` if
   *   the sound has a clock of its own
   * @returns {Float32Array} samples for the player
   */
  take(chunk) {
    this.track.put(chunk.firstFrame, chunk.frames);
    this.resampler ??= new Resampler(chunk.audioRate ?? chunk.sampleRate, this.playerRate);
    let audio = chunk.audio ?? new Int16Array(chunk.samples);
    const skipped = Math.round(this.skipped * (chunk.audioRate ?? chunk.sampleRate));
    const gap = (chunk.audioStart ?? chunk.start) - skipped - this.resampler.received;
    if (gap > 0) {
      const padded = new audio.constructor(gap + audio.length);
      padded.set(audio, gap);
      audio = padded;
    } else if (gap < 0) {
      audio = audio.subarray(Math.min(-gap, audio.length));
    }
    return this.resampler.push(audio);
  }

  /** Returns the samples left in the resampler after the last chunk. */
  rest() {
    return this.resampler?.finish() ?? new Float32Array(0);
  }
}

/**
 * The order of utterances on the player's stream of samples: the start of each, and the messages that are due when a
 * position is heard. Positions are samples of the player.
 *
 * @typedef {Object} Item
 * @property {any} utterance as given by the caller
 * @property {number} start position of its first sample
 * @property {number} rate positions in a second
 * @property {{position: number, message: any, last: boolean}[]} due in the order of their positions; last: when the
 *   sound has ended, too
 */
export class Timeline {
  constructor() {
    /** @type {Item[]} */
    this.items = [];
  }

  /** Begins an utterance. @returns {Item} */
  add(utterance, start, rate) {
    const item = { utterance, start, rate, due: [] };
    this.items.push(item);
    return item;
  }

  /** Has `message` come up at a time of the utterance, after those of the same time that are there. */
  schedule(item, seconds, message) {
    const position = item.start + seconds * item.rate;
    let at = item.due.length;
    while (at && item.due[at - 1].position > position) at--;
    item.due.splice(at, 0, { position, message, last: false });
  }

  /**
   * Schedules the utterance's end: `message` is due when all before `position` was heard. Messages due later come with it,
   * since words are announced ahead of their sound and no more sound follows. With `cut` they are dropped as unheard.
   */
  close(item, position, message, cut = false) {
    if (cut) item.due = item.due.filter((entry) => entry.position < position);
    for (const entry of item.due) if (entry.position >= position) Object.assign(entry, { position, last: true });
    item.due.push({ position, message, last: true });
  }

  /**
   * Removes the messages that are due and returns [item, message] in order. One at `position` itself is due while running.
   * @param {{position: number, running: boolean}} heard
   */
  take({ position, running }) {
    const taken = [];
    const due = (entry) => entry.position < position || (entry.position === position && (running || entry.last));
    for (const item of this.items) while (item.due.length && due(item.due[0])) taken.push([item, item.due.shift().message]);
    return taken;
  }

  /** Nothing of an utterance that is due after `position` will be. */
  forgetAfter(position) {
    for (const item of this.items) item.due = item.due.filter((entry) => entry.position <= position);
  }

  remove(item) {
    this.items = this.items.filter((other) => other !== item);
  }

  /** The utterance that is heard, and the time in it. @returns {{item: Item, seconds: number}|null} */
  at(position) {
    let found = null;
    for (const item of this.items) if (item.start <= position) found = item;
    return found && { item: found, seconds: (position - found.start) / found.rate };
  }
}
