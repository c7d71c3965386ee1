// SPDX-License-Identifier: MIT
// A play: who speaks, with which face, and whether stage directions and names are spoken.
import { forGood } from '../shared/storage.js';

const KEY = 'faccia.roles';
const OPTIONS = ['faces', 'directions', 'names'];
const $ = (id) => document.getElementById(id);

/** Whether loading several heads asks too much of this device or its connection. */
const isWeak = () => navigator.connection?.saveData || (navigator.deviceMemory ?? 8) <= 2;

function keptOptions() {
  try {
    return JSON.parse(forGood.get(KEY)) ?? {};
  } catch {
    return {}; // not ours
  }
}

export class Roles {
  #cast = new Map();
  #narrator = null;
  #voices = new Map();
  #work = null;
  #who = null;

  /**
   * @param {import('../shared/frame.js').Frame} frame @param {HTMLElement} passage
   * @param {(address: string) => Promise<object>} load
   */
  constructor(frame, passage, load) {
    Object.assign(this, { frame, head: frame.head, passage, load });
    const kept = { faces: !isWeak(), ...keptOptions() };
    for (const name of OPTIONS) {
      $(name).checked = Boolean(kept[name]);
      $(name).addEventListener('change', () => this.#chosen());
    }
    this.head.addEventListener('begin', () => this.#speaks(null));
    this.head.addEventListener('speaker', ({ detail }) => this.#speaks(detail.speaker || null, detail.name));
    for (const type of ['end', 'read']) this.head.addEventListener(type, () => this.#name(''));
    frame.onTranslate(() => this.#list());
  }

  /** @param {object[]} list voices of the server */
  set voices(list) {
    this.#voices = new Map(list.map((voice) => [voice.id, voice]));
    this.#list();
  }

  /** Shows a section's speakers. @param {object} section of the library */
  async show(section) {
    const plays = section.blocks.some(({ who }) => who);
    this.#mark();
    if (section.work.id !== this.#work || !plays) this.#leave();
    if (plays && section.work.id !== this.#work) await this.#enter(section.work.id);
    $('roles').hidden = !plays;
  }

  async #enter(work) {
    this.#work = work;
    const cast = await this.load(`v1/library/works/${work}/cast`).catch(() => null);
    if (this.#work !== work) return;
    this.#cast = new Map((cast?.cast ?? []).map((member) => [member.id, member]));
    this.#narrator = cast?.narrator ?? null;
    this.#list();
  }

  #leave() {
    this.#work = null;
    this.#cast.clear();
    this.#list();
    this.#name('');
    this.head.model = null;
  }

  #chosen() {
    forGood.set(KEY, JSON.stringify(Object.fromEntries(OPTIONS.map((name) => [name, $(name).checked]))));
    if (!$('faces').checked) this.head.model = null;
    this.#mark();
  }

  /** Marks what is read: stage directions and names, by the narrator, only if that is wanted. */
  #mark() {
    const [directions, names] = [$('directions').checked, $('names').checked];
    const unread = (element, off) => element.toggleAttribute('data-unread', off);
    for (const element of this.passage.querySelectorAll('p.stage')) unread(element, !directions);
    for (const element of this.passage.querySelectorAll('p.speaker')) unread(element, !names);
    for (const element of this.passage.querySelectorAll('span.stage')) element.toggleAttribute('data-aside', !directions);
  }

  #speaks(id, name = '') {
    const member = this.#cast.get(id) ?? (id ? null : this.#narrator);
    this.#name(name);
    this.#who = id;
    for (const item of $('persons').children) item.toggleAttribute('aria-current', item.dataset.who === id);
    if ($('faces').checked && this.#cast.size && member?.head && this.head.model !== member.head) this.head.model = member.head;
  }

  #name(name) {
    $('who').textContent = name;
  }

  #list() {
    const { say } = this.frame;
    const sex = { male: say('male'), female: say('female') };
    $('persons').replaceChildren(...[...this.#cast.values()].map(({ id, name, about, voice, sex: is }) => {
      const item = document.createElement('li');
      const small = document.createElement('small');
      item.dataset.who = id;
      item.toggleAttribute('aria-current', id === this.#who);
      small.textContent = [about, sex[is], this.#voices.get(voice)?.name].filter(Boolean).join(' · ');
      item.append(name, ' ', small);
      return item;
    }));
  }
}
