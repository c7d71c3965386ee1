// SPDX-License-Identifier: MIT
import { CAPTION_CHARACTERS, CAPTION_LEAST_EM } from './captions.mjs';

const LINGER_MS = 1500; // after the end, so that the last words can be read
const LINES = 2;
const CHARACTER_EM = 0.6; // how wide a character is in a wide face, more or less: a line more would shift the picture
const PADDING_EM = 1.2;
const LEAST_CHARACTERS = 16;
const OVER_SHARE = 0.17; // share of the picture's height below the chin

/** The captions on the page. */
export class CaptionView {
  /** @param {HTMLElement} box with the elements .who, .said, .word and .rest */
  constructor(box) {
    this.box = box;
    this.spans = ['who', 'said', 'word', 'rest'].map((name) => box.querySelector(`.${name}`));
    this.key = '';
    this.timer = 0;
    this.size = CAPTION_CHARACTERS; // how many characters there is room for
    this.layout = box.parentElement;
    this.resize = new ResizeObserver(() => this.#measure());
    this.clear();
  }

  open() {
    this.resize.observe(this.box);
    this.resize.observe(this.layout);
  }

  close() {
    this.resize.disconnect();
  }

  set shown(on) {
    this.box.hidden = !on;
  }

  /**
   * @param {{said: string, word: string, rest: string}|null} line @param {string} [lang] of the text
   * @param {string} [who] name of who speaks
   * @returns {boolean} whether they have changed
   */
  show(line, lang, who) {
    if (!line) {
      if (this.key && !this.timer) this.timer = setTimeout(() => this.clear(), LINGER_MS);
      return false;
    }
    clearTimeout(this.timer);
    this.timer = 0;
    const parts = [who ? `${who}: ` : '', line.said, line.word, line.rest];
    const key = parts.join('\u0000');
    if (key === this.key) return false;
    this.key = key;
    if (lang) this.box.lang = lang;
    this.#write(parts);
    return true;
  }

  clear() {
    clearTimeout(this.timer);
    this.timer = 0;
    this.key = '';
    this.#write(['', '', '', '']);
  }

  #measure() {
    const em = parseFloat(getComputedStyle(this.box).fontSize);
    const width = this.box.clientWidth || this.layout.clientWidth; // without words they may take no room
    const room = Math.floor((LINES * (width / em - PADDING_EM)) / CHARACTER_EM);
    this.size = Math.min(CAPTION_CHARACTERS, Math.max(LEAST_CHARACTERS, room));
    // Captions that leave the chin free lie over the picture; larger ones have room of their own below it while
    // there are words.
    this.layout.classList.toggle('over', CAPTION_LEAST_EM * em <= OVER_SHARE * this.layout.clientHeight);
  }

  #write(parts) {
    this.spans.forEach((span, i) => (span.textContent = parts[i]));
    const empty = !parts.some(Boolean);
    this.box.classList.toggle('empty', empty);
    this.box.part.toggle('captions-empty', empty);
  }
}
