// SPDX-License-Identifier: MIT
// How a word is said: type it, hear it, save it as an entry of a lexicon; report a misread word, and see what was reported.
import { DocumentStore } from './document-store.js';
import { lexiconOf, withEntry } from './lexicon-file.js';
import { sayings as sayingsWords } from '../texts/index.js';

const NAME = /^[A-Za-z0-9_-][A-Za-z0-9._-]{0,63}$/; // of a file that the server saves
const LIBRARY = 'lexicon.pls';
const WORD = 200; // bytes, at most

const make = (name, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
};

export class Sayings {
  #report = null; // the report that is being corrected
  #files = null; // names of saved files; null: nothing can be saved here

  /**
   * @param {import('./frame.js').Frame} frame @param {HTMLDetailsElement} box
   * @param {object} ports selected() -> {word, lang, context?, work?, passage?} of the selection, or null; lang(): of a word
   *   that is typed; file(): name of the work's file, or null; quiet(): stops what is being read
   */
  constructor(frame, box, ports) {
    Object.assign(this, { frame, box, ports });
    this.keep = new DocumentStore('v1/library/files', frame.access);
    this.reported = new DocumentStore('v1/library/reports', frame.access, 'application/json');
    this.place = {};
    this.#build();
    frame.onTranslate(() => this.#translate());
    document.addEventListener('selectionchange', () => this.#take());
    box.addEventListener('toggle', () => box.open && this.#opened());
    frame.head.addEventListener('warning', ({ detail }) => {
      if (detail.field === 'lexicon') this.#tell('badEntry', { message: detail.message });
    });
  }

  say(name, values = {}) {
    return sayingsWords[this.frame.lang][name].replace(/\{(\w+)\}/g, (_, key) => values[key] ?? '');
  }

  #build() {
    const field = (text, input) => make('label', { className: 'field' }, this.#word('span', text), input);
    const button = (text, act, type = 'button') => {
      const element = this.#word('button', text);
      element.type = type;
      if (act) element.addEventListener('click', act);
      return element;
    };
    this.word = make('input', { type: 'text', autocomplete: 'off', spellcheck: false, maxLength: WORD, id: 'saying-word' });
    this.way = make('select', { id: 'saying-way' }, new Option('', 'alias'), new Option('', 'ipa'));
    this.said = make('input', { type: 'text', autocomplete: 'off', autocapitalize: 'none', spellcheck: false, maxLength: 500, id: 'saying-said' });
    this.where = make('select', { id: 'saying-place' });
    this.where.addEventListener('change', () => (this.chosen = this.where.value));
    this.news = make('p', { id: 'saying-news' });
    this.news.setAttribute('role', 'status');
    this.hint = Object.assign(this.#word('p', 'wordHint'), { className: 'hint', id: 'saying-hint' });
    this.word.setAttribute('aria-describedby', 'saying-hint');
    this.list = make('ul', { id: 'saying-reports' });
    this.reports = make('section', { hidden: true }, this.#word('h2', 'reports'), this.list);
    const save = Object.assign(button('save', null, 'submit'), { className: 'primary' });
    const form = make('form', { id: 'saying' }, field('word', this.word), this.hint,
      make('div', { className: 'row' }, field('way', this.way), field('said', this.said), button('hearIt', () => this.#hear())),
      make('div', { className: 'row' }, field('place', this.where), save, button('report', () => this.#send())));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#save();
    });
    this.box.append(this.#word('summary', 'sayings'), form, this.news, this.reports);
  }

  #word(name, text) {
    const element = document.createElement(name);
    element.dataset.saying = text;
    return element;
  }

  #translate() {
    for (const element of this.box.querySelectorAll('[data-saying]')) element.textContent = this.say(element.dataset.saying);
    this.way.options[0].label = this.say('asText');
    this.way.options[1].label = this.say('asIpa');
    this.showPlaces();
    for (const item of this.list.children) item.retell?.();
  }

  /** Where it can be saved: without the right, in a file. */
  showPlaces() {
    const chosen = this.chosen; // by the user; else the first
    const places = [...(this.#files && this.#workFile() ? ['inWork'] : []), ...(this.#files ? ['inLibrary'] : []), 'inFile'];
    this.where.replaceChildren(...places.map((place) => new Option(this.say(place), place)));
    if (places.includes(chosen)) this.where.value = chosen;
  }

  /** The file beside the work. @returns {string|null} */
  #workFile() {
    const name = (this.ports.file() ?? '').replace(/\.\w+$/, '');
    return NAME.test(`${name}.pls`) && `${name}.pls` !== LIBRARY ? `${name}.pls` : null;
  }

  #tell(name, values) {
    this.news.textContent = name ? this.say(name, values) : '';
  }

  /** Takes the word that is selected in the text. */
  #take() {
    if (this.box.contains(document.activeElement)) return;
    const found = this.ports.selected();
    const word = found?.word.trim().replace(/\s+/g, ' ');
    if (!word || new TextEncoder().encode(word).length > WORD) return;
    this.word.value = word;
    this.place = { ...found, word };
    this.#report = null;
  }

  async #opened() {
    this.#take();
    this.#files = (await this.keep.list())?.map(({ name }) => name) ?? null;
    this.showPlaces();
    await this.#showReports();
  }

  get #lang() {
    return (this.place.word === this.word.value && this.place.lang) || this.#report?.lang || this.ports.lang();
  }

  /** @returns {import('./lexicon-file.js').Entry|null} null: something is missing */
  #entry() {
    const word = this.word.value.trim();
    const said = this.said.value.trim();
    this.#tell(!word ? 'noWord' : !said ? 'noSaid' : '');
    if (!word || !said) {
      (word ? this.said : this.word).focus();
      return null;
    }
    return { word, [this.way.value]: said };
  }

  #hear() {
    const entry = this.#entry();
    if (!entry) return;
    this.ports.quiet?.();
    const lang = this.#lang;
    this.frame.problem.clear();
    this.frame.head.speak(entry.word, { lang, markup: 'plain', mode: 'replace', lexicon: lexiconOf(lang, [entry]) });
  }

  async #save() {
    const entry = this.#entry();
    if (!entry) return;
    const lang = this.#lang;
    if (this.where.value === 'inFile') {
      this.#download(lexiconOf(lang, [entry]));
      return;
    }
    const file = this.where.value === 'inWork' ? this.#workFile() : LIBRARY;
    try {
      const before = await this.keep.read(file).catch((error) => {
        if (error.code === 'not-found') return null;
        throw error;
      });
      await this.keep.save(file, before === null ? lexiconOf(lang, [entry]) : withEntry(before, lang, entry));
      this.#tell('saved', { word: entry.word, file });
      if (this.#report) await this.#remove(this.#report);
    } catch (error) {
      if (error.code === 'other-language') this.#tell('otherLang', { file, lang: this.frame.nameOf(error.lang) });
      else if (error.code === 'bad-xml') this.#tell('brokenFile', { file });
      else if (error.code === 'bad-lexicon') this.#tell('badEntry', { message: error.message });
      else this.frame.problem.show(error);
    }
  }

  #download(text) {
    const file = this.#workFile() ?? LIBRARY;
    const url = URL.createObjectURL(new Blob([text], { type: 'application/pls+xml' }));
    make('a', { href: url, download: file }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
    this.#tell('downloaded', { file });
  }

  // What readers report

  async #send() {
    const word = this.word.value.trim();
    if (!word) {
      this.#tell('noWord');
      this.word.focus();
      return;
    }
    const { context, work, passage } = this.place.word === word ? this.place : {};
    const note = this.said.value.trim();
    const shorter = (text, most) => text && [...text].slice(0, most).join('');
    try {
      const about = { word, lang: this.#lang, work, passage, context: shorter(context, 120), note: shorter(note, 120) };
      await this.reported.add(JSON.stringify(about, (_, value) => value || undefined)); // what is missing or empty is left out
      this.#tell('reported');
      if (!this.reports.hidden) await this.#showReports();
    } catch (error) {
      if (error.code === 'nothing-kept') this.#tell('noReports');
      else if (error.code === 'too-many-requests') this.#tell('tooMany');
      else this.frame.problem.show(error);
    }
  }

  /** Only who may operate gets them. */
  async #showReports() {
    const found = await this.reported.list();
    this.reports.hidden = !found;
    this.list.replaceChildren(...(found?.map((report) => this.#item(report)) ?? []));
    if (found && !found.length) this.list.append(Object.assign(this.#word('li', 'noneReported'), { textContent: this.say('noneReported') }));
  }

  #item(report) {
    const take = make('button', { type: 'button' });
    const drop = make('button', { type: 'button' });
    const about = [report.context && `… ${report.context} …`, report.work, report.note].filter(Boolean).join(' · ');
    take.addEventListener('click', () => this.#correct(report));
    drop.addEventListener('click', () => this.#remove(report).catch((error) => this.frame.problem.show(error)));
    const item = make('li', {}, take, ' ', make('small', { textContent: about, lang: report.lang }), ' ', drop);
    item.retell = () => {
      take.textContent = this.say('take', report);
      drop.textContent = this.say('drop');
      drop.ariaLabel = this.say('dismiss', report);
    };
    item.retell();
    return item;
  }

  #correct(report) {
    this.#report = report;
    this.place = report;
    this.word.value = report.word;
    this.said.value = report.note ?? '';
    this.#tell('');
    this.said.focus();
  }

  async #remove(report) {
    await this.reported.remove(report.name);
    if (this.#report === report) this.#report = null;
    await this.#showReports();
  }
}
