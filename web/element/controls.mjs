// SPDX-License-Identifier: MIT
import { strings } from './strings.mjs';

const TOPICS = ['link', 'model', 'picture']; // what a message can be about; the first that has one is shown

/** Controls around the face: a message over it, four buttons and a slider, in the language of the element. */
export class Controls {
  #lang = 'en';
  #said = new Map(); // topic -> {what, values}

  /**
   * @param {ShadowRoot} root of the template
   * @param {object} ports sound(), captions(), mouth() and play(): their buttons were pressed
   */
  constructor(root, ports) {
    const $ = (selector) => root.querySelector(selector);
    this.root = root;
    this.message = $('.message');
    this.sound = $('.sound');
    this.captions = $('.switch');
    this.mouth = $('.mouth');
    this.play = $('.play');
    this.turn = $('.turn');
    this.sound.addEventListener('click', () => ports.sound());
    this.captions.addEventListener('click', () => ports.captions());
    this.mouth.addEventListener('click', () => ports.mouth());
    this.play.addEventListener('click', () => ports.play());
  }

  /** The one of now: a lost one is replaced. */
  get canvas() {
    return this.root.querySelector('canvas');
  }

  /** @param {string} name in strings.mjs @param {Record<string, string>} [values] of what stands in braces there */
  text(name, values = {}) {
    const table = strings[this.#lang] ?? strings.en;
    return table[name].replace(/\{(\w+)\}/g, (_, key) => values[key] ?? '');
  }

  /** @param {string} lang @param {string|null} label what the head is called; null: by its title @param {string} title */
  translate(lang, label, title) {
    this.#lang = (lang || 'en').slice(0, 2).toLowerCase();
    this.canvas.setAttribute('aria-label', label ?? this.text('label', { title }));
    this.sound.querySelector('span').textContent = this.text('sound');
    this.captions.setAttribute('aria-label', `CC: ${this.text('captions')}`); // with what is written on it
    this.captions.title = this.text('captions');
    this.mouth.setAttribute('aria-label', this.text('mouth'));
    this.mouth.title = this.text('mouth');
    this.turn.setAttribute('aria-label', this.text('turn'));
    this.#namePlay();
    this.#show();
  }

  /** The button of a recording. @param {boolean} on whether there is one @param {boolean} playing */
  offerPlay(on, playing) {
    this.play.hidden = !on;
    this.play.classList.toggle('playing', playing);
    this.#namePlay();
  }

  #namePlay() {
    const name = this.text(this.play.classList.contains('playing') ? 'pause' : 'play');
    this.play.setAttribute('aria-label', name);
    this.play.title = name;
  }

  /**
   * @param {'link'|'model'|'picture'} topic @param {string|null} what the name of a message; null: none any more
   * @param {Record<string, string>} [values]
   */
  say(topic, what, values = {}) {
    if (what) this.#said.set(topic, { what, values });
    else this.#said.delete(topic);
    this.#show();
  }

  #show() {
    const { what, values } = this.#said.get(TOPICS.find((topic) => this.#said.has(topic))) ?? {};
    const text = what ? this.text(what, values) : '';
    if (this.message.textContent !== text) this.message.textContent = text;
    this.message.hidden = !what;
  }
}
