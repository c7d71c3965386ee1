// SPDX-License-Identifier: MIT
// The frame of the pages: texts in the user's language, the state of the connection, the token, errors, captions.
import { Access } from './access.js';
import { openCaptionChoice } from './caption-choice.js';
import { fillTexts, openMenu, showConnection, showPage } from './header.js';
import { fill, ownName, pageLanguage } from './languages.js';
import { Problem } from './problem.js';
import { errors, shared } from '../texts/index.js';
import { forGood } from './storage.js';

const KEY = 'faccia.language';
const IN_THE_PICTURE = ['no-webgl', 'too-many']; // errors that the head itself shows instead of the face
const $ = (id) => document.getElementById(id);

export class Frame {
  #translators = [];
  #state = 'connecting';
  #shown = null; // the head

  /** @param {Record<string, object>} words of the page, by language @param {{captions?: {on?: boolean}}} [wish] of a link */
  constructor(words, { captions } = {}) {
    this.words = words;
    this.head = $('head');
    const kept = forGood.get(KEY);
    this.lang = pageLanguage(kept ? [kept, ...navigator.languages] : navigator.languages, Object.keys(words));
    this.say = this.say.bind(this);
    this.problem = new Problem($('problem'), (code) => this.#error(code), this.say, $('text'));
    this.access = new Access($('access'), this.head, (code) => this.#error(code), () => this.tell('tokenGood'));
    openCaptionChoice($('caption-box'), this.head, captions);
    openMenu();
    fill($('page-lang'), Object.keys(words), { page: this.lang, chosen: this.lang });
    $('page-lang').addEventListener('change', ({ target }) => {
      this.lang = target.value;
      forGood.set(KEY, this.lang);
      this.translate();
    });
    this.#follow();
  }

  /** Returns a text in the page's language. @param {string} name @param {object} [values] for the names in braces */
  say(name, values = {}) {
    const text = this.words[this.lang][name] ?? shared[this.lang][name];
    return text.replace(/\{(\w+)\}/g, (_, key) => values[key] ?? '');
  }

  /** Shows a temporary message. */
  tell(name) {
    $('news').textContent = name ? this.say(name) : '';
  }

  /** Also calls `act` whenever the language of the page changes. */
  onTranslate(act) {
    this.#translators.push(act);
  }

  translate() {
    document.documentElement.lang = this.head.lang = this.lang;
    document.title = `${this.say('title')} · faccia`;
    fillTexts(document, this.say);
    this.problem.translate();
    this.access.translate();
    this.#showState();
    this.#showCredits();
    for (const act of this.#translators) act();
    showPage();
  }

  /** Loads the head; from here on its methods are there. @returns {Promise<object>} what its module exports */
  async open() {
    this.translate();
    return this.loadHead();
  }

  /** The same for a page that has been translated. */
  async loadHead() {
    if (!globalThis.isSecureContext) this.tell('insecure');
    try {
      return await import('./talking-head.js');
    } catch (error) {
      this.problem.show({ code: 'no-element', message: String(error) });
      throw error;
    }
  }

  /** Loads JSON from the server, and shows an error. @returns {Promise<object|null>} */
  async load(address) {
    try {
      return await this.access.load(address);
    } catch (error) {
      this.problem.show({ code: error.code ?? 'unreachable', message: error.message });
      return null;
    }
  }

  /** What the event `ready` has said of the head. @returns {{model: string, title: string, credits: string[]}|null} */
  get shown() {
    return this.#shown;
  }

  nameOf(tag) {
    return ownName(tag, this.lang);
  }

  #error(code) {
    return errors[this.lang][code];
  }

  #follow() {
    const { head } = this;
    head.addEventListener('connection', ({ detail }) => {
      this.#state = detail.state;
      this.#showState();
      if (detail.state === 'open') this.problem.linked();
    });
    head.addEventListener('ready', ({ detail }) => {
      this.#shown = detail;
      this.#showCredits();
    });
    head.addEventListener('error', ({ detail }) => {
      if (!this.access.concerns(detail.code) && !IN_THE_PICTURE.includes(detail.code)) this.problem.show(detail);
    });
    head.addEventListener('warning', ({ detail }) => {
      if (detail.code === 'bad-xml') this.problem.show(detail); // its words are spoken, not what its tags say
    });
    head.addEventListener('begin', ({ detail }) => {
      if (this.problem.error?.id === undefined || this.problem.error.id !== detail.id) this.problem.clear();
    });
    head.addEventListener('sound', ({ detail }) => {
      if (detail.sound === 'none') this.tell('noSound');
    });
  }

  #showState() {
    showConnection(this.#state, this.say);
  }

  #showCredits() {
    if (this.#shown) $('credits').textContent = this.say('head', { title: this.#shown.title, credits: this.#shown.credits.join(' ') });
  }
}
