// SPDX-License-Identifier: MIT
import { OpusSound } from '../audio/opus.mjs';
import { OPUS_PACKET_SAMPLES, OPUS_RATE } from '../../../protocol/chunk/compact.mjs';
import { IdleLife } from './idle-life.mjs';
import { fetchRecording } from './source.mjs';

const PIECE_PACKETS = 25; // half a second
const AHEAD = 3; // seconds of media ahead of what is heard
const PACE_MS = 200;
const RESTART_PACKETS = 4; // that a decoder needs before a place where it starts (RFC 7845, 4.6)
const IDLE_MS = 400; // of idle movement in a piece
const IDLE_FPS = 25;
const STATES = ['sentence', 'speaker']; // events that hold until the next of their kind

/**
 * Speaks a recording in place of a server: has the methods of Link, and answers the messages of the page as the server would,
 * to the one utterance that there is.
 */
export class Recital {
  #aborter = null;
  #sound = new OpusSound();
  #utterance = 0; // number of the one that is spoken, or was last
  #key = null; // its id; null: none is spoken
  #packet = 0; // next one to decode
  #skip = 0; // samples to drop of what is decoded next
  #event = 0; // next one to tell
  #frame = 0; // next one to send
  #ended = false; // all was sent
  #base = 0; // seconds at which it began, or was sought last
  #run = 0; // counts starts, stops and jumps: what was begun before is void
  #busy = false;
  #timer = 0;
  #idle = null; // IdleLife; null: none is wanted
  #idleTimer = 0;
  #idleFrame = 0; // next one to send

  /**
   * @param {object} ports source() -> {src, audio}; onstate, onmessage, ontrouble: see Link; onmedia(chunk): decoded;
   *   heard() -> seconds of the recording that were heard, null: nothing yet; fetch, setInterval and clearInterval of tests
   */
  constructor(ports) {
    const clock = { setInterval: (...args) => setInterval(...args), clearInterval: (timer) => clearInterval(timer) };
    this.ports = { ...clock, fetch: fetchRecording, ...ports };
    this.state = 'closed';
    /** @type {import('../../../protocol/bundle.mjs').Recording|null} */
    this.recording = null;
    this.start = 0; // seconds at which the next utterance begins
  }

  async open() {
    this.close();
    const { signal } = (this.#aborter = new AbortController());
    this.#setState('connecting');
    const { src, audio } = this.ports.source();
    try {
      const recording = await this.ports.fetch(src, audio, globalThis.document?.baseURI, signal);
      if (signal.aborted) return;
      this.recording = recording;
      this.ports.ontrouble(null, {});
      this.#setState('open', { hello: { models: [] } });
    } catch (error) {
      if (signal.aborted) return;
      this.#setState('closed');
      if (error.at === undefined) this.ports.ontrouble('noRecording', { src });
      else this.ports.ontrouble('badRecording', { src, reason: error.message, byte: error.at });
    }
  }

  close() {
    this.#aborter?.abort();
    this.#halt();
    this.#setIdle(null);
    this.recording = null;
    this.start = 0;
    if (this.state !== 'closed') this.#setState('closed');
    this.ports.ontrouble(null, {});
  }

  hurry() {}

  sendSound() {
    return false;
  }

  /** Seconds. */
  get duration() {
    return this.recording ? this.recording.samples / OPUS_RATE : null;
  }

  /** Until its end is heard. */
  get speaking() {
    return this.#key !== null && (!this.#ended || this.ports.heard() !== null);
  }

  /** @param {object} message as a server gets it, and {type: 'seek', time} @returns {boolean} whether there is a recording */
  send(message) {
    if (this.state !== 'open') return false;
    if (message.type === 'speak') this.#speak(message);
    else if (message.type === 'stop' || message.type === 'cancel') this.#stop();
    else if (message.type === 'pause' || message.type === 'resume') this.#tell({ type: `${message.type}d`, ...this.#about() });
    else if (message.type === 'seek') this.#seek(message.time, { type: 'seeked' });
    else if (message.type === 'jump') this.#jump(message.mark);
    else if (message.type === 'idle') this.#setIdle(message.on ? new IdleLife(message.life) : null);
    return true;
  }

  /** Between utterances the face lives on. */
  #setIdle(idle) {
    this.ports.clearInterval(this.#idleTimer);
    this.#idle = idle;
    this.#idleFrame = 0;
    if (!idle) return;
    this.#idleTimer = this.ports.setInterval(() => this.#liveOn(), IDLE_MS);
    this.#liveOn();
  }

  #liveOn() {
    if (this.speaking) return;
    const first = this.#idleFrame;
    const count = (IDLE_FPS * IDLE_MS) / 1000;
    const frames = Array.from({ length: count }, (_, k) => this.#idle.face((first + k) / IDLE_FPS));
    const [start, samples] = [first, count].map((n) => (n * OPUS_RATE) / IDLE_FPS);
    this.ports.onmedia({ utterance: 0, fps: IDLE_FPS, firstFrame: first, frames, start, sampleRate: OPUS_RATE, samples });
    this.#idleFrame += count;
  }

  #speak({ id, recording }) {
    const refuse = (code, text) => {
      this.#tell({ type: 'error', code, message: text, id });
      this.#tell({ type: 'end', reason: 'failed', id });
    };
    if (!recording) refuse('no-server', 'This head speaks a recording; it has no server that could speak a text.');
    else if (this.speaking) refuse('busy', 'The recording is being spoken.');
    else this.#begin(id);
  }

