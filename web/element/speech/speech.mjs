// SPDX-License-Identifier: MIT
import { HeardCaptions } from '../captions/captions.mjs';
import { OwnVoice } from './own-voice.mjs';
import { Timeline, Utterance } from './utterance.mjs';
import { Turns } from './turns.mjs';
import { Writing } from './writing.mjs';

const PATIENCE_MS = 10000; // how long a `speak` waits for a connection
const ID_BYTES = 64; // most of an id
const UNHEARD = ['blocked', 'none']; // states of the player in which samples are consumed in silence
const MOVES = ['jumped', 'seeked'];
const DIRECTIONS = ['paused', 'resumed', ...MOVES]; // what the server says at once

/**
 * The speech of one head: sends requests, queues media on the player, and emits events on the audio clock. `begin`, `word`,
 * `mark`, `end`, `sentence` and `phone` come when they are heard; `error`, `warning`, `paused`, `resumed`, `jumped` and
 * `media` at once.
 */
export class Speech {
  #own = null; // who speaks himself, of those the last

  /**
   * @param {object} ports player; send(message), sendSound(sound, bytes) -> boolean; emit(type, detail); idle(chunk): media of
   *   no utterance; state(): of the connection; turns shared with other heads; setTimeout of tests
   */
  constructor({
    player, send, sendSound = () => false, emit, idle = () => {}, state = () => 'open', turns = new Turns(),
    setTimeout = (...args) => globalThis.setTimeout(...args),
  }) {
    Object.assign(this, { player, send, sendSound, emit, idle, state, turns, setTimeout });
    this.timeline = new Timeline();
    /** @type {Set<Utterance>} */
    this.open = new Set();
    this.count = 0;
    this.adopts = false; // also what others ask for: in a room
    this.waits = true; // until others on the page have finished
    this.recorded = false; // a recording is spoken, in which one can go back
    this.paused = false;
  }

  /** Whether it waits for other heads of the page. In a room the server keeps the order. */
  get polite() {
    return this.waits && !this.adopts;
  }

  /** Whether there is a connection, or will be in a moment. */
  get reachable() {
    return ['open', 'connecting'].includes(this.state());
  }

  /** Whether the server still speaks what the page calls so. */
  running(id) {
    return [...this.open].some((utterance) => utterance.options.id === id && utterance.item && !utterance.answer);
  }

  get busy() {
    return this.open.size > 0;
  }

