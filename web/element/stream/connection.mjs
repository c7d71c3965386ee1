// SPDX-License-Identifier: MIT

/** Exponential backoff with a limit and jitter, so that clients do not reconnect all at once. */
export class Backoff {
  constructor({ first = 500, limit = 15000, random = Math.random } = {}) {
    Object.assign(this, { first, limit, random, attempt: 0 });
  }

  /** @returns {number} milliseconds, between half of and the whole step */
  next() {
    const step = Math.min(this.limit, this.first * 2 ** this.attempt++);
    return step * (0.5 + 0.5 * this.random());
  }

  reset() {
    this.attempt = 0;
  }
}

const PROTOCOL = 'faccia.v1';
const STEADY_MS = 5000; // a connection that lasted this long resets the backoff
const PING_MS = 20000;
const PONG_PATIENCE_MS = 10000;
const SOUND_BEHIND = 1; // seconds of a voice

/**
 * The link to the server: opens, listens, and opens again when it is lost.
 * States: `connecting`, `open` (the server has said hello), `waiting` (until the next attempt), `closed` (on purpose).
 */
export class Connection {
  /**
   * @param {string} url
   * @param {object} handlers onstate({state, retryIn?}), onmessage(object), onmedia(ArrayBuffer), onrefused(): an attempt came
   *   to nothing
   * @param {object} [platform] WebSocket, setTimeout and clearTimeout of tests
   */
  constructor(url, handlers, platform = {}) {
    this.url = url;
    this.handlers = handlers;
    this.WebSocket = platform.WebSocket ?? globalThis.WebSocket;
    this.setTimeout = platform.setTimeout ?? ((...args) => globalThis.setTimeout(...args));
    this.clearTimeout = platform.clearTimeout ?? ((timer) => globalThis.clearTimeout(timer));
    this.backoff = new Backoff(platform);
    this.state = 'closed';
    this.socket = null;
    this.timers = {};
  }

  open() {
    this.#cancelTimers();
    this.#setState('connecting');
    const socket = new this.WebSocket(this.url, PROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onmessage = ({ data }) => socket === this.socket && this.#hear(data);
    socket.onclose = () => socket === this.socket && this.#lost();
    socket.onerror = socket.onclose; // what a page's policy forbids is not closed
  }

  /** Ends it on purpose. */
  close() {
    this.#drop();
    this.#setState('closed');
  }

  /** Tries at once instead of when the time has come, say, because the network is back. */
  hurry() {
    if (this.state === 'waiting') this.open();
  }

  /** @returns {boolean} whether it went out */
  send(message) {
    if (this.state !== 'open') return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  /**
   * @param {Int16Array|Uint8Array} sound @param {number} [bytes] of it a second
   * @returns {boolean} whether it went out: not when the network is that far behind
   */
  sendSound(sound, bytes = 48000) {
    if (this.state !== 'open' || this.socket.bufferedAmount > SOUND_BEHIND * bytes) return false;
    this.socket.send(sound);
    return true;
  }

  #hear(data) {
    this.#watch();
    if (typeof data !== 'string') {
      this.handlers.onmedia(data);
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'hello') {
      this.timers.steady = this.setTimeout(() => this.backoff.reset(), STEADY_MS);
      this.#setState('open', { hello: message });
    }
    if (message.type !== 'pong') this.handlers.onmessage(message);
  }

  /** A link can die without a word: ask now and then. */
  #watch() {
    this.clearTimeout(this.timers.ping);
    this.clearTimeout(this.timers.pong);
    this.timers.ping = this.setTimeout(() => {
      this.send({ type: 'ping', id: 'alive' });
      this.timers.pong = this.setTimeout(() => this.#lost(), PONG_PATIENCE_MS);
    }, PING_MS);
  }

  #lost() {
    const refused = this.state === 'connecting';
    this.#drop();
    const retryIn = this.backoff.next();
    this.timers.retry = this.setTimeout(() => this.open(), retryIn);
    this.#setState('waiting', { retryIn });
    if (refused) this.handlers.onrefused?.();
  }

  #drop() {
    this.#cancelTimers();
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }

  #cancelTimers() {
    for (const timer of Object.values(this.timers)) this.clearTimeout(timer);
    this.timers = {};
  }

  #setState(state, more = {}) {
    this.state = state;
    this.handlers.onstate({ state, ...more });
  }
}
