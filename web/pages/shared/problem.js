// SPDX-License-Identifier: MIT
// Errors, said in the page's language with what to do, and where they are.

/** Those that a new connection ends. */
const OF_THE_LINK = ['connection-lost', 'no-connection', 'too-many-connections', 'too-many-per-address', 'too-slow', 'stopping', 'unreachable', 'no-server',
  'server-busy', 'wrong-address', 'forbidden-origin'];

/** Those whose message says more than their text here. */
const DETAILED = ['film-failed'];

/**
 * Describes the place of an error.
 * @param {object} error @param {(name: string, values: object) => string} say @returns {string}
 */
export function placeOf({ line, column, byte, field }, say) {
  if (line !== undefined) return say('atLine', { line, column });
  if (byte !== undefined) return say('atByte', { byte });
  return field === undefined ? '' : say('atField', { field });
}

/** @returns {number} where a line and column, counted from 1 in characters, are in the text, in UTF-16 units */
export function placeIn(text, line, column) {
  const lines = text.split('\n').slice(0, line);
  const before = lines.slice(0, -1).reduce((sum, each) => sum + each.length + 1, 0);
  return before + [...(lines.at(-1) ?? '')].slice(0, column - 1).join('').length;
}

const paragraph = (className, text) => {
  const element = document.createElement('p');
  element.className = className;
  element.textContent = text;
  return element;
};

export class Problem {
  /**
   * @param {HTMLElement} box @param {(code: string) => string|undefined} words of an error by its code
   * @param {(name: string, values?: object) => string} say
   * @param {HTMLTextAreaElement|null} field what lines and columns count in
   */
  constructor(box, words, say, field) {
    Object.assign(this, { box, words, say, field, error: null });
  }

  /** @param {{code: string, message?: string, line?: number, column?: number, byte?: number, field?: string}} error */
  show(error) {
    this.error = error;
    const known = this.words(error.code);
    const place = placeOf(error, this.say);
    const parts = [paragraph('what', known ?? error.message ?? error.code)];
    if (place) parts.push(paragraph('place', place));
    if (known && error.message && (place || DETAILED.includes(error.code))) {
      const detail = paragraph('detail', error.message);
      detail.lang = 'en';
      parts.push(detail);
    }
    if (error.line !== undefined && this.field) parts.push(this.#way(error));
    this.box.replaceChildren(...parts);
  }

  clear() {
    this.error = null;
    this.box.replaceChildren();
  }

  /** Hides the message on a lost connection. */
  linked() {
    if (OF_THE_LINK.includes(this.error?.code)) this.clear();
  }

  translate() {
    if (this.error) this.show(this.error);
  }

  /** A button to the place in the text. */
  #way({ line, column = 1 }) {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = this.say('goThere');
    button.addEventListener('click', () => {
      const place = placeIn(this.field.value, line, column);
      this.field.focus();
      this.field.setSelectionRange(place, Math.min(place + 1, this.field.value.length));
    });
    return button;
  }
}