  /** @param {string} text @param {object} options further members of the `speak` message @returns {Promise<object>} */
  speak(text, options = {}, writing = null) {
    const utterance = new Utterance(this.#key(options.id), text, options, writing?.captions ?? null, writing);
    const first = ['replace', 'interrupt'].includes(options.mode);
    if (first) this.paused = false;
    if (options.mode === 'replace') for (const other of [...this.open]) if (!other.sent) this.#stopped(other);
    this.open.add(utterance);
    if (this.state() !== 'closed') this.player.open();
    this.turns.ask(this, utterance, first);
    this.#await(utterance);
    return utterance.promise;
  }

  /** Begins to speak what is still being written. @param {object} options as of `speak` @returns {Writing} */
  write(options = {}) {
    const writing = new Writing(this.send, (cancelled) => this.#cancel(cancelled));
    writing.done = this.speak('', { ...options, open: true }, writing);
    return writing;
  }

  /** Opens a live voice. @param {object} options members of the `voice` message @returns {OwnVoice} */
  listen({ codec, captions, ...options } = {}) {
    const voice = new OwnVoice(this.send, this.sendSound, (cancelled) => this.#cancel(cancelled), {
      codec,
      captions,
      before: () => {
        if (this.#own !== voice) this.#own?.hangUp();
        this.#own = voice;
      },
    });
    voice.done = this.speak('', options, voice);
    voice.done.finally(() => voice.ended()).catch(() => {});
    return voice;
  }

  /** Sends an utterance whose turn has come. */
  grant(utterance) {
    if (this.state() !== 'connecting') this.#send(utterance);
  }

  /** Halts where it is, at once, until `resume`. */
  pause() {
    this.#hold(true);
    this.send({ type: 'pause' });
  }

  resume() {
    this.#hold(false);
    this.send({ type: 'resume' });
  }

  /** @param {string} mark of what is spoken: it goes on from there */
  jump(mark) {
    this.send({ type: 'jump', mark });
  }

  /** @param {number} rate words per minute, of the sentences that have not begun */
  setRate(rate) {
    this.send({ type: 'rate', rate });
  }

  stop() {
    this.player.flush();
    this.#hold(false);
    this.timeline = new Timeline();
    this.send({ type: 'stop' });
    for (const utterance of [...this.open].reverse()) {
      utterance.cancelled = true;
      if (!utterance.sent || utterance.answer) this.#stopped(utterance);
    }
  }

  /** The link is there: what waited for it goes out. */
  linked() {
    if (this.busy) this.player.open();
    for (const utterance of this.open) {
      clearTimeout(utterance.timer);
      if (!utterance.sent && this.turns.has(utterance)) this.#send(utterance);
    }
    this.turns.next();
  }

  /** The link is gone: what has come is still played, what was to come fails. */
  unlinked() {
    this.#hold(false);
    for (const utterance of [...this.open]) {
      if (!utterance.sent) {
        this.turns.giveBack(this, utterance);
        this.#await(utterance);
        continue;
      }
      utterance.number = null; // the next connection counts anew
      if (utterance.answer) continue;
      const message = 'The connection was lost.';
      this.emit('error', { type: 'error', code: 'connection-lost', message, id: utterance.options.id });
      this.#close(utterance, { type: 'end', reason: utterance.cancelled ? 'stopped' : 'failed', code: 'connection-lost' });
    }
  }

  /** @param {object} message of the server, of any type */
  hear(message) {
    const utterance = this.#about(message);
    const detail = utterance ? this.#detail(utterance, message) : message;
    if (message.type === 'error' || message.type === 'warning') this.emit(message.type, detail);
    if (DIRECTIONS.includes(message.type)) this.#direct(message, utterance);
    if (!utterance && message.type === 'begin' && this.adopts) {
      this.#adopt(message);
      return;
    }
    if (!utterance) return;
    if (message.type === 'warning' && message.code === 'room-away') this.#lose(utterance);
    else if (message.type === 'end') this.#close(utterance, message);
    else if (utterance.cancelled) return;
    else if (message.type === 'begin') this.#begin(utterance, message);
    else if (utterance.item && ['sentence', 'speaker', 'word', 'mark', 'phone'].includes(message.type))
      this.timeline.schedule(utterance.item, message.time, message);
  }

  /** @param {object} chunk decoded: see Demuxer */
  media(chunk) {
    if (chunk.utterance === 0) {
      this.idle(chunk);
      return;
    }
    for (const utterance of this.open)
      if (utterance.number === chunk.utterance && utterance.item && !utterance.cancelled) {
        this.#tellMedia(utterance, chunk);
        const samples = utterance.take(chunk);
        this.player.write(utterance.options.sound === false ? samples.fill(0) : samples);
      }
  }

  /** Emits media as they arrive, before they are heard, for pages that record them. */
  #tellMedia(utterance, { utterance: number, firstFrame, frames, start, sampleRate, audio, audioStart, audioRate }) {
    const { fps } = utterance.track;
    const sound = { start: audioStart ?? start, rate: audioRate ?? sampleRate, audio: audio ?? null };
    this.emit('media', this.#detail(utterance, { type: 'media', utterance: number, fps, firstFrame, frames, ...sound }));
  }

  /** Lets happen what is due. @param {number} now performance.now() */
  tick(now) {
    const heard = this.player.heard(now);
    for (const [item, message] of this.timeline.take(heard)) this.#happen(item.utterance, message);
  }

  /**
   * @param {number} now performance.now()
   * @param {number} ahead seconds to look ahead
   * @returns {{utterance: Utterance, track: object, seconds: number, running: boolean}|null} the utterance that is heard
   */
  heard(now, ahead = 0) {
    const { position, running } = this.player.heard(now, ahead);
    const found = this.timeline.at(position);
    if (!found) return null;
    const { utterance } = found.item;
    utterance.track.forgetBefore(found.seconds);
    return { utterance, track: utterance.track, seconds: found.seconds, running };
  }

  /** Returns the id that the server is sent. In a room, where others count too, it is the page's own id or a unique one. */
  #key(id) {
    const own = `u${++this.count}`;
    if (!this.adopts) return own;
    const taken = [...this.open].some(({ key }) => key === id);
    if (typeof id === 'string' && id && new TextEncoder().encode(id).length <= ID_BYTES && !taken) return id;
    return `${own}-${Math.random().toString(36).slice(2, 10)}`;
  }

  /** Adds an utterance that another client of the room requested. */
  #adopt(message) {
    const utterance = new Utterance(null, '', message.id ? { id: message.id } : {}, new HeardCaptions(message.markup));
    utterance.sent = true;
    this.open.add(utterance);
    this.turns.enter(this, utterance);
    this.player.open();
    this.#begin(utterance, message);
  }

  /** Somebody has directed the stream: oneself, or another in the same room. */
  #direct(message, utterance) {
    if (MOVES.includes(message.type)) this.#move(message, utterance);
    else this.#hold(message.type === 'paused');
    this.emit(message.type, utterance ? this.#detail(utterance, message) : message);
  }

