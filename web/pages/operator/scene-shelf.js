// SPDX-License-Identifier: MIT
// Scenes that the server keeps (/v1/scenes). What another desk has saved meanwhile is not overwritten: the server
// refuses, and says so.

/** @typedef {{name: string, bytes: number, saved: number}} Kept */

export class SceneShelf {
  #seen = new Map(); // the ETag of each content that was read or written here, by name

  /** @param {() => string|null} token that is used */
  constructor(token) {
    this.token = token;
  }

  /** @returns {Promise<Kept[]|null>} null: this server keeps none, or not for us */
  async list() {
    const response = await fetch('v1/scenes', { headers: this.#headers() });
    return response.ok ? (await response.json()).scenes : null;
  }

  /** @param {string} name @returns {Promise<unknown>} the scene, as JSON @throws {{code: string}} the server's error */
  async read(name) {
    const response = await this.#ask('GET', name);
    this.#seen.set(name, response.headers.get('etag'));
    return response.json();
  }

  /** Saves it where nobody has saved another content since it was read here. @throws {{code: string}} `changed`, and others */
  async save(name, scene) {
    const seen = this.#seen.get(name);
    const response = await this.#ask('PUT', name, { body: JSON.stringify(scene, null, 1), ...(seen ? { 'if-match': seen } : { 'if-none-match': '*' }) });
    this.#seen.set(name, response.headers.get('etag'));
  }

  async remove(name) {
    await this.#ask('DELETE', name, { 'if-match': this.#seen.get(name) ?? '""' });
    this.#seen.delete(name);
  }

  #headers(more = {}) {
    const token = this.token();
    return { ...(token ? { authorization: `Bearer ${token}` } : {}), ...more };
  }

  async #ask(method, name, { body, ...conditions } = {}) {
    const headers = this.#headers({ ...conditions, ...(body === undefined ? {} : { 'content-type': 'application/json' }) });
    const response = await fetch(`v1/scenes/${encodeURIComponent(name)}`, { method, body, headers, cache: 'no-store' });
    if (!response.ok) throw await response.json().catch(() => ({ code: 'unreachable' }));
    return response;
  }
}
