// SPDX-License-Identifier: MIT
// Logs all events of the room and of this page with their time, for the operator and for studies.
import { writeTable } from './scene.js';

const MOST = 100000; // a day of work

export class Log {
  #entries = [];
  #listeners = new WeakSet(); // entries about a listener
  silent = false; // entries about the listener are not stored

  /** @param {HTMLElement} list newest last @param {(what: string) => string} say its words */
  constructor(list, say) {
    Object.assign(this, { list, say });
  }

  /**
   * @param {string} kind of event, one word @param {string} [text]
   * @param {object} [more] members for the file only; listener: the entry is about a listener
   */
  add(what, text = '', { listener = false, ...more } = {}) {
    const entry = { time: new Date().toISOString(), what, text, ...more };
    if (listener && this.silent) return entry;
    if (listener) this.#listeners.add(entry);
    if (this.#entries.push(entry) > MOST) this.#entries.shift();
    return entry;
  }

  /** Adds an entry, and shows its text, or initially only `shown`. @returns {HTMLElement} the element with the text */
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

  /** Removes all entries about the listener. */
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
