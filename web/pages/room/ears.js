// SPDX-License-Identifier: MIT
// The ears of a room's face: push to talk, and hands-free. The microphone is off until somebody agrees and turns it on.
import { BrowserWords, Recogniser } from './browser-words.js';

const TOLD_MS = 8000; // duration of what was heard
const TAP_MS = 400; // a shorter press goes on until silence
const LOUDER = 8; // dB by which somebody must be louder than she, to stop her
const SECOND = 1000;

const isTyping = (target) => Boolean(target.closest?.('form, input, textarea, select'));

export class Ears {
  #hearing = null;
  #agreed = false;
  #free = false;
  #pressed = 0; // time
  #wants = null; // what to do after a yes
  #asks = 0; // timer

  /**
   * @param {HTMLElement} head @param {(name: string, values?: object) => string} say words @param {string} lang spoken here
   * @param {string|null} recogniser browser: its own, in place of the daemon's
   * @param {object} ports news(text, milliseconds): shows a note; speaking(): whether she speaks; wake(): somebody is there
   */
  constructor(head, say, lang, ports, recogniser) {
    Object.assign(this, { head, say, lang, ports, byBrowser: recogniser === 'browser' && Boolean(Recogniser) });
    document.getElementById('ears-browser').hidden = !this.byBrowser;
    for (const id of ['ears', 'talk', 'hands-free', 'ears-consent', 'microphone']) this[id] = document.getElementById(id);
    const { talk } = this, free = this['hands-free'];
    talk.addEventListener('pointerdown', ({ button, pointerId }) => {
      if (button !== 0) return;
      talk.setPointerCapture(pointerId); // also where the button moves from under the finger
      this.#press();
    });
    for (const type of ['pointerup', 'pointercancel']) talk.addEventListener(type, () => this.#release());
    talk.addEventListener('contextmenu', (event) => event.preventDefault()); // of a long touch
    talk.addEventListener('click', (event) => event.detail === 0 && this.#tap()); // of a keyboard or a screen reader
    free.addEventListener('change', () => this.#setFree(free.checked));
    document.getElementById('ears-yes').addEventListener('click', () => this.#agree(true));
    document.getElementById('ears-no').addEventListener('click', () => this.#agree(false));
    document.addEventListener('keydown', (event) => this.#key(event, true));
    document.addEventListener('keyup', (event) => this.#key(event, false));
    head.addEventListener('hello', ({ detail }) => (this.ears.hidden = !this.byBrowser && (!detail.hears || !navigator.mediaDevices)));
    head.addEventListener('hearing', ({ detail }) => this.#show(detail));
    head.addEventListener('heard', ({ detail }) => this.#heard(detail));
    head.addEventListener('asked', ({ detail }) => this.#asked(detail));
  }

  /** The connection is lost: nobody hears. */
  lost() {
    this.#hearing?.stop();
    this['hands-free'].checked = this.#free = false;
    this.#answered();
  }

  #show({ on, speaking }) {
    this.microphone.hidden = !on;
    this.talk.setAttribute('aria-pressed', String(speaking));
    this.talk.querySelector('.text').textContent = this.say(speaking ? 'talking' : 'talk');
    document.body.toggleAttribute('data-microphone', on);
  }

  #asked({ seconds }) {
    clearTimeout(this.#asks);
    this.talk.toggleAttribute('data-waits', true);
    this.#asks = setTimeout(() => this.#answered(), seconds * SECOND);
    this.ports.wake();
  }

  #answered() {
    clearTimeout(this.#asks);
    this.talk.toggleAttribute('data-waits', false);
  }

  #heard({ text, final, id }) {
    if (!id.startsWith('ear-')) return; // of another
    if (final) this.#answered();
    if (text || final) this.ports.news(text ? this.say('youSaid', { text }) : this.say('notUnderstood'), TOLD_MS);
  }

  /** Asks for consent before the microphone is opened for the first time. */
  #permitted(then) {
    if (this.#agreed) return true;
    this.#wants = then;
    this.#showConsent(true);
    this['ears-consent'].focus();
    return false;
  }

  #showConsent(on) {
    this['ears-consent'].hidden = !on;
    document.body.toggleAttribute('data-ears-asked', on);
  }

  #agree(yes) {
    this.#showConsent(false);
    this.#agreed = yes;
    const then = this.#wants;
    this.#wants = null;
    if (yes) then?.();
    else this['hands-free'].checked = false;
    this.talk.focus();
  }

  async #open(options) {
    const interrupts = () => this.ports.speaking() && this.head.stop();
    this.#hearing?.stop();
    if (!options.handsFree) interrupts();
    const noise = () => (this.ports.speaking() ? LOUDER : 0);
    const how = { lang: this.lang, onset: interrupts, noise, ...options };
    const hearing = this.byBrowser ? this.#byBrowser(how) : this.head.hear(how);
    this.#hearing = hearing;
    try {
      await hearing.done;
    } catch (error) {
      if (error.name !== 'AbortError') this.ports.news(this.say('noMicrophone'), TOLD_MS);
      this['hands-free'].checked = this.#free = false;
    }
    if (this.#hearing === hearing) this.#hearing = null;
  }

  #byBrowser(how) {
    const [changed, heard] = [(detail) => this.#show(detail), (detail) => this.#heard(detail)];
    return new BrowserWords(this.head, how, { changed, heard });
  }

  #press() {
    this.ports.wake();
    if (this.#free || !this.#permitted(() => this.#tap())) return;
    if (this.#hearing?.open) {
      this.#hearing.stop();
      return;
    }
    this.#pressed = performance.now();
    this.#open({});
  }

  #release() {
    if (!this.#pressed) return;
    if (performance.now() - this.#pressed < TAP_MS) this.#hearing?.stopAtSilence();
    else this.#hearing?.stop();
    this.#pressed = 0;
  }

  #tap() {
    this.#press();
    this.#release();
  }

  #key(event, down) {
    if (event.key !== ' ' || this.ears.hidden || isTyping(event.target) || event.target.closest?.('button')) return;
    event.preventDefault();
    if (down && !event.repeat) this.#press();
    else if (!down) this.#release();
  }

  #setFree(on) {
    if (on && !this.#permitted(() => this.#setFree(true))) return;
    this.#free = on;
    if (on) this.#open({ handsFree: true });
    else this.#hearing?.stop();
  }
}