  /** It goes on elsewhere. In a recording, times remain those of the recording. */
  #move({ time }, utterance) {
    if (!utterance?.item) return;
    this.#forgetUnheard();
    if (this.recorded) {
      utterance.seek(time);
      utterance.answer = null; // of an end that was not heard
      utterance.item.start = this.player.written - time * this.player.rate;
    } else utterance.jump();
  }

  #hold(on) {
    this.paused = on;
    if (on) this.player.hold();
    else this.player.release();
    this.turns.next();
  }

  /** Drops media that were received but not heard. */
  #forgetUnheard() {
    this.timeline.forgetAfter(this.player.heard(performance.now()).position);
    this.player.flush();
  }

  #about(message) {
    for (const utterance of this.open)
      if (
        (message.id && message.id === utterance.key) ||
        (message.utterance && message.utterance === utterance.number)
      )
        return utterance;
    return null;
  }

  /** The message as the page gets it: with the page's own id. */
  #detail(utterance, message) {
    const { id: _, ...detail } = message;
    return utterance.options.id === undefined ? detail : { ...detail, id: utterance.options.id };
  }

  #send(utterance) {
    const text = utterance.options.passage ? undefined : utterance.text; // the server has it; here it is for the captions
    const message = { type: 'speak', id: utterance.key, ...utterance.options, text };
    Object.assign(message, { type: 'speak', id: utterance.key }); // first, where a server finds it in what is too long to be read
    utterance.sent = utterance.writing ? utterance.writing.begin(message) : this.send(message);
    if (utterance.sent) clearTimeout(utterance.timer);
  }

  /** Cancels a text. One that the server has sent completely is dropped here only. */
  #cancel(writing) {
    const utterance = [...this.open].find((other) => other.writing === writing);
    if (!utterance) return;
    if (utterance.sent && !utterance.answer) {
      this.send({ type: 'cancel', id: utterance.key });
      return;
    }
    if (utterance.item) this.#forgetUnheard();
    this.#stopped(utterance);
  }

  /** A connection is waited for, but not for ever. */
  #await(utterance) {
    clearTimeout(utterance.timer);
    if (utterance.sent || (this.state() === 'open' && !this.turns.has(utterance))) return;
    utterance.timer = this.setTimeout(() => this.#refuse(utterance, 'no-connection', 'There is no connection.'), PATIENCE_MS);
  }

  /** Handles the loss of the daemon that spoke: another daemon repeats the utterance, a foreign one as a new one. */
  #lose(utterance) {
    if (utterance.key === null) {
      this.#close(utterance, { type: 'end', reason: 'failed', code: 'room-away' });
      return;
    }
    if (!utterance.item) return;
    this.player.write(utterance.rest());
    this.player.finish();
    this.timeline.remove(utterance.item);
    utterance.item = null;
    utterance.number = null;
  }

  #begin(utterance, message) {
    utterance.begin(message, this.player.rate);
    utterance.item = this.timeline.add(utterance, this.player.written, this.player.rate);
    this.timeline.schedule(utterance.item, 0, message);
  }

  #close(utterance, message) {
    utterance.answer = message;
    if (utterance.item && !utterance.cancelled && message.reason === 'stopped') {
      this.#forgetUnheard(); // stopped by another client, or replaced
      this.#end(utterance, message);
      return;
    }
    if (!utterance.item || utterance.cancelled) {
      this.#end(utterance, message);
      return;
    }
    this.player.write(utterance.rest());
    this.player.finish();
    this.timeline.close(utterance.item, this.player.written, message, message.reason === 'failed');
  }

  #happen(utterance, message) {
    if (message.type === 'sentence') utterance.captions.sentence(message);
    if (message.type === 'speaker') utterance.speaker = { id: message.speaker, name: message.name };
    if (message.type === 'word') utterance.captions.heard(message);
    if (message.type === 'end') this.#end(utterance, message);
    else if (message.type === 'word' && utterance.speaker) this.emit('word', { ...this.#detail(utterance, message), speaker: utterance.speaker });
    else this.emit(message.type, this.#detail(utterance, message));
  }

  #stopped(utterance) {
    this.#end(utterance, { type: 'end', duration: 0, ...utterance.answer, reason: 'stopped' });
  }

  #refuse(utterance, code, message) {
    this.emit('error', { type: 'error', code, message, id: utterance.options.id });
    this.#end(utterance, { type: 'end', reason: 'failed', code, duration: 0 });
  }

  #end(utterance, message) {
    clearTimeout(utterance.timer);
    this.open.delete(utterance);
    if (utterance.item) this.timeline.remove(utterance.item);
    const detail = this.#detail(utterance, message);
    if (UNHEARD.includes(this.player.sound)) detail.sound = this.player.sound;
    this.emit('end', detail);
    utterance.resolve(detail);
    this.turns.leave(utterance);
  }
}
