// SPDX-License-Identifier: MIT
// A client of a faccia server without a face: messages, sound and FAP frames, for Node.js and for browsers.
import { decodeChunk } from '../../protocol/chunk/chunk.mjs';
import { CompactReader, isCompact } from '../../protocol/chunk/compact.mjs';
import { Connection } from '../element/stream/connection.mjs';

/** Messages that end nothing, but concern an utterance by its id or number. */
const own = (message, utterance) =>
  message.id === utterance.id || (utterance.number !== null && message.utterance === utterance.number);

/** An utterance. `for await` yields its messages in order, from the moment of the call; `done` resolves with its `end`. */
export class Utterance {
  #queue = null; // NULL: nobody asks
  #wake = () => {};
  #end;

  constructor(client, id) {
    this.client = client;
    this.id = id;
    /** Its number on the stream: what media name. Null until `begin`. */
    this.number = null;
    /** @type {object[]} errors of this utterance */
    this.errors = [];
    this.done = new Promise((resolve) => (this.#end = resolve));
  }

  /** More of a text that was begun with `open`. @returns {boolean} whether it went out */
  write(text) {
    return this.client.send({ type: 'text', id: this.id, text });
  }

  /** Treats the text written so far as a complete sentence. */
  flush() {
    return this.client.send({ type: 'flush', id: this.id });
  }

  /**
   * Sends more sound of an utterance begun with `voice`.
   * @param {Int16Array|Uint8Array} samples @returns {boolean} whether it went out
   */
  sound(samples) {
    return this.client.connection.sendSound(samples);
  }

  /** All of it has been written, or said. */
  close() {
    return this.client.send({ type: 'close', id: this.id });
  }

  /** It is not said, or not to its end. */
  cancel() {
    return this.client.send({ type: 'cancel', id: this.id });
  }

  [Symbol.asyncIterator]() {
    this.#queue ??= [];
    return this.#events();
  }

  async *#events() {
    for (;;) {
      while (this.#queue.length) {
        const event = this.#queue.shift();
        yield event;
        if (event.type === 'end') return;
      }
      await new Promise((resolve) => (this.#wake = resolve));
    }
  }

  /** Position that has been received. */
  hear(event) {
    if (event.type === 'begin') this.number = event.utterance;
    if (event.type === 'error') this.errors.push(event);
    this.#queue?.push(event);
    this.#wake();
    if (event.type === 'end') this.#end(event);
  }
}

/**
 * A stream of a server. Events and their `detail`: `message` (a server message), `media` (a decoded chunk), `state`
 * (`connecting`, `open`, `waiting` or `closed`). Reconnects after a lost connection; utterances in progress end with
 * the reason `lost`.
 */
export class Client extends EventTarget {
  #utterances = new Map();
  #reader = new CompactReader();
  #last = 0;
  #name = Math.random().toString(36).slice(2, 8);

  /** @param {string} address of the stream, with its query @param {object} platform see connect() */
  constructor(address, platform = {}) {
    super();
    /** The server's `hello`; null before it arrives. */
    this.hello = null;
    this.connection = new Connection(address, {
      onstate: ({ state }) => this.#stateChanged(state),
      onmessage: (message) => this.#hear(message),
      onmedia: (data) => this.#media(data),
    }, platform);
    this.connection.open();
  }

  get state() {
    return this.connection.state;
  }

  /** A message as the protocol has it. @returns {boolean} whether it went out */
  send(message) {
    return this.connection.send(message);
  }

  /**
   * @param {string} text
   * @param {object} options the members of `speak`: lang, voice, markup, mode, open...
   * @returns {Utterance} ends with the reason `lost` if it could not be sent
   */
  speak(text, options = {}) {
    return this.#say({ type: 'speak', text, ...options });
  }

  /** Something that is written word by word: write(), flush(), close(). */
  open(options = {}) {
    return this.#say({ type: 'speak', open: true, ...options });
  }

  /** A recording of the server's folder. */
  play(name, options = {}) {
    return this.#say({ type: 'play', name, ...options });
  }

  /**
   * Starts a live voice: send sound with sound(), end it with close(). @param {object} options the members of `voice`: rate,
   * lang, codec, mode...
   */
  voice(options) {
    return this.#say({ type: 'voice', ...options });
  }

  close() {
    this.connection.close();
  }

  #say(message) {
    const utterance = new Utterance(this, message.id ?? `${this.#name}-${++this.#last}`);
    this.#utterances.set(utterance.id, utterance);
    if (!this.send({ ...message, id: utterance.id })) queueMicrotask(() => this.#lose(utterance));
    return utterance;
  }

  #hear(message) {
    if (message.type === 'hello') this.hello = message;
    this.dispatchEvent(new CustomEvent('message', { detail: message }));
    for (const utterance of this.#utterances.values()) {
      if (!own(message, utterance)) continue;
      utterance.hear(message);
      if (message.type === 'end') this.#utterances.delete(utterance.id);
    }
  }

  #media(data) {
    const chunk = { type: 'media', ...(isCompact(data) ? this.#reader.decode(data) : decodeChunk(data)) };
    for (const event of chunk.events ?? []) this.#hear(event);
    this.dispatchEvent(new CustomEvent('media', { detail: chunk }));
    for (const utterance of this.#utterances.values()) if (utterance.number === chunk.utterance) utterance.hear(chunk);
  }

  #stateChanged(state) {
    if (state === 'connecting') this.#reader = new CompactReader();
    if (state === 'waiting' || state === 'closed') for (const utterance of [...this.#utterances.values()]) this.#lose(utterance);
    this.dispatchEvent(new CustomEvent('state', { detail: state }));
  }

  #lose(utterance) {
    if (this.#utterances.delete(utterance.id)) utterance.hear({ type: 'end', id: utterance.id, reason: 'lost' });
  }
}

/** Returns the address of a server's stream, with its query. */
function streamAddress(server, { WebSocket: _, ...members }) {
  const url = new URL(server);
  url.protocol = url.protocol.replace(/^http/, 'ws');
  if (url.pathname === '/') url.pathname = '/v1/stream';
  const usual = { audio: 'pcm', fap: 'plain' };
  const told = Object.entries({ ...usual, ...members }).filter(([, value]) => value !== undefined && value !== null);
  for (const [name, value] of told) url.searchParams.set(name, value);
  if (members.room) url.searchParams.set('key', members.room);
  return url.href;
}

/**
 * Opens a stream and waits until the server greets.
 * @param {string} server `http://localhost:8080`, or the address of its stream
 * @param {object} options parameters of the address (lang, voice, rate, room, token, fps, idle..., audio `pcm` or `opus`, fap
 *   `plain` or `fapc`, events `packed`); WebSocket: the class to use where none is built in (Node.js before 22: that of
 * `ws`); signal
 * @returns {Promise<Client>} rejects if the first attempt fails
 */
export function connect(server, { signal, ...options } = {}) {
  return new Promise((resolve, reject) => {
    const client = new Client(streamAddress(server, options), options.WebSocket ? { WebSocket: options.WebSocket } : {});
    const fail = (error) => {
      client.close();
      reject(error);
    };
    if (signal?.aborted) fail(signal.reason);
    signal?.addEventListener('abort', () => fail(signal.reason), { once: true });
    client.addEventListener('state', function settle({ detail }) {
      if (detail === 'waiting') fail(new Error(`no faccia server answers at ${server}`));
      if (detail === 'open') queueMicrotask(() => resolve(client));
      if (detail !== 'connecting') client.removeEventListener('state', settle);
    });
  });
}
