// SPDX-License-Identifier: MIT
import { fetchOnce } from './cache.mjs';

/** Converts the address of a stream to that of its HTTP routes: ws://host/x/v1/stream -> http://host/x/v1/ */
export function httpBase(stream) {
  const url = new URL(stream);
  url.protocol = url.protocol === 'wss:' ? 'https:' : 'http:';
  url.search = url.hash = '';
  url.pathname = url.pathname.replace(/[^/]*$/, '');
  return url.href;
}

/**
 * Fetches a head model over HTTP, where caches help.
 * @param {string} url
 * @param {number|undefined} size of the model when it is known: the length that HTTP states is that of the packed form
 * @param {(loaded: number, total: number|null) => void} onprogress
 * @param {AbortSignal} signal
 */
export async function fetchModel(url, size, onprogress, signal) {
  const response = await fetch(url, { signal });
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  const length = response.headers.get('content-encoding') ? null : Number(response.headers.get('content-length'));
  const total = size || length || null;
  const pieces = [];
  let loaded = 0;
  const reader = response.body.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    pieces.push(value);
    loaded += value.length;
    onprogress(loaded, total && Math.max(total, loaded));
  }
  return JSON.parse(await new Blob(pieces).text());
}

/** Puts a head model together from the `model` messages of the stream. */
export class ModelAssembler {
  constructor() {
    this.model = null;
    this.seen = 0;
  }

  /** @param {object} message @returns {object|null} the model when it is whole */
  take({ index, count, kind, part, data }) {
    if (index === 0) {
      this.model = { ...data, parts: [], textures: {} };
      this.seen = 0;
    }
    if (!this.model || index !== this.seen) return null; // the rest of an earlier model
    this.seen++;
    if (kind === 'texture') this.model.textures[part] = data;
    else if (index > 0) this.model.parts.push(data);
    return this.seen === count ? this.model : null;
  }
}

/**
 * Brings the head: by HTTP, where caches help; where that way is closed (another origin that does not allow it, say), through
 * the stream.
 */
export class ModelSource {
  #assembler = new ModelAssembler();
  #aborter = null;
  #address = null; // of the model that is here or on its way
  #asked = false; // whether it was requested through the stream; lost with the connection

  /**
   * @param {object} ports ask(message): through the stream; progress({loaded, total, ratio}); show(json): the model is here;
   *   fail(): `load` got none
   */
  constructor(ports) {
    this.ports = ports;
  }

  /** Forgets what is here or on its way. */
  close() {
    this.#aborter?.abort();
    this.#assembler = new ModelAssembler();
    this.#address = null;
  }

  /**
   * The stream is there, once more perhaps.
   * @param {string} stream its address
   * @param {object} hello the server's
   * @param {string|null} wish the name of a model; null: the server's first
   * @param {boolean} [pictures] whether its pictures take its place, where it has some
   */
  async open(stream, hello, wish, pictures = false) {
    const name = wish ?? hello.models?.[0]?.name;
    const known = hello.models?.find((model) => model.name === name);
    const drawn = !(pictures && known?.pictures);
    const version = known?.hash ? `?v=${known.hash}` : ''; // an address whose answer never changes: caches need not ask again
    const address = drawn ? `models/${encodeURIComponent(name)}${version}` : known.pictures;
    if (!name || (address === this.#address && !this.#asked)) return;
    this.#aborter?.abort(); // what is on its way is wanted no more
    this.#address = address;
    this.#asked = false;
    this.#aborter = new AbortController();
    const { signal } = this.#aborter;
    const size = drawn ? known?.bytes : undefined;
    const progress = (loaded, total) => this.ports.progress({ loaded, total, ratio: total ? loaded / total : null });
    let json;
    try {
      const whole = httpBase(stream) + address;
      const load = (...how) => fetchModel(whole, size, ...how);
      json = await (drawn && version ? fetchOnce(whole, load, progress, signal) : load(progress, signal));
    } catch {
      if (signal.aborted) return;
      this.#asked = true;
      this.ports.ask({ type: 'model', name });
      return;
    }
    this.#show(json);
  }

  /** Brings the head of an address, without a stream. @param {string} address */
  async load(address) {
    if (address === this.#address) return;
    this.close();
    this.#address = address;
    const { signal } = (this.#aborter = new AbortController());
    const progress = (loaded, total) => this.ports.progress({ loaded, total, ratio: total ? loaded / total : null });
    try {
      this.#show(await fetchModel(address, undefined, progress, signal));
    } catch {
      if (signal.aborted) return;
      this.#address = null;
      this.ports.fail();
    }
  }

  /** @param {object} message of type `model` */
  take(message) {
    const { index, count } = message;
    this.ports.progress({ loaded: index + 1, total: count, ratio: (index + 1) / count });
    const json = this.#assembler.take(message);
    if (json) this.#show(json);
  }

  #show(json) {
    this.#asked = false;
    this.ports.show(json);
  }
}
