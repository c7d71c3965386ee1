// SPDX-License-Identifier: MIT
// Scenes: several heads of a page that show one speech. One of them, the lead, speaks; its partners name it. Each head shows
// what the speakers in its `persona` say, and listens to the others; the lead shows what nobody else does.
import { Company } from './face/company.mjs';

const seats = new WeakMap(); // element in the page -> its Seat
const unseated = new Set(); // seats whose lead is not in the page

const idsOf = (text) => (text ?? '').split(/\s+/).filter(Boolean);

/** Finds an element by its id, in the same tree or in the page. */
function byId(element, id) {
  const root = element.getRootNode();
  return root.getElementById?.(id) ?? element.ownerDocument.getElementById(id);
}

/** The place of one head in its scene. A head without partners is alone. */
export class Seat {
  #lead = null;
  #partners = new Set();
  #persona = [];
  #company = new Company();
  #other = null; // whom it is turned to, and on which side
  #side = 0;
  #last = { shown: null, before: null }; // of the lead: who speaks, and who spoke before
  #said = ''; // sentence that is heard

  /**
   * @param {HTMLElement} element whose partner and persona say where it belongs
   * @param {import('./speech/speech.mjs').Speech} speech of the element
   * @param {() => void} wake draws it
   */
  constructor(element, speech, wake) {
    Object.assign(this, { element, speech, wake });
  }

  open() {
    seats.set(this.element, this);
    this.changed();
    for (const seat of [...unseated]) if (seat !== this) seat.changed();
  }

  close() {
    seats.delete(this.element);
    unseated.delete(this);
    this.#leave();
    for (const partner of this.#partners) {
      partner.#lead = null;
      unseated.add(partner);
    }
    this.#partners.clear();
  }

  /** The attributes have changed. */
  changed() {
    if (!seats.has(this.element)) return;
    const { partner } = this.element;
    this.#persona = idsOf(this.element.persona);
    const found = partner ? byId(this.element, partner) : null;
    const lead = (found !== this.element && seats.get(found ?? {})) || null;
    if (lead !== this.#lead) {
      this.#leave();
      if (lead && !lead.#lead) {
        this.#lead = lead;
        lead.#partners.add(this);
      }
    }
    if (partner && !this.#lead) unseated.add(this);
    else unseated.delete(this);
    this.#wakeAll();
  }

  #leave() {
    this.#lead?.#partners.delete(this);
    this.#lead = null;
  }

  /** The heads that show the same speech as this one. */
  get #all() {
    const lead = this.#lead ?? this;
    return [lead, ...lead.#partners];
  }

  get alone() {
    return !this.#lead && !this.#partners.size;
  }

  /** Whether the lead, or the head itself, speaks. */
  get busy() {
    return this.speech.busy || Boolean(this.#lead?.speech.busy);
  }

  /** The partners show what the lead speaks. */
  wakePartners() {
    for (const partner of this.#partners) partner.wake();
  }

  #wakeAll() {
    if (!this.alone) for (const seat of this.#all) seat.wake();
  }

  /**
   * A sentence of this head's speech begins, or its speech has ended: those who listened to the one before react to it.
   * @param {string} text @param {number} now performance.now()
   */
  sentence(text, now) {
    const { shown } = this.#last;
    const listeners = this.#said && shown ? this.#all.filter((seat) => seat !== shown) : [];
    for (const listener of listeners) listener.#company.heardSentence(now / 1000, this.#said);
    this.#said = text;
    this.#wakeAll();
  }

  /**
   * What this head is to show: its own speech, or its part of the lead's.
   * @param {number} now performance.now() @param {number} [ahead] seconds
   * @returns {{heard: object|null, listens: boolean}} heard: see Speech; listens: another head of the scene speaks
   */
  heard(now, ahead = 0) {
    const own = this.speech.heard(now, ahead);
    if (this.alone || (this.#lead && own)) return { heard: own, listens: false };
    const lead = this.#lead ?? this;
    const all = lead === this ? own : lead.speech.heard(now, ahead);
    const shown = lead.#shown(all?.utterance.speaker?.id);
    return { heard: shown.includes(this) ? all : null, listens: Boolean(all?.running) && !shown.includes(this) };
  }

  /** The heads of the lead's scene that show a speaker. Of several who speak at once (`a+b`) each shows its own. */
  #shown(id) {
    const ids = (id ?? '').split('+');
    const shown = id ? this.#all.filter((seat) => ids.some((one) => seat.#persona.includes(one))) : [];
    return shown.length ? shown : [this];
  }

  /**
   * Adds to a face what company does to it.
   * @param {number} now performance.now() @param {Float32Array} values @param {boolean} idles whether it has idle movement
   * @returns {boolean} whether it goes on moving
   */
  add(now, values, idles) {
    if (this.alone) return false;
    const lead = this.#lead ?? this;
    const heard = lead.speech.heard(now);
    const speaker = heard?.utterance.speaker?.id;
    const shown = speaker ? lead.#shown(speaker) : [];
    lead.#note(shown);
    const speaks = shown.includes(this);
    if (speaks) this.#turnTo(lead.#last.before ?? lead.#all.find((seat) => seat !== this));
    // between utterances it stays turned
    else if (shown.length || speaker !== undefined || !lead.speech.busy) this.#turnTo(shown[0] ?? null);
    this.#company.add(now / 1000, values, { side: this.#side, speaks, blinks: !idles && !speaks && Boolean(this.#other) });
    return this.#company.moving;
  }

  /** Remembers, as the lead, who speaks and who spoke before: they talk with each other. */
  #note([shown]) {
    const last = this.#last;
    if (!shown || shown === last.shown) return;
    if (last.shown && this.#all.includes(last.shown)) last.before = last.shown;
    last.shown = shown;
    if (last.before === shown || !this.#all.includes(last.before)) last.before = null;
  }

  #turnTo(other) {
    if (other === this.#other) return;
    this.#other = other;
    this.#side = 0;
    if (!other) return;
    const [here, there] = [this.element, other.element].map((element) => element.getBoundingClientRect());
    const away = there.left + there.width / 2 - here.left - here.width / 2;
    if (Math.abs(away) > here.width / 4) this.#side = Math.sign(away);
  }
}
