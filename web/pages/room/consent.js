// SPDX-License-Identifier: MIT
// Asks the people in the room for their consent to be recorded by a study. They can change their mind.
const TOLD_MS = 8000; // duration of the note that nothing is recorded

export class Consent {
  asked = false; // and not answered yet

  /**
   * @param {HTMLElement} head @param {(name: string) => string} say words
   * @param {object} ports changed(): the question was asked or withdrawn; news(text, milliseconds): shows a note
   */
  constructor(head, say, ports) {
    Object.assign(this, { head, say, ports });
    [this.card, this.what, this.noted] = ['consent', 'consent-what', 'noted'].map((id) => document.getElementById(id));
    for (const [id, consent] of [['consent-yes', 'given'], ['consent-no', 'declined'], ['consent-stop', 'declined']])
      document.getElementById(id).addEventListener('click', () => head.consent(consent));
    head.addEventListener('consent', ({ detail }) => this.#heard(detail));
  }

  /** Answers by the keys 1 and 2, like any question. @returns {boolean} whether there was one */
  answer(choice) {
    if (this.asked && choice < 2) this.head.consent(choice === 0 ? 'given' : 'declined');
    return this.asked;
  }

  /** Forgets the state on a lost connection: the server sends it again. */
  lost() {
    this.asked = false;
    this.noted.hidden = true;
    this.#show();
  }

  #note(text, button) {
    this.noted.querySelector('span').textContent = this.say(text);
    document.getElementById('consent-stop').textContent = this.say(button);
  }

  #show() {
    this.card.hidden = !this.asked;
    document.body.toggleAttribute('data-asked', this.asked);
  }

  #heard({ consent, text, recorded }) {
    const news = consent === 'asked' && !this.asked;
    this.asked = consent === 'asked';
    this.what.textContent = text || this.say('consentWhat');
    this.#show();
    const over = consent === 'none' && recorded === true; // what was recorded can still be deleted
    this.noted.hidden = consent !== 'given' && !over;
    this.#note(over ? 'studyOver' : 'noted', over ? 'deleteAll' : 'consentStop');
    if (consent === 'declined') this.ports.news(this.say('declined'), TOLD_MS);
    this.ports.changed();
    if (news) this.card.focus(); // focuses the question for screen readers, so that no answer is given by accident
  }
}
