// SPDX-License-Identifier: MIT
// What editors save on the server (/v1/library/files, /v1/gestures). What somebody else has saved, or saved meanwhile, is
// not overwritten: the server refuses, and says so.

export class Keep {
  #seen = new Map(); // the ETag of each content that was read or written here, by name

  /** @param {string} address of the folder @param {import('./access.js').Access} access */
  constructor(address, access) {
    Object.assign(this, { address, access });
  }

  /** @returns {Promise<string[]|null>} names; null: nothing is kept there, or not for us */
  async list() {
    const answer = await this.#ask('GET').then((response) => response.json()).catch(() => null);
    return answer && Object.values(answer)[0].map(({ name }) => name);
  }

  /** @param {string} name @returns {Promise<string>} @throws {{code: string}} the server's error */
  async read(name) {
    const response = await this.#ask('GET', name);
    this.#seen.set(name, response.headers.get('etag'));
    return response.text();
  }

  /** Saves it where nobody has saved another content since it was seen here. @throws {{code: string}} `changed`, and others */
  async save(name, body) {
    const seen = this.#seen.get(name);
    const response = await this.#ask('PUT', name, body, seen ? { 'if-match': seen } : { 'if-none-match': '*' });
    this.#seen.set(name, response.headers.get('etag'));
  }

  async #ask(method, name, body, conditions = {}) {
    const { token } = this.access;
    const headers = { ...conditions, ...(body === undefined ? {} : { 'content-type': 'application/octet-stream' }), ...(token ? { authorization: `Bearer ${token}` } : {}) };
    const response = await fetch(name ? `${this.address}/${encodeURIComponent(name)}` : this.address, { method, body, headers, cache: 'no-store' });
    if (!response.ok) throw await response.json().catch(() => ({ code: 'unreachable' }));
    return response;
  }
}
