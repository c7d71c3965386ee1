// SPDX-License-Identifier: MIT
// A study asks the listener for consent. Without it nothing about the listener is logged.

export class Study {
  #consent = 'none';
  #asked = null; // the question that this operator asked; null: none

  /**
   * @param {{text: HTMLTextAreaElement, ask: HTMLElement, end: HTMLElement, shown: HTMLElement}} parts
   * @param {object} ports send(consent, text): whether it was sent; log: see Log; say(name): words
   */
  constructor(parts, ports) {
    Object.assign(this, { parts, ports });
    parts.ask.addEventListener('click', () => this.#ask(parts.text.value.trim()));
    parts.end.addEventListener('click', () => {
      this.#asked = null;
      ports.send('none');
    });
  }

  get consent() {
    return this.#consent;
  }

  /** After (re)joining the room: a restarted daemon has lost the question. */
  joined() {
    if (this.#asked !== null) this.#ask(this.#asked);
  }

  /** Consent counts as missing until the room reports its state. */
  lost() {
    if (this.#consent !== 'none') this.#set('asked');
  }

  /** Another room. */
  left() {
    this.#asked = null;
    this.#set('none');
  }

  heard({ consent, by }) {
    const { log, say } = this.ports;
    if (consent === 'declined' || (consent === 'asked' && this.#consent !== 'given')) log.forget();
    if (consent === 'none') this.#asked = null;
    if (consent !== this.#consent) log.show('consent', say(`consent-${consent}`), { by });
    this.#set(consent);
  }

  translate() {
    this.parts.shown.textContent = this.ports.say(`consent-${this.#consent}`);
  }

  #ask(text) {
    if (this.ports.send('asked', text)) this.#asked = text;
  }

  #set(consent) {
    this.#consent = consent;
    this.ports.log.silent = consent === 'asked' || consent === 'declined';
    this.parts.shown.dataset.consent = consent;
    this.translate();
  }
}
