// SPDX-License-Identifier: MIT
import strings from './strings.json';

/** What stands around the face: a message over it and two buttons, in the language of the element. */
export class Furniture {
  #lang = 'en';
  #values = {};

  /** @param {ShadowRoot} root of the template @param {object} ports sound() and captions(): their buttons were pressed */
  constructor(root, ports) {
    const $ = (selector) => root.querySelector(selector);
    this.canvas = $('canvas');
    this.message = $('.message');
    this.sound = $('.sound');
    this.captions = $('.switch');
    this.said = null; // the name of the message on show
    this.sound.addEventListener('click', () => ports.sound());
    this.captions.addEventListener('click', () => ports.captions());
  }

  /** @param {string} name in strings.json @param {Record<string, string>} [values] of what stands in braces there */
  text(name, values = {}) {
    const table = strings[this.#lang] ?? strings.en;
    return table[name].replace(/\{(\w+)\}/g, (_, key) => values[key]);
  }

  /** @param {string} lang @param {string|null} label what the head is called; null: by its title @param {string} title */
  translate(lang, label, title) {
    this.#lang = (lang || 'en').slice(0, 2);
    this.canvas.setAttribute('aria-label', label ?? this.text('label', { title }));
    this.sound.querySelector('span').textContent = this.text('sound');
    this.captions.setAttribute('aria-label', this.text('captions'));
    this.captions.title = this.text('captions');
    if (this.said) this.say(this.said, this.#values);
  }

  /** @param {string|null} what the name of a message; null: none @param {Record<string, string>} [values] */
  say(what, values = {}) {
    this.said = what;
    this.#values = values;
    this.message.hidden = !what;
    this.message.textContent = what ? this.text(what, values) : '';
  }
}
