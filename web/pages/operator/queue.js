// SPDX-License-Identifier: MIT
// The operator's queue: texts that can still be changed while the head speaks.

export class Waiting {
  #items = []; // {text, options}

  /** @param {HTMLElement} list @param {(name: string) => string} say @param {() => void} changed */
  constructor(list, say, changed) {
    Object.assign(this, { list, say, changed });
  }

  get size() {
    return this.#items.length;
  }

  add(text, options) {
    this.#items.push({ text, options });
    this.show();
  }

  /** Removes and returns the next text. @returns {{text: string, options: object}|undefined} */
  take() {
    const item = this.#items.shift();
    this.show();
    return item;
  }

  show() {
    this.list.replaceChildren(...this.#items.map((item, i) => this.#row(item, i)));
    this.changed();
  }

  #row(item, i) {
    const row = document.createElement('li'), field = document.createElement('input');
    field.type = 'text';
    field.value = item.text;
    field.dir = 'auto';
    field.ariaLabel = this.say('waits');
    field.addEventListener('input', () => (item.text = field.value));
    row.append(field, this.#button('up', '↑', i > 0, () => this.#move(i, i - 1)),
      this.#button('down', '↓', i < this.#items.length - 1, () => this.#move(i, i + 1)),
      this.#button('cancel', '×', true, () => this.#move(i, null)));
    return row;
  }

  #button(name, sign, usable, act) {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = sign;
    button.ariaLabel = this.say(name);
    button.ariaDisabled = String(!usable);
    button.addEventListener('click', () => usable && act());
    return button;
  }

  /** @param {number} from @param {number|null} to null: deletes it */
  #move(from, to) {
    const [item] = this.#items.splice(from, 1);
    if (to !== null) this.#items.splice(to, 0, item);
    this.show();
    (this.list.querySelectorAll('li')[to ?? 0]?.querySelector('input') ?? this.list).focus?.();
  }
}
