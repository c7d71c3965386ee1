// SPDX-License-Identifier: MIT
// The token for a server that requires one: from the page's address, stored for the tab, or from a field.
import { bearer } from './bearer.js';
import { forTab } from './storage.js';

const KEY = 'faccia.token';
const ERRORS = ['token-needed', 'bad-token', 'expired-token', 'early-token', 'revoked-token'];

/** Removes the token from the page's address, so that it stays out of the history and of shared links. */
function takeFromAddress() {
  const address = new URL(location.href);
  const token = address.searchParams.get('token');
  if (token === null) return null;
  address.searchParams.delete('token');
  history.replaceState(history.state, '', address);
  return token.trim() || null;
}

/** Returns the token of this tab: from the page's address, which is then stored, or the stored one. @returns {string|null} */
export function tokenOfTab() {
  const token = takeFromAddress() ?? forTab.get(KEY);
  if (token) forTab.set(KEY, token);
  return token;
}

export class Access {
  #waiting = []; // called when a token has been accepted

  /**
   * @param {HTMLFormElement} form with a field `token` and an element of the class `why`, hidden
   * @param {HTMLElement} head @param {(code: string) => string} words @param {() => void} accepted
   */
  constructor(form, head, words, accepted) {
    Object.assign(this, { form, head, words, accepted, code: null });
    this.token = tokenOfTab();
    if (this.token) this.#use(this.token);
    head.addEventListener('hello', ({ detail }) => detail.tokens && !this.token && this.ask('token-needed'));
    head.addEventListener('error', ({ detail }) => this.concerns(detail.code) && this.ask(detail.code));
    head.addEventListener('authorized', () => this.#settle());
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const token = form.elements.token.value.trim();
      if (token) this.#use(token);
      else form.elements.token.focus();
    });
  }

  concerns(code) {
    return ERRORS.includes(code);
  }

  /** Shows the field. An error about a token is more specific than the error that one is needed. */
  ask(code) {
    if (code !== 'token-needed') {
      forTab.remove(KEY);
      this.token = null;
    }
    if (!this.code || code !== 'token-needed') this.code = code;
    this.translate();
    this.form.hidden = false;
  }

  translate() {
    if (this.code) this.form.querySelector('.why').textContent = this.words(this.code);
    this.form.elements.token.setAttribute('aria-invalid', String(this.code !== null && this.code !== 'token-needed'));
  }

  /** Loads JSON from the server; asks for a token if needed, and retries. @param {string} address @returns {Promise<object>} */
  async load(address) {
    for (;;) {
      const response = await fetch(address, { headers: bearer(this.token) });
      if (response.ok) return response.json();
      const error = await response.json().catch(() => ({ code: 'unreachable' }));
      if (!this.concerns(error.code)) throw Object.assign(new Error(error.message), error);
      this.ask(error.code);
      await new Promise((resolve) => this.#waiting.push(resolve));
    }
  }

  #use(token) {
    this.token = token;
    this.code = null;
    forTab.set(KEY, token);
    if (this.head.getAttribute('token') === token) this.head.removeAttribute('token'); // so that it is tried again
    this.head.setAttribute('token', token);
  }

  #settle() {
    this.code = null;
    const asked = !this.form.hidden;
    this.form.hidden = true;
    this.form.elements.token.value = '';
    if (asked) this.accepted();
    for (const resolve of this.#waiting.splice(0)) resolve();
  }
}
