// SPDX-License-Identifier: MIT
// Logs the events of the element; consecutive events of one kind are counted instead of listed.

const MOST = 100;

/** Describes an event in a line, without samples, frames and long texts. */
export function inAWord(detail) {
  return JSON.stringify(detail, (key, value) => {
    if (ArrayBuffer.isView(value)) return `${value.length} values`;
    if (Array.isArray(value) && value.length > 12) return `${value.length} items`;
    return typeof value === 'string' && value.length > 80 ? `${value.slice(0, 79)}…` : value;
  }) ?? '';
}

export class EventLog {
  #list;
  #last = null;

  constructor(list) {
    this.#list = list;
  }

  clear() {
    this.#list.replaceChildren();
    this.#last = null;
  }

  add(name, detail) {
    if (this.#last?.dataset.event !== name) {
      this.#last = document.createElement('li');
      this.#last.dataset.event = name;
      this.#last.dataset.count = 0;
      this.#last.append(document.createElement('b'), ' ', document.createElement('span'));
      this.#list.append(this.#last);
      while (this.#list.childElementCount > MOST) this.#list.firstElementChild.remove();
    }
    const count = ++this.#last.dataset.count;
    this.#last.firstChild.textContent = count > 1 ? `${name} × ${count}` : name;
    this.#last.lastChild.textContent = inAWord(detail);
    this.#list.scrollTop = this.#list.scrollHeight;
  }
}
