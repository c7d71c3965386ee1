// SPDX-License-Identifier: MIT
// A play, or dialogue in prose: who speaks, with which face, and whether stage directions and names are spoken.
import { CastEditor } from './cast-editor.js';
import { forGood } from '../shared/storage.js';
import { Pair } from './pair.js';

const KEY = 'faccia.roles';
const BACK_MS = 200; // for the name of who speaks to come
const UNNAMED = /^voice-\d$/; // in prose; the narrator's voice has them
const PAIR_SIZE = '960x480'; // of a film
const OPTIONS = ['faces', 'pair', 'dialogue', 'directions', 'names'];
const OF_PLAYS = ['directions', 'names'];
const $ = (id) => document.getElementById(id);

/** Whether loading several heads asks too much of this device or its connection. */
const isWeak = () => navigator.connection?.saveData || (navigator.deviceMemory ?? 8) <= 2;

/** Whether drawing two heads at once does, or there is no room for them. */
const isSlow = () => isWeak() || (navigator.hardwareConcurrency ?? 8) <= 2 || matchMedia('(max-width: 52rem)').matches;

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
  #who = undefined; // null: the narrator
  #section = null;
  #told = false; // prose, of which the narrator tells who speaks
  #back = 0; // timer: the narrator's face returns
  #pair;
  #editor;

  /**
   * @param {import('../shared/frame.js').Frame} frame @param {HTMLElement} passage
   * @param {(address: string) => Promise<object>} load
   * @param {{file: () => string|null, quiet: () => void}} ports file(): of the work; quiet(): stops what is being read
   */
  constructor(frame, passage, load, { file, quiet }) {
    Object.assign(this, { frame, head: frame.head, passage, load });
    this.#pair = new Pair(this.head);
    this.#editor = new CastEditor(frame, passage, {
      file,
      quiet,
      lang: () => this.#section?.work.lang ?? frame.lang,
      voices: () => [...this.#voices.values()],
      saved: (id) => this.#reload(id),
    });
    const kept = { faces: !isWeak(), pair: !isSlow(), ...keptOptions() };
    for (const name of OPTIONS) {
      $(name).checked = Boolean(kept[name]);
      $(name).addEventListener('change', () => this.#chosen());
    }
    this.head.addEventListener('begin', () => this.#speaks(null, null));
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
    this.#told = section.blocks.some(({ speeches }) => speeches);
    const plays = this.#told || section.blocks.some(({ who }) => who);
    $('dialogue').closest('label').hidden = !this.#told;
    for (const name of OF_PLAYS) $(name).closest('label').hidden = this.#told;
    this.#mark();
    if (section.work.id !== this.#work || !plays) this.#leave();
    if (plays && section.work.id !== this.#work) await this.#enter(section.work.id);
    $('roles').hidden = !plays;
    this.#section = plays ? section : null;
    this.#seat();
  }

  /** Shows the first two who speak in the section, where two are shown. */
  #seat() {
    $('pair').disabled = !$('faces').checked;
    this.#pair.show(Boolean(this.#section && this.#cast.size && this.#speaksApart && $('faces').checked && $('pair').checked));
    if (!this.#pair.on) return;
    const ids = new Set(this.#section.blocks.flatMap(({ who, speeches }) => who?.split('+') ?? speeches?.map((speech) => speech.who) ?? []));
    this.#pair.seat([...ids].map((id) => this.#cast.get(id)).filter(Boolean));
  }

  /** Whether each has its own voice: always in a play. */
  get #speaksApart() {
    return !this.#told || $('dialogue').checked;
  }

  /** Members of an order of a film that shows what is shown here. */
  get film() {
    if (!this.#section) return {};
    const shown = this.#pair.on ? { partner: this.#pair.partner, size: PAIR_SIZE } : {};
    if (this.#told) return { dialogue: $('dialogue').checked ? 'voices' : undefined, ...shown };
    return { directions: $('directions').checked ? 'spoken' : undefined, names: $('names').checked, ...shown };
  }

  /** The cast has changed. @returns {Promise<object|undefined>} the member of that id */
  async #reload(id) {
    const work = this.#work;
    if (work) await this.#enter(work);
    this.#seat();
    return id === null ? this.#narratorShown : this.#cast.get(id);
  }

  get #narratorShown() {
    return { ...this.#narrator, id: null, name: this.frame.say('narrator') };
  }

  async #enter(work) {
    this.#work = work;
    const cast = await this.load(`v1/library/works/${work}/cast`).catch(() => null);
    if (this.#work !== work) return;
    const members = (cast?.cast ?? []).filter(({ id }) => !cast.told || !UNNAMED.test(id));
    this.#cast = new Map(members.map((member) => [member.id, member]));
    this.#narrator = cast?.narrator ?? null;
    this.#list();
  }

  #leave() {
    this.#work = null;
    this.#cast.clear();
    this.#editor.close();
    this.#list();
    this.#name('');
    this.head.removeAttribute('model'); // its property would outlast what is set before the element's script has come
  }

  #chosen() {
    forGood.set(KEY, JSON.stringify(Object.fromEntries(OPTIONS.map((name) => [name, $(name).checked]))));
    if (!$('faces').checked || !this.#speaksApart) this.head.removeAttribute('model');
    this.#seat();
    this.#mark();
  }

  /** Marks what is read, and by whom: stage directions and names, by the narrator, only if that is wanted. */
  #mark() {
    const [directions, names] = [$('directions').checked, $('names').checked];
    const unread = (element, off) => element.toggleAttribute('data-unread', off);
    for (const element of this.passage.querySelectorAll('p.stage')) unread(element, !directions);
    for (const element of this.passage.querySelectorAll('p.speaker')) unread(element, !names);
    for (const element of this.passage.querySelectorAll('[data-who]')) {
      if ($('dialogue').checked && !UNNAMED.test(element.dataset.who)) element.dataset.speaker = element.dataset.who;
      else delete element.dataset.speaker;
    }
    for (const element of this.passage.querySelectorAll('span.stage')) element.toggleAttribute('data-aside', !directions);
  }

  /** @param {string|null} id null: the narrator @param {string|null} name null: it is not known yet who speaks */
  #speaks(id, name) {
    const member = this.#cast.get(id) ?? (id ? null : this.#narrator);
    this.#who = name === null ? undefined : id;
    for (const item of $('persons').children) item.toggleAttribute('aria-current', name !== null && item.dataset.who === (id ?? ''));
    if (this.#pair.on) {
      const alone = this.#cast.get(id);
      this.#pair.speak(id ? id.split('+').map((one) => this.#cast.get(one) ?? (alone && { ...alone, id: one })).filter(Boolean) : []);
      return;
    }
    this.#name(name ?? '');
    clearTimeout(this.#back);
    if (this.#told && !member?.head) this.#back = setTimeout(() => this.head.removeAttribute('model'), BACK_MS);
    if ($('faces').checked && this.#cast.size && member?.head && this.head.model !== member.head) this.head.model = member.head;
  }

  #name(name) {
    if (!this.#pair.on) $('who').textContent = name;
  }

  #list() {
    const { say } = this.frame;
    const sex = { male: say('male'), female: say('female') };
    const members = this.#cast.size ? [...this.#cast.values(), this.#narratorShown] : [];
    $('persons').replaceChildren(...members.map((member) => {
      const { id, name, about, voice, sex: is } = member;
      const item = document.createElement('li');
      const button = document.createElement('button');
      const small = document.createElement('small');
      item.dataset.who = id ?? '';
      item.toggleAttribute('aria-current', id === this.#who);
      button.type = 'button';
      button.textContent = name;
      button.title = say('editRole', { name });
      button.addEventListener('click', () => this.#editor.open(member));
      small.textContent = [about, sex[is], this.#voices.get(voice)?.name].filter(Boolean).join(' · ');
      item.append(button, ' ', small);
      return item;
    }));
  }
}
