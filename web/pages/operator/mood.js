// SPDX-License-Identifier: MIT
// The mood of the room on a disc. Dragging it changes the face at once; changes by other operators are shown.
import { MoodDisc } from '../shared/mood-disc.js';

const EVERY_MS = 100; // while it is dragged
const REST_MS = 700; // then it is logged, and follows other operators again
const EASE = 0.25; // s

export class RoomMood {
  #dragged = false; // dragged here a moment ago: late answers are ignored
  #heard = null; // mood reported by the room meanwhile
  #sending = 0; // timers
  #resting = 0;

  /**
   * @param {{svg: SVGElement, choice: HTMLSelectElement, shown: HTMLElement}} parts
   * @param {object} ports send(mix, options); log(text, more); called(name), say(name): words; self(): this desk's name
   */
  constructor({ svg, choice, shown }, ports) {
    Object.assign(this, { choice, shown, ports });
    this.disc = new MoodDisc(svg, { called: ports.called, described: (mix) => this.described(mix), moved: () => this.#drag() });
    choice.addEventListener('change', () => (choice.value ? this.disc.choose(choice.value) : this.disc.move(0, 0)));
  }

  described(mix) {
    return mix.map(({ name, intensity }) => `${this.ports.called(name)} ${Math.round(100 * intensity)} %`).join(', ') || this.ports.say('neutral');
  }

  /** @param {object[]} affects of /v1/expressions */
  set affects(affects) {
    this.disc.affects = affects;
    this.translate();
  }

  translate() {
    const { disc, choice, ports } = this;
    disc.draw();
    choice.replaceChildren(new Option(ports.say('neutral'), ''), ...disc.names.map((name) => new Option(ports.called(name), name)));
    this.#show();
  }

  /** Shows a new mood of the room. */
  heard({ mix, by }) {
    if (by !== this.ports.self()) this.ports.log(this.described(mix), { by });
    this.#heard = mix;
    if (this.#dragged) return;
    this.disc.show(mix);
    this.#show();
  }

  #rest() {
    this.#dragged = false;
    this.ports.log(this.described(this.disc.mix));
    if (this.#heard) this.disc.show(this.#heard);
    this.#show();
  }

  #show() {
    const { mix } = this.disc;
    this.disc.update();
    this.shown.textContent = this.described(mix);
    this.choice.value = mix.length === 1 ? mix[0].name : '';
  }

  #drag() {
    this.#dragged = true;
    this.#heard = null;
    this.#show();
    this.#sending ||= setTimeout(() => {
      this.#sending = 0;
      this.ports.send(this.disc.mix, { ease: EASE });
    }, EVERY_MS);
    clearTimeout(this.#resting);
    this.#resting = setTimeout(() => this.#rest(), REST_MS);
  }
}
