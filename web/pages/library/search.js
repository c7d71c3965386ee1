// SPDX-License-Identifier: MIT
// Search as one types.
import { marked } from './text.js';

const PATIENCE_MS = 120; // between two keys
const LIMIT = 20;

/**
 * @param {HTMLFormElement} form with `q` and `lang` @param {HTMLElement} list @param {HTMLElement} more a button
 * @param {object} ports load(address) -> Promise of JSON, or null; say(name, values); count(text): to be told; shown(on):
 *   whether results take the place of the works
 */
export class Search {
  #timer = 0;
  #turn = 0;
  #next = null;

  constructor(form, list, more, ports) {
    Object.assign(this, { form, list, more, ports });
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#ask();
    });
    form.addEventListener('input', () => {
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#ask(), PATIENCE_MS);
    });
    more.addEventListener('click', () => this.#ask(this.#next));
  }

  get query() {
    return this.form.elements.q.value.trim();
  }

  async #ask(after = null) {
    clearTimeout(this.#timer);
    const turn = ++this.#turn;
    this.ports.shown(this.query !== '');
    if (!this.query) {
      this.list.replaceChildren();
      this.more.hidden = true;
      this.ports.count('');
      return;
    }
    const asked = new URLSearchParams({ q: this.query, limit: LIMIT });
    if (this.form.elements.lang.value) asked.set('lang', this.form.elements.lang.value);
    if (after) asked.set('after', after);
    const answer = await this.ports.load(`v1/library/search?${asked}`);
    if (turn !== this.#turn) return; // something else was typed
    const results = answer?.results ?? [];
    const items = results.map((result) => this.#item(result));
    if (after) this.list.append(...items);
    else this.list.replaceChildren(...items);
    this.#next = answer?.next ?? null;
    this.more.hidden = !this.#next;
    const n = `${this.list.children.length}${this.#next ? '+' : ''}`;
    if (answer) this.ports.count(this.ports.say(n === '0' ? 'nothingFound' : 'found', { n }));
  }

  #item({ passage, n, lang, work, section, snippet, recording }) {
    const link = document.createElement('a');
    link.href = `#${passage}`;
    const text = document.createElement('span');
    text.className = 'snippet';
    text.lang = lang;
    text.append(snippet.before ? '… ' : '', ...marked(snippet.text, snippet.marks), snippet.after ? ' …' : '');
    const about = document.createElement('small');
    const line = n && this.ports.say('line', { n });
    about.textContent = [work.author, work.title, section.title, line, recording && this.ports.say('recording')].filter(Boolean).join(' · ');
    link.append(text, about);
    const item = document.createElement('li');
    item.append(link);
    return item;
  }
}
