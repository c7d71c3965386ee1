// SPDX-License-Identifier: MIT

const LINGER_MS = 1500; // after the end, so that the last words can be read

/** The captions on the page. */
export class CaptionView {
  /** @param {HTMLElement} box with the elements .said, .word and .rest */
  constructor(box) {
    this.box = box;
    this.spans = ['said', 'word', 'rest'].map((name) => box.querySelector(`.${name}`));
    this.key = '';
    this.timer = 0;
    this.clear();
  }

  set shown(on) {
    this.box.hidden = !on;
  }

  /**
   * @param {{said: string, word: string, rest: string}|null} line @param {string} [lang] of the text
   * @returns {boolean} whether they have changed
   */
  show(line, lang) {
    if (!line) {
      if (this.key && !this.timer) this.timer = setTimeout(() => this.clear(), LINGER_MS);
      return false;
    }
    clearTimeout(this.timer);
    this.timer = 0;
    const parts = [line.said, line.word, line.rest];
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
    this.#write(['', '', '']);
  }

  #write(parts) {
    this.spans.forEach((span, i) => (span.textContent = parts[i]));
    this.box.classList.toggle('empty', !parts.some(Boolean));
  }
}
