// SPDX-License-Identifier: MIT
// How a person of a play speaks, as an editor decides: saved in WORK.cast.json beside the work, or downloaded.
import { DocumentStore } from '../shared/document-store.js';
import { fillVoices } from '../shared/voice-choice.js';

const NAME = /^[A-Za-z0-9_-][A-Za-z0-9._-]{0,63}$/; // of a file that the server saves
const SAMPLE = 160; // characters
const FACTORS = ['pitch', 'rate'];
const CHOICES = ['voice', 'head', 'affect', 'sex', 'age'];
const RANGE = [0.5, 1.6]; // of the sliders; a file may go further
const $ = (name) => document.getElementById(`role-${name}`);

/**
 * What the file says of a person after an edit: what was changed, and what it said before.
 * @param {object} before of the file @param {object} shown when the edit began
 * @param {object} now empty: to be chosen by the server
 */
export function entryOf(before, shown, now) {
  const entry = { ...before };
  for (const [name, value] of Object.entries(now)) {
    if (value === shown[name]) continue;
    if (value === '') delete entry[name];
    else entry[name] = value;
  }
  return entry;
}

/** Returns the file with an entry; an empty one is left out. @param {object} file @param {string|null} id null: the narrator */
export function withMember(file, id, entry) {
  const empty = !Object.keys(entry).length;
  const { narrator, cast, ...rest } = file;
  const others = { ...cast };
  if (id !== null) {
    delete others[id];
    if (!empty) others[id] = entry;
  }
  const own = id === null ? (empty ? undefined : entry) : narrator;
  return { ...rest, ...(own && { narrator: own }), ...(Object.keys(others).length && { cast: others }) };
}

export class CastEditor {
  #member = null; // being edited; its id is null for the narrator
  #shown = {};
  #models = [];
  #affects = null;

  /**
   * @param {import('../shared/frame.js').Frame} frame @param {HTMLElement} passage
   * @param {object} ports file(): of the work, in the library's folder; lang(): of the work; voices(): of the server;
   *   quiet(): stops what is being read; saved(id): a new cast is there, of which it returns the member
   */
  constructor(frame, passage, ports) {
    Object.assign(this, { frame, passage, ports, form: document.getElementById('role') });
    this.store = new DocumentStore('v1/library/files', frame.access, 'application/json');
    frame.head.addEventListener('hello', ({ detail }) => (this.#models = detail.models ?? []));
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#save(this.#now);
    });
    $('hear').addEventListener('click', () => this.#hear());
    $('reset').addEventListener('click', () => this.#save(null));
    $('close').addEventListener('click', () => this.close());
    for (const name of FACTORS) $(name).addEventListener('input', () => this.#showFactor(name));
  }

  get id() {
    return this.#member ? this.#member.id : undefined;
  }

  /** @param {object} member of the cast, or {id: null, ...} for the narrator */
  async open(member) {
    const { frame } = this;
    this.#member = member;
    this.#tell('');
    this.#affects ??= (await frame.load('v1/expressions'))?.expressions.filter(({ kind }) => kind === 'affect').map(({ name }) => name) ?? null;
    if (this.#member !== member) return;
    this.form.querySelector('legend').textContent = member.name;
    $('first').textContent = member.first ?? '';
    $('first').hidden = !member.first;
    $('first').lang = this.ports.lang();
    this.#fill(member);
    this.form.hidden = false;
    this.form.scrollIntoView({ block: 'nearest' });
    $('voice').focus();
  }

  close() {
    this.#member = null;
    this.form.hidden = true;
  }

  #fill(member) {
    const { say, nameOf } = this.frame;
    const automatic = say('automatic');
    fillVoices($('voice'), this.ports.voices(), this.ports.lang(), { automatic, male: say('male'), female: say('female'), nameOf: nameOf.bind(this.frame) });
    const options = {
      head: this.#models.map(({ name, title }) => [name, title ?? name]),
      affect: (this.#affects ?? []).map((name) => [name, name]),
      sex: ['female', 'male'].map((name) => [name, say(name)]),
      age: ['child', 'adult', 'old'].map((name) => [name, say(`age_${name}`)]),
    };
    for (const [name, list] of Object.entries(options)) $(name).replaceChildren(new Option(automatic, ''), ...list.map(([value, text]) => new Option(text, value)));
    for (const name of CHOICES) this.#choose($(name), member[name] ?? '');
    for (const name of FACTORS) {
      const value = member[name] ?? 1;
      $(name).min = Math.min(RANGE[0], value);
      $(name).max = Math.max(RANGE[1], value);
      $(name).value = value;
      this.#showFactor(name);
    }
    for (const name of ['sex', 'age']) $(name).closest('label').hidden = member.id === null;
    this.#shown = this.#now;
  }

  /** One that the list lacks, from a file, is added. */
  #choose(select, value) {
    select.value = value;
    if (select.value === value) return;
    select.append(new Option(value, value));
    select.value = value;
  }

  #showFactor(name) {
    $(`${name}-now`).textContent = `${Number($(name).value).toLocaleString(this.frame.lang)} ×`;
  }

  get #now() {
    const chosen = Object.fromEntries(CHOICES.map((name) => [name, $(name).value]));
    return { ...chosen, ...Object.fromEntries(FACTORS.map((name) => [name, Number($(name).value)])) };
  }

  #tell(name, values) {
    $('news').textContent = name ? this.frame.say(name, values) : '';
  }

