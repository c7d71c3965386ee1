// SPDX-License-Identifier: MIT
// Properties that mirror attributes. Frameworks set the one or the other, before and after the element is in the page, and
// with what their templates have: text, numbers, booleans, nothing.
import { readMix, writeMix } from './face/expression.mjs';
import { SPEAK_ATTRIBUTES } from './speak-attributes.mjs';

const NO = ['off', 'false'];

/** Reads a switch: on unless its text says no. @param {string|null} text of the attribute @param {boolean} without default */
export const isOn = (text, without) => (text === null ? without : !NO.includes(text.trim().toLowerCase()));

const set = (element, name, text) => {
  if (text === null) element.removeAttribute(name);
  else element.setAttribute(name, text);
};

const string = (name) => ({
  get() {
    return this.getAttribute(name);
  },
  set(value) {
    set(this, name, value === null || value === undefined ? null : String(value));
  },
});

const number = (name, fits) => ({
  get() {
    return this.hasAttribute(name) ? Number(this.getAttribute(name)) : null;
  },
  set(value) {
    const usable = value !== null && value !== undefined && value !== '' && fits(Number(value));
    set(this, name, usable ? String(Number(value)) : null);
  },
});

const onOff = (name, without) => ({
  get() {
    return isOn(this.getAttribute(name), without);
  },
  set(value) {
    const nothing = value === null || value === undefined;
    set(this, name, nothing ? null : value !== false && isOn(String(value), true) ? 'on' : 'off');
  },
});

const PROPERTIES = {
  ...Object.fromEntries(['src', 'audio', 'for', 'model', 'avatar', 'pictures', 'quality', 'room', 'token', 'label', 'poster', 'backdrop', 'view', 'partner', 'persona'].map((name) => [name, string(name)])),
  ...Object.fromEntries(Object.entries(SPEAK_ATTRIBUTES).filter(([name]) => name !== 'lang').map(([name, { type }]) =>
    [name, type === Number ? number(name, (value) => value >= 0) : string(name)])),
  rate: number('rate', (value) => value > 0),
  captions: onOff('captions', true),
  avatarMap: string('avatar-map'),
  captionSize: string('caption-size'),
  captionColours: string('caption-colours'),
  autoplay: onOff('autoplay', false),
  polite: onOff('polite', true),
  watch: onOff('watch', false),
  still: onOff('still', null),
  turn: onOff('turn', null),
  expression: {
    get() {
      return readMix(this.getAttribute('expression') ?? '');
    },
    set(mix) {
      set(this, 'expression', mix === null || mix === undefined ? null : typeof mix === 'string' ? mix : writeMix(readMix(mix)));
    },
  },
};

/** Gives a class of elements the properties. */
export function addProperties(prototype) {
  for (const [name, property] of Object.entries(PROPERTIES))
    Object.defineProperty(prototype, name, { ...property, enumerable: true, configurable: true });
}

/** Takes over what a page has set on an element before the script that makes it one was there. */
export function upgradeProperties(element) {
  for (const name of Object.keys(PROPERTIES)) {
    if (!Object.hasOwn(element, name)) continue;
    const value = element[name];
    delete element[name];
    element[name] = value;
  }
}
