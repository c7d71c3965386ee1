// SPDX-License-Identifier: MIT
// How she speaks to the person here: speed, loudness and pitch, and captions that can be read from where they sit. Kept in
// this browser; the room speaks that way for all its screens.
import { forGood } from '../shared/storage.js';

const KEY = 'faccia.manner';
const STEP = 0.1;
const [LEAST, MOST] = [0.5, 2];
const FACTORS = ['speed', 'volume', 'pitch'];
export const DISTANCES = [0.6, 1, 2, 3, 4]; // m; the first is arm's length

// Letters are legible that fill 22 minutes of arc (ISO 9241-303); capitals are 0.7 of the size of the type.
const PER_METRE = (2 * Math.tan(((22 / 60) * Math.PI) / 180 / 2) * 1000) / 0.7; // mm

/** The size of captions to be read from so many metres, as CSS: within what the screen has room for. */
export const sizeFrom = (metres) => `clamp(1.15em, ${(PER_METRE * metres).toFixed(1)}mm, 12vmin)`;

/** @param {unknown} json kept before @returns {{speed: number, volume: number, pitch: number, distance: number|null}} */
export function readManner(json) {
  const factor = (value) => (Number.isFinite(value) ? Math.min(MOST, Math.max(LEAST, value)) : 1);
  return {
    ...Object.fromEntries(FACTORS.map((name) => [name, factor(json?.[name])])),
    distance: DISTANCES.includes(json?.distance) ? json.distance : null,
  };
}

export class Manner {
  #now;

  /**
   * @param {HTMLElement} head @param {(name: string, values?: object) => string} say words @param {string} lang of numbers
   * @param {number|null} distance that the address asks for
   */
  constructor(head, say, lang, distance) {
    Object.assign(this, { head, say, lang });
    let kept = null;
    try {
      kept = JSON.parse(forGood.get(KEY));
    } catch {
      // as if there were none
    }
    this.#now = readManner({ ...kept, ...(distance === null ? {} : { distance }) });
    this.dialog = document.getElementById('manner');
    document.getElementById('manner-open').addEventListener('click', () => this.dialog.showModal());
    document.getElementById('manner-close').addEventListener('click', () => this.dialog.close());
    for (const row of this.dialog.querySelectorAll('[data-factor]'))
      for (const button of row.querySelectorAll('button')) button.addEventListener('click', () => this.#step(row.dataset.factor, Number(button.value)));
    this.select = document.getElementById('distance');
    const metres = new Intl.NumberFormat(lang, { style: 'unit', unit: 'meter' });
    this.select.append(new Option(say('usualSize'), ''), ...DISTANCES.map((value) => new Option(metres.format(value), String(value))));
    this.select.addEventListener('change', () => this.#change({ distance: this.select.value ? Number(this.select.value) : null }));
    head.addEventListener('joined', () => this.#isUsual() || this.#send());
    this.#show();
  }

  #isUsual() {
    return FACTORS.every((name) => this.#now[name] === 1);
  }

  #send() {
    this.head.setManner(Object.fromEntries(FACTORS.map((name) => [name, this.#now[name]])));
  }

  #step(name, by) {
    const value = Math.round((this.#now[name] + by * STEP) * 10) / 10;
    this.#change({ [name]: Math.min(MOST, Math.max(LEAST, value)) });
    this.#send();
  }

  #change(what) {
    this.#now = { ...this.#now, ...what };
    forGood.set(KEY, JSON.stringify(this.#now));
    this.#show();
  }

  #show() {
    const percent = new Intl.NumberFormat(this.lang, { style: 'percent' });
    for (const name of FACTORS) this.dialog.querySelector(`[data-factor='${name}'] output`).textContent = percent.format(this.#now[name]);
    const { distance } = this.#now;
    this.select.value = distance ?? '';
    if (distance) this.head.style.setProperty('--talking-head-caption-size', sizeFrom(distance));
    else this.head.style.removeProperty('--talking-head-caption-size');
  }
}
