// SPDX-License-Identifier: MIT
// What the user says, to be recognised by the server: one utterance while a button is held, or any number, hands-free.
import { Capture, CAPTURE_RATE } from '../audio/capture.mjs';
import { Endpoint } from '../audio/endpoint.mjs';
import { acquireContext, releaseContext } from '../audio/shared-context.mjs';
import { BYTES, VoiceCoder, voiceCodec } from '../audio/voice-coder.mjs';
import { microphone } from './listening.mjs';

const BEFORE = 0.4 * CAPTURE_RATE; // samples before the beginning of speech is noticed
const PAUSE = 0.3; // s of quiet at which a listener nods
const WAIT_MS = 8000; // for somebody to begin to speak
const WORDS_MS = 90000; // for the words of what was said: longer than the server waits for them

let count = 0;

export class Hearing {
  #endpoint = new Endpoint(CAPTURE_RATE);
  #before = []; // blocks that are not sent yet
  #coder = null;
  #codec;
  #id = null; // of the utterance that is open
  #stopped = false;
  #auto = false; // ends after the first utterance
  #begun = false;
  #paused = false; // the speaker is silent for a moment
  #waiting = 0; // timer
  #over = () => {};

  open = true; // the microphone is, or will be

  /** @type {Promise<object|null>} the last `heard` message; null if there were no words. Rejects if there is no microphone */
  done;

  /**
   * @param {object} ports send(message), sendSound(data, bytesASecond); on(type, listener), off(type, listener): of messages;
   *   changed({on, speaking}): the microphone, and whether an utterance is sent; paused(): the speaker pauses
   * @param {object} options of `hear`
   */
  constructor(ports, options) {
    this.ports = ports;
    this.options = options;
    this.done = this.#run();
    this.done.catch(() => {}); // callers handle it themselves
  }

  /** Ends the utterance, and closes the microphone. */
  stop() {
    this.#stopped = true;
    this.open = false;
    this.#over();
  }

  /** Ends by itself once the user has said something and is silent. */
  stopAtSilence() {
    this.#auto = true;
    this.#waiting = setTimeout(() => this.#endpoint.speaking || this.#begun || this.stop(), WAIT_MS);
  }

  async #run() {
    const { stream, codec, handsFree } = this.options;
    const own = stream ? null : await microphone();
    const tracks = (stream ?? own).getAudioTracks(), context = acquireContext();
    let capture = null, words = null;
    const over = new Promise((resolve) => (this.#over = resolve));
    try {
      if (!context || !tracks.length) throw new globalThis.DOMException('There is no sound in that.', 'NotSupportedError');
      const node = context.createMediaStreamSource(new globalThis.MediaStream(tracks));
      capture = await Capture.open(node, (samples) => this.#take(samples));
      this.#codec = await voiceCodec(codec);
      for (const track of tracks) track.addEventListener('ended', this.#over);
      this.ports.changed({ on: true, speaking: false });
      if (!handsFree && !this.#stopped) this.#begin();
      if (!this.#stopped) await over;
      words = this.#id;
      await this.#end();
    } finally {
      this.open = false;
      clearTimeout(this.#waiting);
      capture?.close();
      for (const track of tracks) track.removeEventListener('ended', this.#over);
      own?.getTracks().forEach((track) => track.stop());
      if (context) releaseContext();
      this.ports.changed({ on: false, speaking: false });
    }
    return words && this.#words(words);
  }

  #take(samples) {
    const { handsFree, noise = () => 0 } = this.options, change = this.#endpoint.push(samples, noise());
    if (change === 'begin') {
      this.#begun = true;
      this.options.onset?.();
    }
    const paused = this.#endpoint.quiet > PAUSE;
    if (paused && !this.#paused) this.ports.paused();
    this.#paused = paused;
    if (!this.#id) {
      this.#before.push(samples);
      let size = this.#before.reduce((sum, { length }) => sum + length, 0);
      while (size > BEFORE) size -= this.#before.shift().length;
    }
    if (handsFree && change === 'begin') this.#begin();
    else if (this.#id) this.#write(samples);
    if (handsFree && change === 'end') this.#end();
    else if (this.#auto && change === 'end') this.stop();
  }

  #begin() {
    const id = `ear-${Date.now().toString(36)}-${++count}`, { lang } = this.options;
    if (!this.ports.send({ type: 'hear', id, codec: this.#codec, rate: CAPTURE_RATE, channels: 1, ...(lang && { lang }) })) return;
    this.#id = id;
    const give = (data) => this.ports.sendSound(data, BYTES[this.#codec]);
    this.#coder = this.#codec === 'opus' ? new VoiceCoder(give, () => this.stop()) : { write: give, end: async () => {} };
    for (const samples of this.#before.splice(0)) this.#write(samples);
    this.ports.changed({ on: true, speaking: true });
  }

  #write(samples) {
    this.#coder.write(samples);
  }

  async #end() {
    const id = this.#id, coder = this.#coder;
    if (!id) return;
    this.#id = null;
    await coder.end();
    this.ports.send({ type: 'close', id });
    if (!this.#stopped) this.ports.changed({ on: true, speaking: false });
  }

  /** The words of the utterance; null if the server cannot tell them. */
  #words(id) {
    return new Promise((resolve) => {
      const types = ['heard', 'error', 'connection'];
      const end = (message) => {
        for (const type of types) this.ports.off(type, listen);
        clearTimeout(late);
        resolve(message);
      };
      const listen = ({ detail }) => {
        if (detail.id === id && detail.final) end(detail);
        else if ((detail.id === id && detail.type === 'error') || (detail.state && detail.state !== 'open')) end(null);
      };
      const late = setTimeout(() => end(null), WORDS_MS);
      for (const type of types) this.ports.on(type, listen);
    });
  }
}
