// SPDX-License-Identifier: MIT
// Search as one types.
import { marked } from './text.js';

const PATIENCE_MS = 120; // between two keys
const LIMIT = 20;
const FACETS = ['author', 'form', 'century'];
const MISSED = '…'; // after the counts of a search that found more than it counts

/**
 * @param {HTMLFormElement} form with `q`, `lang`, and selects for the facets
 * @param {object} parts list, titles: elements; more: a button; facets: what holds their selects; table: a link
 * @param {object} ports load(address) -> Promise of JSON, or null; say(name, values); count(text): to be told; shown(on):
 *   whether results take the place of the works; lang(): of the page
 */
export class Search {
  #timer = 0;
  #turn = 0;
  #next = null;

  constructor(form, parts, ports) {
    Object.assign(this, { form, ...parts, ports });
    for (const name of FACETS) this.#offer(name, [], true);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#ask();
    });
    form.addEventListener('input', ({ target }) => {
      if (target === form.elements.q) for (const name of FACETS) form.elements[name].value = ''; // another search
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#ask(), PATIENCE_MS);
    });
    this.more.addEventListener('click', () => this.#ask(this.#next));
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
      this.more.hidden = this.facets.hidden = this.titles.hidden = true;
      this.ports.count('');
      return;
    }
    const chosen = ['lang', ...FACETS].map((name) => [name, this.form.elements[name].value]).filter(([, value]) => value);
    const asked = new URLSearchParams([['q', this.query], ...chosen]);
    this.table.href = `v1/library/concordance?${asked}&limit=1000&format=csv`;
    asked.set('limit', LIMIT);
    asked.set('prefer', this.ports.lang());
    if (after) asked.set('after', after);
    else asked.set('facets', 'true');
    const answer = await this.ports.load(`v1/library/search?${asked}`);
    if (turn !== this.#turn) return; // something else was typed
    const results = answer?.results ?? [];
    const items = results.map((result) => this.#item(result));
    if (after) this.list.append(...items);
    else this.list.replaceChildren(...items);
    this.#next = answer?.next ?? null;
    this.more.hidden = !this.#next;
    if (!answer) return;
    const n = `${answer.total}${answer.counted ? '' : MISSED}`;
    this.ports.count(this.ports.say(answer.total ? 'found' : 'nothingFound', { n }));
    if (!after) this.#narrow(answer);
  }

  /** Shows the titles that were found, and by what the results can be narrowed. */
  #narrow({ titles, facets, counted, total }) {
    this.titles.replaceChildren(...titles.map(({ id, title, author }) => this.#link(`${id}:1`, title, author)));
    this.titles.hidden = !titles.length;
    const offered = FACETS.map((name) => this.#offer(name, facets[name], counted));
    this.facets.hidden = !total && !offered.includes(true);
  }

  /** Fills a select with the values of a facet. Returns whether it offers a choice. */
  #offer(name, values, counted) {
    const select = this.form.elements[name], before = select.value;
    const called = (value) => (name === 'form' ? this.ports.say(`form_${value}`) : value);
    const options = values.map(({ value, count }) => new Option(`${called(value)} (${count}${counted ? '' : MISSED})`, value));
    select.replaceChildren(new Option(this.ports.say('allLanguages'), ''), ...options);
    select.value = options.some((option) => option.value === before) ? before : '';
    select.closest('label').hidden = values.length < 2 && !select.value;
    return !select.closest('label').hidden;
  }

  #link(place, title, author) {
    const link = document.createElement('a');
    link.href = `#${place}`;
    const name = document.createElement('span');
    name.textContent = title;
    const by = document.createElement('small');
    by.textContent = author ?? '';
    link.append(name, by);
    const item = document.createElement('li');
    item.append(link);
    return item;
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
