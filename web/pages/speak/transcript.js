// SPDX-License-Identifier: MIT
// The transcript: sentences as they are heard, with the current word marked.

/**
 * @typedef {{start: number, plain: object, text: string, lang: string, voice: string, parts: Text[],
 *   button: HTMLElement}} Sentence
 */
/** @typedef {{item: HTMLElement, sentences: Sentence[]}} Paragraph of an utterance */

export class Transcript {
  #said = []; // paragraphs
  #targets = new Map(); // by the id of a `speak`: {paragraph, alone}, where its words are to be marked; alone: one sentence
  #spoken = null; // what is heard now: {paragraph, alone, lang, voice, markup}
  #current = null; // its sentence
  #marked = null; // the sentence with a mark
  #count = 0;

  /**
   * @param {HTMLElement} list for the utterances @param {new (text: string, markup: string) => object} PlainText
   * @param {(sentence: Sentence, id: string) => void} again a sentence was pressed
   */
  constructor(list, PlainText, again) {
    Object.assign(this, { list, PlainText, again });
  }

  /** @param {HTMLElement} head whose events tell what is heard */
  follow(head) {
    head.addEventListener('begin', ({ detail }) => this.#begin(detail));
    head.addEventListener('sentence', ({ detail }) => this.#sentence(detail));
    head.addEventListener('word', ({ detail }) => this.#word(detail));
    head.addEventListener('end', ({ detail }) => this.#end(detail));
  }

  /** @returns {string} an id for a `speak` whose sentences are new here */
  newId() {
    return `said-${++this.#count}`;
  }

  /** @returns {string} an id for a `speak` that repeats an earlier one */
  repeatId(id) {
    const again = this.newId();
    if (this.#targets.has(id)) this.#targets.set(again, this.#targets.get(id));
    return again;
  }

  /** @returns {string} all of it, a paragraph for each utterance */
  get text() {
    const paragraphs = this.#said.map(({ sentences }) => sentences.map(({ text }) => text).join(' '));
    return paragraphs.filter(Boolean).join('\n\n');
  }

  clear() {
    this.#said = [];
    this.#targets.clear();
    this.#spoken = this.#current = this.#marked = null;
    this.list.replaceChildren();
  }

  #begin({ id, lang, voice, markup, play }) {
    this.#end();
    if (play) return; // a recording has no words
    const target = this.#targets.get(id) ?? { paragraph: this.#paragraph(), alone: null };
    if (id) this.#targets.set(id, target);
    this.#spoken = { ...target, lang, voice, markup };
    this.#current = target.alone;
  }

  #paragraph() {
    const paragraph = { item: document.createElement('li'), sentences: [] };
    this.#said.push(paragraph);
    return paragraph;
  }

  #sentence({ text, utf16_start: start }) {
    const spoken = this.#spoken;
    if (!spoken || spoken.alone) return;
    this.#current = spoken.paragraph.sentences.find((sentence) => sentence.start === start) ?? this.#add(spoken, text, start);
    this.#mark(this.#current);
  }

  #add({ paragraph: { item, sentences }, lang, voice, markup }, source, start) {
    const plain = new this.PlainText(source, markup);
    const button = document.createElement('button');
    const word = document.createElement('mark');
    const parts = [document.createTextNode(''), word, document.createTextNode('')];
    button.type = 'button';
    button.lang = lang;
    button.dir = 'auto';
    button.append(...parts);
    const sentence = { start, plain, text: plain.text.trim(), lang, voice, parts, button };
    button.addEventListener('click', () => {
      const id = this.newId();
      this.#targets.set(id, { alone: sentence });
      this.again(sentence, id);
    });
    if (!sentences.length) this.list.append(item);
    sentences.push(sentence);
    item.append(button, ' ');
    return sentence;
  }

  #word({ utf16_start: from, utf16_end: to }) {
    const current = this.#current;
    if (!current) return;
    const lead = current.plain.text.indexOf(current.text);
    const at = (place) => (this.#spoken.alone ? place : current.plain.at(place - current.start) - lead);
    this.#mark(current, at(from), at(to));
  }

  #end() {
    this.#mark(null);
    this.#spoken = this.#current = null;
  }

  /** Marks a stretch of a sentence, and nothing else. */
  #mark(sentence, from = 0, to = 0) {
    if (this.#marked && this.#marked !== sentence) {
      this.#marked.button.classList.remove('current');
      this.#write(this.#marked, 0, 0);
    }
    this.#marked = sentence;
    if (!sentence) return;
    this.#write(sentence, from, to);
    sentence.button.classList.add('current');
    this.#reveal(sentence.button);
  }

  #write({ text, parts }, from, to) {
    parts[0].data = text.slice(0, from);
    parts[1].textContent = text.slice(from, to);
    parts[2].data = text.slice(to);
  }

  /** Scrolls the list, never the page. */
  #reveal(button) {
    const { list } = this;
    const top = button.offsetTop - list.offsetTop;
    if (top < list.scrollTop) list.scrollTop = top;
    else list.scrollTop = Math.max(list.scrollTop, top + button.offsetHeight - list.clientHeight);
  }
}
