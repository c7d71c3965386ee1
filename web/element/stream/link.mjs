// SPDX-License-Identifier: MIT
import { Connection } from './connection.mjs';
import { reasonOf, serverOf, wantsToken } from './probe.mjs';

const TOKEN_ERRORS = { 'token-needed': 'tokenNeeded', 'bad-token': 'badToken', 'expired-token': 'badToken' };

/**
 * The address of the stream. Without a `src` it is that of the page's own server, or, for a page that is a file, of the
 * script's.
 * @param {string|null} src @param {string} page address of the page @param {string} script address of this script
 */
export function streamAddress(src, page, script = import.meta.url) {
  const url = new URL(src || '/v1/stream', src || /^https?:/.test(page) ? page : script);
  url.protocol = url.protocol.replace(/^http/, 'ws');
  return url.href;
}

/**
 * Requests events with the media, unless the address says otherwise. A proxy before several daemons routes by the room.
 * @param {string} address @param {string|null} [room]
 */
export function withEvents(address, room = null) {
  const url = new URL(address);
  if (!url.searchParams.has('events')) url.searchParams.set('events', 'packed');
  if (room && !url.searchParams.has('room')) url.searchParams.set('key', room);
  return url.href;
}

/** The link to the server: the connection, or the reason for its absence. */
export class Link {
  #connection = null;
  #trouble = null;
  #violated = false; // the page's policy has refused the connection

  /**
   * @param {object} ports source() -> {src, token, room}; onstate, onmessage, onmedia: see Connection;
   *   ontrouble(name, values, told): what is wrong, as a name in strings.mjs, null = nothing any more; told: the page
   *   knows it already
   */
  constructor(ports) {
    this.ports = ports;
  }

  get state() {
    return this.#connection?.state ?? 'closed';
  }

  get address() {
    return streamAddress(this.ports.source().src, document.baseURI);
  }

  get #token() {
    return this.ports.source().token ?? new URL(this.address).searchParams.get('token');
  }

  open() {
    this.close();
    document.addEventListener('securitypolicyviolation', this.#onviolation);
    try {
      const connection = new Connection(withEvents(this.address, this.ports.source().room), {
        onstate: (state) => this.#stateChanged(connection, state),
        onmessage: (message) => this.#message(message),
        onmedia: this.ports.onmedia,
        onrefused: () => this.#refused(connection),
      });
      this.#connection = connection;
      connection.open();
    } catch (error) {
      this.#connection = null;
      const refused = this.#violated || location.protocol !== 'https:' ? 'blockedByPolicy' : 'mixedContent';
      this.#say(error.name === 'SecurityError' ? refused : 'badAddress');
    }
  }

  close() {
    document.removeEventListener('securitypolicyviolation', this.#onviolation);
    const connection = this.#connection;
    connection?.close();
    this.#connection = null;
    this.#violated = false;
    this.#say(null);
  }

  /** @returns {boolean} whether it went out */
  send(message) {
    return this.#connection?.send(message) ?? false;
  }

  /** @param {Int16Array|Uint8Array} sound @param {number} bytes of it a second @returns {boolean} whether it went out */
  sendSound(sound, bytes) {
    return this.#connection?.sendSound(sound, bytes) ?? false;
  }

  hurry() {
    this.#connection?.hurry();
  }

  #stateChanged(connection, state) {
    if (connection !== this.#connection) return;
    if (state.state === 'open') {
      this.#say(null);
      if (state.hello.tokens && !this.#token) this.#askForToken(connection);
    }
    this.ports.onstate(state);
  }

  #message(message) {
    if (message.type === 'error' && TOKEN_ERRORS[message.code]) this.#say(TOKEN_ERRORS[message.code], true);
    if (['authorized', 'joined', 'begin'].includes(message.type)) this.#say(null);
    this.ports.onmessage(message);
  }

  async #refused(connection) {
    const reason = this.#violated ? 'blockedByPolicy' : await reasonOf(connection.url);
    if (connection === this.#connection && connection.state !== 'open') this.#say(reason);
  }

  async #askForToken(connection) {
    const wanted = await wantsToken(connection.url);
    if (wanted && connection === this.#connection && connection.state === 'open') this.#say('tokenNeeded');
  }

  #onviolation = ({ effectiveDirective, blockedURI }) => {
    if (effectiveDirective !== 'connect-src' || !blockedURI.startsWith('ws')) return;
    if (this.#connection?.url.startsWith(new URL(blockedURI).origin)) this.#violated = true;
  };

  #say(trouble, told = false) {
    if (trouble === this.#trouble) return;
    this.#trouble = trouble;
    this.ports.ontrouble(trouble, trouble ? this.#values() : {}, told);
  }

  #values() {
    const src = this.ports.source().src ?? '';
    try {
      return { src: this.address, server: serverOf(this.address), origin: globalThis.origin };
    } catch {
      return { src };
    }
  }
}
