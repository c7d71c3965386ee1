// SPDX-License-Identifier: MIT
// Client of the documents that the server stores: texts (/v1/library/files), gestures (/v1/gestures), scenes (/v1/scenes).
import { bearer } from './bearer.js';

export class DocumentStore {
  #etags = new Map(); // by name: the ETag of the version that was last read or written here

  /**
   * @param {string} address of the collection @param {import('./access.js').Access} access
   * @param {string} [type] media type of a document
   */
  constructor(address, access, type = 'application/octet-stream') {
    Object.assign(this, { address, access, type });
  }

  /** @returns {Promise<{name: string}[]|null>} null when the server stores none, or refuses this user */
  async list() {
    const answer = await this.#request('GET').then((response) => response.json()).catch(() => null);
    return answer && Object.values(answer)[0];
  }

  /** @param {string} name @returns {Promise<string>} @throws {{code: string}} the server's error */
  async read(name) {
    const response = await this.#request('GET', name);
    this.#etags.set(name, response.headers.get('etag'));
    return response.text();
  }

  /**
   * Saves a document, unless another user has saved it since it was read here.
   * @throws {{code: string}} `changed`, and the server's other errors
   */
  async save(name, body) {
    const etag = this.#etags.get(name);
    const response = await this.#request('PUT', name, body, etag ? { 'if-match': etag } : { 'if-none-match': '*' });
    this.#etags.set(name, response.headers.get('etag'));
  }

  /** Adds a document, to which the server gives a name. @throws {{code: string}} the server's error */
  async add(body) {
    await this.#request('POST', null, body);
  }

  /** Removes a document, unless another user has saved it since. @throws as `save` */
  async remove(name) {
    await this.#request('DELETE', name, undefined, { 'if-match': this.#etags.get(name) ?? '""' });
    this.#etags.delete(name);
  }

  async #request(method, name, body, conditions = {}) {
    const headers = {
      ...conditions,
      ...(body === undefined ? {} : { 'content-type': this.type }),
      ...bearer(this.access.token),
    };
    const address = name ? `${this.address}/${encodeURIComponent(name)}` : this.address;
    const response = await fetch(address, { method, body, headers, cache: 'no-store' });
    if (!response.ok) throw await response.json().catch(() => ({ code: 'unreachable' }));
    return response;
  }
}
