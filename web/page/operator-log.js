// SPDX-License-Identifier: MIT
// All that happens in the room and at this desk, with its time: for the operator's eyes, and for a study.
import { writeTable } from './scene.js';

const MOST = 100000; // a day of work

export class Log {
  #entries = [];

  /** @param {HTMLElement} list newest last @param {(what: string) => string} say its words */
  constructor(list, say) {
    Object.assign(this, { list, say });
  }

  /** @param {string} what happened, one word @param {string} [text] @param {object} [more] for the file alone */
  add(what, text = '', more = {}) {
    const entry = { time: new Date().toISOString(), what, text, ...more };
    if (this.#entries.push(entry) > MOST) this.#entries.shift();
    return entry;
  }

  /** Adds it, and shows it. @returns {HTMLElement} what shows its text */
  show(what, text = '', more = {}) {
    const { time } = this.add(what, text, more);
    const item = document.createElement('li'), stamp = document.createElement('time'), words = document.createElement('span');
    item.className = what;
    stamp.dateTime = time;
    stamp.textContent = `${time.slice(11, 19)} `;
    words.textContent = text;
    item.append(stamp, `${this.say(what)} `, words);
    this.list.append(item);
    while (this.list.children.length > 200) this.list.firstChild.remove();
    this.list.scrollTop = this.list.scrollHeight;
    return words;
  }

  get json() {
    return JSON.stringify(this.#entries, null, 1);
  }

  get csv() {
    const columns = ['time', 'what', 'text', 'by', 'id'];
    return writeTable([columns, ...this.#entries.map((entry) => columns.map((name) => String(entry[name] ?? '')))]);
  }
}
