// SPDX-License-Identifier: MIT
// All that happens in the room and at this desk, with its time: for the operator's eyes, and for a study.
import { writeTable } from './scene.js';

const MOST = 100000; // a day of work

export class Log {
  #entries = [];
  #listeners = new WeakSet(); // entries about a listener
  silent = false; // of the listener nothing is written down

  /** @param {HTMLElement} list newest last @param {(what: string) => string} say its words */
  constructor(list, say) {
    Object.assign(this, { list, say });
  }

  /**
   * @param {string} what happened, one word @param {string} [text]
   * @param {object} [more] for the file alone; listener: the entry is about a listener
   */
  add(what, text = '', { listener = false, ...more } = {}) {
    const entry = { time: new Date().toISOString(), what, text, ...more };
    if (listener && this.silent) return entry;
    if (listener) this.#listeners.add(entry);
    if (this.#entries.push(entry) > MOST) this.#entries.shift();
    return entry;
  }

  /** Adds it, and shows it, or what of it is `shown` at first. @returns {HTMLElement} what shows its text */
  show(what, text = '', { shown = text, ...more } = {}) {
    const { time } = this.add(what, text, more);
    const item = document.createElement('li'), stamp = document.createElement('time'), words = document.createElement('span');
    item.className = what;
    stamp.dateTime = time;
    stamp.textContent = `${time.slice(11, 19)} `;
    words.textContent = shown;
    item.append(stamp, `${this.say(what)} `, words);
    this.list.append(item);
    while (this.list.children.length > 200) this.list.firstChild.remove();
    this.list.scrollTop = this.list.scrollHeight;
    return words;
  }

  /** All that tells something of the listener. */
  forget() {
    this.#entries = this.#entries.filter((entry) => !this.#listeners.has(entry));
  }

  get json() {
    return JSON.stringify(this.#entries, null, 1);
  }

  get csv() {
    const columns = ['time', 'what', 'text', 'by', 'id'];
    return writeTable([columns, ...this.#entries.map((entry) => columns.map((name) => String(entry[name] ?? '')))]);
  }
}