  /** Says the person's first words in the section, or in the work, or its name. */
  #hear() {
    const { id, name } = this.#member;
    const { voice, affect, pitch, rate } = this.#now;
    const first = [...this.passage.querySelectorAll('[data-speaker], [data-who]')].find(({ dataset }) => (dataset.speaker ?? dataset.who) === id)?.cloneNode(true);
    for (const aside of first?.querySelectorAll('.stage, [data-unread]') ?? []) aside.remove();
    const said = first?.textContent.replace(/\s+/g, ' ').trim() || this.#member.first || name;
    const text = said.length > SAMPLE ? said.slice(0, said.lastIndexOf(' ', SAMPLE) + 1 || SAMPLE).trim() : said;
    const speaker = { id: id ?? '', ...(id !== null && { name }), ...(voice && { voice }), ...(affect && { affect }), pitch, rate, at: `0-${text.length}` };
    this.ports.quiet();
    this.frame.problem.clear();
    this.frame.head.speak(text, { lang: this.ports.lang(), markup: 'plain', mode: 'replace', speakers: JSON.stringify([speaker]) });
  }

  /** @param {object|null} now null: what the server chooses */
  async #save(now) {
    const { id, name } = this.#member;
    const file = (this.ports.file() ?? '').replace(/\.\w+$/, '.cast.json');
    const stored = NAME.test(file) && (await this.store.list());
    try {
      const text = stored ? await this.store.read(file).catch((error) => {
        if (error.code === 'not-found') return '{}';
        throw error;
      }) : '{}';
      const before = JSON.parse(text);
      const old = (id === null ? before.narrator : before.cast?.[id]) ?? {};
      const after = JSON.stringify(withMember(before, id, now ? entryOf(old, this.#shown, now) : {}), null, 2);
      if (!stored) {
        this.#download(file.split('/').at(-1), `${after}\n`);
        return;
      }
      await this.store.save(file, `${after}\n`);
      this.#tell('roleSaved', { name, file });
      const member = await this.ports.saved(id);
      if (member && this.#member?.id === id) this.#fill((this.#member = member));
    } catch (error) {
      if (error instanceof SyntaxError) this.#tell('roleBroken', { file });
      else this.frame.problem.show(error);
    }
  }

  #download(file, text) {
    const url = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
    Object.assign(document.createElement('a'), { href: url, download: file }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
    this.#tell('roleDownloaded', { file });
  }
}
