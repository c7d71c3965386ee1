// SPDX-License-Identifier: MIT
// Lists the rooms, the listeners in this one, and its other operators.
const LOOK_MS = 3000;

export class People {
  #others = []; // other observers of this room
  #linked = false;

  /**
   * @param {{rooms: HTMLDataListElement, shown: HTMLElement}} parts
   * @param {object} ports head; load(address): JSON or null; log: see Log; say(name, values): words
   */
  constructor(parts, ports) {
    Object.assign(this, { parts, ports });
    ports.head.addEventListener('connection', ({ detail }) => (this.#linked = detail.state === 'open'));
  }

  /** @param {{name: string, speaks: boolean}[]} observers all of them @param {string} me which of them is this */
  observers(observers, me) {
    const own = observers.findIndex(({ name }) => name === me);
    this.#others = observers.filter((_, i) => i !== own);
    this.ports.log.add('observers', observers.map(({ name }) => name).join(', '));
  }

  /** Looks again and again. */
  async follow() {
    const { head, load, say } = this.ports;
    if (this.#linked && !document.hidden) {
      const { rooms = [] } = (await load('v1/rooms')) ?? {};
      const here = rooms.find(({ name }) => name === head.room);
      this.parts.rooms.replaceChildren(...rooms.map(({ name, listeners }) => new Option(`${name} (${listeners})`, name)));
      const lines = [here?.listeners ? say('followers', { n: here.listeners }) : say('alone'), this.#names()];
      this.parts.shown.textContent = here ? lines.filter(Boolean).join(' · ') : say('nobody');
    }
    setTimeout(() => this.follow(), LOOK_MS);
  }

  #names() {
    const { say } = this.ports;
    const names = this.#others.map(({ name, speaks }) => (speaks ? name : `${name} (${say('looksOn')})`));
    return names.length > 0 && say('observers', { n: names.join(', ') });
  }
}
