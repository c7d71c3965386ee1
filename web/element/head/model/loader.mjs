// SPDX-License-Identifier: MIT

/** Where the HTTP side of a stream's server is: ws://host/x/v1/stream -> http://host/x/v1/ */
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
    if (!this.model || index !== this.seen) return null; // the rest of one that began before
    this.seen++;
    if (kind === 'texture') this.model.textures[part] = data;
    else if (index > 0) this.model.parts.push(data);
    return this.seen === count ? this.model : null;
  }
}
