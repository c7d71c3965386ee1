// SPDX-License-Identifier: MIT
import { CAPTURE_RATE } from './audio/capture.mjs';

/** What the server is told of one who speaks himself; all else is a matter of texts. */
const MEMBERS = ['id', 'lang', 'engine', 'fps', 'life', 'still', 'mode', 'priority', 'topic', 'lookahead'];

/** Somebody's own voice, as the server hears it: what is said before its turn comes is passed over. */
export class OwnVoice {
  /**
   * @param {(message: object) => boolean} send @param {(samples: Int16Array) => boolean} sendSound
   * @param {(voice: OwnVoice) => void} cancel
   */
  constructor(send, sendSound, cancel) {
    this.send = send;
    this.sendSound = sendSound;
    this.cancelled = cancel;
    this.key = null; // what the server knows it by, once it has been asked for
    this.closed = false;
    /** @type {Promise<object>} the `end` message, as of `speak` */
    this.done = null;
  }

  /** @param {Int16Array} samples mono, CAPTURE_RATE */
  write(samples) {
    if (this.key && !this.closed && samples.length) this.sendSound(samples);
  }

  /** Nothing more is said. */
  close() {
    if (this.closed) return;
    this.closed = true;
    if (this.key) this.send({ type: 'close', id: this.key });
    else this.cancelled(this);
  }

  /** It is cut. */
  cancel() {
    this.closed = true;
    this.cancelled(this);
  }

  /** Its turn has come. @param {object} speak the message of a text @returns {boolean} whether it went out */
  begin(speak) {
    const members = Object.fromEntries(MEMBERS.filter((name) => speak[name] !== undefined).map((name) => [name, speak[name]]));
    if (!this.send({ ...members, type: 'voice', codec: 'pcm_s16le', rate: CAPTURE_RATE, channels: 1 })) return false;
    this.key = speak.id;
    return true;
  }
}
