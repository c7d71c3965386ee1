// SPDX-License-Identifier: MIT
import { CAPTURE_RATE } from '../audio/capture.mjs';
import { BYTES, VoiceCoder } from '../audio/voice-coder.mjs';

/** Members of `speak` that a `voice` message has too; the others concern texts. */
const MEMBERS = ['id', 'lang', 'engine', 'fps', 'life', 'still', 'mode', 'priority', 'topic', 'lookahead'];

/** A live voice that is sent to the server. Sound that arrives before its turn is dropped. */
export class OwnVoice {
  #coder = null; // of Opus, while there is something to code
  #hungUp = false;

  /**
   * @param {(message: object) => boolean} send
   * @param {(data: Int16Array|Uint8Array, bytesASecond: number) => boolean} sendSound
   * @param {(voice: OwnVoice) => void} cancel
   * @param {{codec?: string, captions?: object, before?: () => void}} [more] a codec of the protocol that the browser supports;
   *   captions that the caller supplies; before: called before it begins, to end the voice before
   */
  constructor(send, sendSound, cancel, { codec = 'pcm_s16le', captions = null, before = () => {} } = {}) {
    this.send = send;
    this.sendSound = sendSound;
    this.cancelled = cancel;
    this.codec = codec;
    this.captions = captions;
    this.before = before;
    this.key = null; // what the server knows it by, once it has been asked for
    this.closed = false;
    /** @type {Promise<object>} the `end` message, as of `speak` */
    this.done = null;
  }

  /** @param {Int16Array} samples mono, CAPTURE_RATE */
  write(samples) {
    if (!this.key || this.closed || !samples.length) return;
    if (this.#coder) this.#coder.write(samples);
    else this.#give(samples);
  }

  /** Ends the voice after the sound that was written. */
  close() {
    if (this.closed) return;
    this.closed = true;
    if (!this.key) this.cancelled(this);
    else if (this.#coder) this.#coder.end().then(() => this.hangUp());
    else this.hangUp();
  }

  /** Not a sound more of it goes out: another is about to speak. */
  hangUp() {
    if (this.#hungUp) return;
    this.closed = this.#hungUp = true;
    this.#coder?.close();
    if (this.key) this.send({ type: 'close', id: this.key });
  }

  /** It is cut. */
  cancel() {
    this.ended();
    this.cancelled(this);
  }

  /** The server hears nothing more of it. */
  ended() {
    this.closed = this.#hungUp = true;
    this.#coder?.close();
  }

  /** Its turn has come. @param {object} speak the message of a text @returns {boolean} whether it went out */
  begin(speak) {
    this.before();
    const members = Object.fromEntries(MEMBERS.filter((name) => speak[name] !== undefined).map((name) => [name, speak[name]]));
    if (!this.send({ ...members, type: 'voice', codec: this.codec, rate: CAPTURE_RATE, channels: 1 })) return false;
    this.#coder?.close(); // of a connection that was lost
    this.#coder = this.codec === 'opus' ? new VoiceCoder((packet) => this.#give(packet), () => this.close()) : null;
    this.key = speak.id;
    return true;
  }

  #give(data) {
    if (!this.#hungUp) this.sendSound(data, BYTES[this.codec]);
  }
}
