// SPDX-License-Identifier: MIT
// A scene: the two persons who talk, side by side. The page's head speaks; a second one shows its part.

const $ = (id) => document.getElementById(id);
/** Attributes of the first head that the second one shares. */
const SHARED = ['token', 'lang', 'captions', 'caption-size', 'caption-colours', 'view', 'quality', 'still'];

export class Pair {
  #places = []; // {head, name, id, turn}: of the two heads, while there are two
  #turn = 0; // counts who spoke last
  #observer = new MutationObserver(() => this.#share());

  /** @param {HTMLElement} head of the page */
  constructor(head) {
    this.head = head;
  }

  get on() {
    return this.#places.length > 0;
  }

  /** The name of the second head. */
  get partner() {
    return this.#places[1]?.head.model ?? undefined;
  }

  /** Shows the second head, or removes it. @param {boolean} on */
  show(on) {
    if (on === this.on) return;
    $('portrait').classList.toggle('pair', on);
    if (!on) {
      this.#observer.disconnect();
      const [first, second] = this.#places;
      first.head.removeAttribute('persona');
      first.name.textContent = '';
      first.name.classList.remove('speaks');
      second.head.remove();
      second.name.remove();
      this.#places = [];
      return;
    }
    const head = document.createElement('talking-head');
    head.setAttribute('partner', this.head.id);
    head.id = 'head-partner';
    const name = document.createElement('p');
    name.className = 'who';
    $('portrait').append(head, name);
    this.#places = [
      { head: this.head, name: $('who'), id: null, turn: 0 },
      { head, name, id: null, turn: 0 },
    ];
    this.#share();
    this.#observer.observe(this.head, { attributes: true, attributeFilter: SHARED });
  }

  #share() {
    const [, { head }] = this.#places;
    for (const name of SHARED)
      if (this.head.hasAttribute(name)) head.setAttribute(name, this.head.getAttribute(name));
      else head.removeAttribute(name);
  }

  /** Seats the first two of a section before they speak. @param {object[]} members of the cast */
  seat(members) {
    this.#places.forEach((place, i) => {
      place.turn = 0;
      if (members[i]) this.#give(place, members[i]);
    });
  }

  /** @param {object[]} members of the cast who speak now; several speak at once */
  speak(members) {
    const here = [];
    this.#turn++;
    for (const member of members.slice(0, this.#places.length)) {
      const others = members.filter((other) => other !== member).map(({ id }) => id);
      const free = this.#places.filter((place) => !here.includes(place) && !others.includes(place.id));
      const place = free.find(({ id }) => id === member.id) ?? [...free].sort((a, b) => a.turn - b.turn)[0];
      if (!place) continue;
      if (place.id !== member.id) this.#give(place, member);
      place.turn = this.#turn;
      here.push(place);
    }
    for (const place of this.#places) place.name.classList.toggle('speaks', here.includes(place));
  }

  #give(place, { id, name, head }) {
    Object.assign(place, { id });
    place.head.setAttribute('persona', id);
    place.name.textContent = name;
    if (head && place.head.getAttribute('model') !== head) place.head.setAttribute('model', head);
  }
}
