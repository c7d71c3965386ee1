// SPDX-License-Identifier: MIT
// The words of a sentence, each with its sounds and how they were judged. One sound is chosen: by pointer, or by arrow keys.

export class Marks {
  #buttons = new Map(); // phone -> its button
  #phones = [];
  chosen = null;

  /** @param {HTMLElement} list @param {(name: string) => string} say @param {(phone: object) => void} choose */
  constructor(list, say, choose) {
    Object.assign(this, { list, say, act: choose });
    list.addEventListener('keydown', (event) => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      this.step(step, true);
    });
  }

  /** @param {{words: object[], phones: object[]}} heard as the server answers */
  show({ words, phones }) {
    this.#buttons.clear();
    this.#phones = phones;
    this.chosen = null;
    this.list.replaceChildren(...words.map((word, i) => this.#item(word, phones.filter((phone) => phone.word === i))));
  }

  #item(word, phones) {
    const item = document.createElement('li'), name = document.createElement('span'), sounds = document.createElement('span');
    item.dataset.state = word.state;
    name.className = 'word';
    name.textContent = word.text;
    sounds.className = 'sounds';
    sounds.append(...phones.map((phone) => this.#button(phone)));
    item.append(name, sounds);
    return item;
  }

  #button(phone) {
    const button = document.createElement('button'), mark = document.createElement('b');
    button.type = 'button';
    button.tabIndex = -1;
    button.dataset.state = phone.state;
    button.setAttribute('aria-label', `${phone.ipa}: ${this.say(phone.state)}`);
    mark.setAttribute('aria-hidden', 'true');
    button.append(phone.ipa, mark);
    button.addEventListener('click', () => this.choose(phone));
    this.#buttons.set(phone, button);
    return button;
  }

  /** @param {object} phone @param {boolean} [focus] */
  choose(phone, focus = false) {
    for (const [other, button] of this.#buttons) {
      button.tabIndex = other === phone ? 0 : -1;
      if (other === phone) button.setAttribute('aria-current', 'true');
      else button.removeAttribute('aria-current');
    }
    this.chosen = phone;
    if (focus) this.#buttons.get(phone)?.focus();
    this.act(phone);
  }

  step(by, focus = false) {
    const at = this.#phones.indexOf(this.chosen) + by;
    if (this.#phones[at]) this.choose(this.#phones[at], focus);
  }
}