  #begin(id) {
    this.#key = id;
    this.#utterance++;
    const { events: [begin], text } = this.recording;
    this.#tell({ ...begin, text, ...this.#about() });
    const at = this.start;
    this.start = 0;
    this.#go(0);
    this.#timer = this.ports.setInterval(() => this.#pump(), PACE_MS);
    if (at > 0) this.#seek(at, { type: 'seeked' });
    this.#pump();
  }

  #stop() {
    const end = this.speaking && !this.#ended ? { type: 'end', reason: 'stopped', ...this.#about() } : null;
    this.#halt();
    if (end) this.#tell(end);
  }

  #halt() {
    this.ports.clearInterval(this.#timer);
    this.#run++;
    this.#key = null;
    this.#ended = false;
    this.#sound.close();
  }

  #jump(mark) {
    const event = this.recording.events.find(({ type, name }) => type === 'mark' && name === mark);
    if (event && this.speaking) this.#seek(event.time, { type: 'jumped', mark });
    else this.#tell({ type: 'error', code: 'unknown-mark', message: `There is no mark '${mark}' in what is spoken.`, ...this.#about() });
  }

  /** Goes on from that time, or begins there. */
  #seek(wish, message) {
    const last = Math.max(0, this.duration - OPUS_PACKET_SAMPLES / OPUS_RATE);
    const time = Math.min(last, Math.max(0, Number(wish) || 0));
    if (!this.speaking) {
      this.start = time;
      return;
    }
    this.#tell({ ...message, time, sample: Math.round(time * OPUS_RATE), ...this.#about() });
    this.#go(time);
    for (const type of STATES) {
      const event = this.recording.events.slice(0, this.#event).findLast((one) => one.type === type);
      if (event) this.#tell({ ...event, time, ...this.#about() });
    }
    this.#pump();
  }

  /** Puts all that is to be sent to a time. */
  #go(time) {
    const { events, skip, fps } = this.recording;
    const sample = Math.round(time * OPUS_RATE) + skip;
    this.#run++;
    this.#ended = false;
    this.#base = time;
    this.#packet = Math.max(0, Math.floor(sample / OPUS_PACKET_SAMPLES) - RESTART_PACKETS);
    this.#skip = sample - this.#packet * OPUS_PACKET_SAMPLES;
    this.#frame = Math.max(0, Math.floor(time * fps) - 1); // the one before, for the curve between frames
    const found = events.findIndex((event, i) => i > 0 && (event.type === 'end' || event.time >= time));
    this.#event = found;
    this.#sound.close();
  }

  /** Sends media until they are so far ahead of what is heard. */
  async #pump() {
    if (this.#busy) return;
    this.#busy = true;
    for (let run = this.#run; this.#key !== null && !this.#ended && this.#lead() < AHEAD; run = this.#run) {
      const first = this.#packet;
      const audio = this.recording.packets.slice(first, first + PIECE_PACKETS);
      const skip = this.#skip;
      const samples = await this.#sound.decode({ utterance: this.#utterance, firstPacket: first, audio }).catch(() => null);
      if (run !== this.#run) continue; // elsewhere by now
      this.#packet += audio.length;
      this.#skip = Math.max(0, skip - audio.length * OPUS_PACKET_SAMPLES);
      this.#deliver(first * OPUS_PACKET_SAMPLES, samples ?? new Float32Array(audio.length * OPUS_PACKET_SAMPLES), skip);
    }
    this.#busy = false;
  }

  /** Seconds of media that were sent and not heard. */
  #lead() {
    const sent = (this.#packet * OPUS_PACKET_SAMPLES - this.recording.skip) / OPUS_RATE;
    return sent - Math.max(this.#base, this.ports.heard() ?? 0);
  }

  /** @param {number} at number of the first sample, counted with those to be skipped */
  #deliver(at, decoded, skip) {
    const { skip: before, samples: all, fps, frames } = this.recording;
    const start = at + skip - before;
    const audio = decoded.subarray(skip, Math.max(skip, Math.min(decoded.length, all + before - at)));
    const end = start + audio.length;
    const done = end >= all;
    const last = done ? frames.length : Math.min(frames.length, Math.ceil((end / OPUS_RATE) * fps) + 1);
    this.#tellUntil(done ? Infinity : end / OPUS_RATE);
    if (audio.length) {
      const face = { utterance: this.#utterance, fps, firstFrame: this.#frame, frames: frames.slice(this.#frame, last) };
      this.ports.onmedia({ ...face, start, sampleRate: OPUS_RATE, samples: audio.length, audio });
      this.#frame = Math.max(this.#frame, last);
    }
    if (!done) return;
    this.#ended = true;
    this.#tell({ ...this.recording.events.at(-1), reason: 'done', utterance: this.#utterance, id: this.#key });
  }

  /** Announces events ahead of their sound. */
  #tellUntil(time) {
    const { events } = this.recording;
    for (let event; (event = events[this.#event]).type !== 'end' && event.time < time; this.#event++)
      this.#tell({ ...event, ...this.#about() });
  }

  #about() {
    return this.#key !== null ? { utterance: this.#utterance, id: this.#key } : {};
  }

  #tell(message) {
    this.ports.onmessage(message);
  }

  #setState(state, more = {}) {
    this.state = state;
    this.ports.onstate({ state, ...more });
  }
}
