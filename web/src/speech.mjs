// SPDX-License-Identifier: MIT
import { HeardCaptions } from './captions.mjs';
import { Programme } from './programme.mjs';
import { Utterance } from './utterance.mjs';

const PATIENCE_MS = 10000; // how long a `speak` waits for a connection
const PLAYER_ACTS = { paused: 'hold', resumed: 'release', jumped: 'flush' }; // what the player does when the server says so

/**
 * All that is spoken: sends what is asked for, queues what comes on the player, and says on the audio's clock what is
 * heard. Events: `begin`, `word`, `mark`, `end` as they are heard, `sentence` and `phone` too; `error`, `warning`, `paused`,
 * `resumed`, `jumped` at once.
 */
export class Speech {
  /**
   * @param {object} ports player; send(message) -> boolean; emit(type, detail); idle(chunk): media of nobody's; setTimeout
   *   of tests
   */
  constructor({ player, send, emit, idle = () => {}, setTimeout = (...args) => globalThis.setTimeout(...args) }) {
    Object.assign(this, { player, send, emit, idle, setTimeout });
    this.programme = new Programme();
    /** @type {Set<Utterance>} */
    this.open = new Set();
    this.count = 0;
    this.adopts = false; // also what others ask for: in a room
  }

  get busy() {
    return this.open.size > 0;
  }

  /** @param {string} text @param {object} options further members of the `speak` message @returns {Promise<object>} */
  speak(text, options = {}) {
    const utterance = new Utterance(`u${++this.count}`, text, options);
    this.open.add(utterance);
    this.player.open();
    this.#send(utterance);
    if (!utterance.sent)
      utterance.timer = this.setTimeout(() => this.#refuse(utterance, 'no-connection', 'There is no connection.'), PATIENCE_MS);
    return utterance.promise;
  }

  /** Halts where it is, at once, until `resume`. */
  pause() {
    this.player.hold();
    this.send({ type: 'pause' });
  }

  resume() {
    this.player.release();
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
    this.player.release();
    this.programme = new Programme();
    this.send({ type: 'stop' });
    for (const utterance of [...this.open]) {
      utterance.cancelled = true;
      if (!utterance.sent || utterance.answer)
        this.#end(utterance, { type: 'end', duration: 0, ...utterance.answer, reason: 'stopped' });
    }
  }

  /** The link is there: what waited for it goes out. */
  linked() {
    for (const utterance of this.open) if (!utterance.sent) this.#send(utterance);
  }

  /** The link is gone: what has come is still played, what was to come fails. */
  unlinked() {
    this.player.release();
    for (const utterance of [...this.open]) {
      if (!utterance.sent) continue;
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
    if (message.type in PLAYER_ACTS) this.#direct(message, utterance);
    if (!utterance && message.type === 'begin' && this.adopts) {
      this.#adopt(message);
      return;
    }
    if (!utterance) return;
    if (message.type === 'end') this.#close(utterance, message);
    else if (utterance.cancelled) return;
    else if (message.type === 'begin') this.#begin(utterance, message);
    else if (utterance.item && ['sentence', 'word', 'mark', 'phone'].includes(message.type))
      this.programme.schedule(utterance.item, message.time, message);
  }

  /** @param {object} chunk decoded: see Intake */
  media(chunk) {
    if (chunk.utterance === 0) {
      this.idle(chunk);
      return;
    }
    for (const utterance of this.open)
      if (utterance.number === chunk.utterance && utterance.item && !utterance.cancelled)
        this.player.write(utterance.take(chunk));
  }

  /** Lets happen what is due. @param {number} now performance.now() */
  tick(now) {
    const heard = this.player.heard(now);
    for (const [item, message] of this.programme.take(heard)) this.#happen(item.utterance, message);
  }

  /**
   * @param {number} now performance.now()
   * @param {number} ahead what will be heard so many seconds later
   * @returns {{utterance: Utterance, track: object, seconds: number, running: boolean}|null} what is heard
   */
  heard(now, ahead = 0) {
    const { position, running } = this.player.heard(now, ahead);
    const found = this.programme.at(position);
    if (!found) return null;
    const { utterance } = found.item;
    utterance.track.forgetBefore(found.seconds);
    return { utterance, track: utterance.track, seconds: found.seconds, running };
  }

  /** What somebody else in the room has asked for. */
  #adopt(message) {
    const utterance = new Utterance(null, '', {}, new HeardCaptions(message.markup));
    utterance.sent = true;
    this.open.add(utterance);
    this.player.open();
    this.#begin(utterance, message);
  }

  /** Somebody has directed the stream: oneself, or another in the same room. */
  #direct(message, utterance) {
    if (message.type === 'jumped' && utterance?.item) this.#forgetUnheard();
    if (message.type !== 'jumped') this.player[PLAYER_ACTS[message.type]]();
    this.emit(message.type, utterance ? this.#detail(utterance, message) : message);
  }

  /** What has come and has not been heard will not be. */
  #forgetUnheard() {
    this.programme.forgetAfter(this.player.heard(performance.now()).position);
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
    utterance.sent = this.send({ ...utterance.options, type: 'speak', text: utterance.text, id: utterance.key });
    if (utterance.sent) clearTimeout(utterance.timer);
  }

  #begin(utterance, message) {
    utterance.begin(message, this.player.rate);
    utterance.item = this.programme.add(utterance, this.player.written, this.player.rate);
    this.programme.schedule(utterance.item, 0, message);
  }

  #close(utterance, message) {
    utterance.answer = message;
    if (utterance.item && !utterance.cancelled && message.reason === 'stopped') {
      this.#forgetUnheard(); // by somebody else, or by what was said instead
      this.#end(utterance, message);
      return;
    }
    if (!utterance.item || utterance.cancelled) {
      this.#end(utterance, message);
      return;
    }
    this.player.write(utterance.rest());
    this.player.finish();
    this.programme.close(utterance.item, this.player.written, message);
  }

  #happen(utterance, message) {
    if (message.type === 'sentence') utterance.captions.sentence(message);
    if (message.type === 'word') utterance.captions.heard(message);
    if (message.type === 'end') this.#end(utterance, message);
    else this.emit(message.type, this.#detail(utterance, message));
  }

  #refuse(utterance, code, message) {
    this.emit('error', { type: 'error', code, message, id: utterance.options.id });
    this.#end(utterance, { type: 'end', reason: 'failed', code, duration: 0 });
  }

  #end(utterance, message) {
    clearTimeout(utterance.timer);
    this.open.delete(utterance);
    if (utterance.item) this.programme.remove(utterance.item);
    const detail = this.#detail(utterance, message);
    this.emit('end', detail);
    utterance.resolve(detail);
  }
}
