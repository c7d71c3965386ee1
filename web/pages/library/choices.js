// SPDX-License-Identifier: MIT
// The reader's choices: voice, speed, verse, sleep timer, mouth only, the face, size and contrast of the text.
import { applyLooks, keepLooks, keptLooks } from './looks.js';
import { voicesOf } from '../shared/voice-choice.js';

const USUAL_RATE = 150; // words a minute, assumed for a voice before it is known
const MINUTES = [5, 15, 30, 60];
const $ = (id) => document.getElementById(id);

export class Choices {
  #voices = [];
  #section = null;
  #timer = 0;

  /**
   * @param {import('../shared/frame.js').Frame} frame @param {HTMLElement} passage
   * @param {import('./offline.js').KeptSpeech} spoken
   */
  constructor(frame, passage, spoken) {
    Object.assign(this, { frame, head: frame.head, say: frame.say, passage, spoken });
    $('mouth').addEventListener('click', () => this.mouth());
    if (matchMedia('(max-width: 52rem)').matches) $('face').setAttribute('aria-pressed', 'false'); // reduced to a strip until opened
    $('face').addEventListener('click', () => this.face());
    $('speed').addEventListener('input', () => this.#setSpeed());
    $('verse').addEventListener('change', () => this.#setVerse());
    $('sleep').addEventListener('change', () => this.#setSleep());
    $('voice').addEventListener('change', () => this.#setVoice());
    for (const name of ['size', 'spacing', 'contrast']) $(name).addEventListener('input', () => this.#setLooks());
    frame.onTranslate(() => {
      this.#fillSleep();
      this.#fillVoices();
    });
    this.#restoreLooks();
  }

  /** @param {object[]} list voices of the server */
  set voices(list) {
    this.#voices = list;
    this.#fillVoices();
  }

  /** @param {object} section the open section of the library */
  set section(section) {
    this.#section = section;
    this.#fillVoices();
    this.#setVerse();
  }

  #fillVoices() {
    const { say } = this;
    const chosen = $('voice').value;
    const sex = { male: say('male'), female: say('female') };
    const { recording } = this.#section ?? {};
    const own = recording && recording.state !== 'failed' ? [new Option(say('ownVoice'), 'recording')] : [];
    const others = voicesOf(this.#voices, this.#section?.work.lang ?? this.frame.lang).flatMap(({ voices }) => voices);
    $('voice').replaceChildren(new Option(say('automatic'), ''), ...own,
      ...others.map(({ id, name, gender }) => new Option(sex[gender] ? `${name} (${sex[gender]})` : name, id)));
    $('voice').value = chosen;
    if ($('voice').selectedIndex < 0) $('voice').value = '';
    this.#setVoice();
  }

  #setVoice() {
    this.head.voice = $('voice').value || null;
    this.#setSpeed();
  }

  /** Sets the speed, relative to the usual rate of a voice or of a recording. */
  #setSpeed() {
    const speed = Number($('speed').value);
    const { value } = $('voice');
    const id = value === 'recording' ? `recording:${this.#section?.work.id}` : value;
    const own = this.#voices.find((voice) => voice.id === id)?.words_per_minute ?? USUAL_RATE;
    $('speed-now').textContent = `${speed.toLocaleString(this.frame.lang)} ×`;
    this.head.rate = speed === 1 ? null : Math.min(500, Math.max(40, Math.round(own * speed)));
    this.spoken.speed = speed;
  }

  /** Sets how lines end, in a section that has verse. */
  #setVerse() {
    const has = Boolean(this.#section?.blocks.some(({ kind }) => kind === 'verse'));
    $('verse').closest('label').hidden = !has;
    this.head.verse = (has && $('verse').value) || null;
  }

  #setSleep() {
    clearTimeout(this.#timer);
    const minutes = Number($('sleep').value);
    if (!(minutes > 0)) return;
    this.#timer = setTimeout(() => {
      this.head.pause();
      this.spoken.stop();
      $('sleep').value = '';
      this.frame.tell('asleep');
    }, minutes * 60000);
  }

  #fillSleep() {
    const { say } = this;
    const chosen = $('sleep').value;
    const times = MINUTES.map((n) => new Option(say('minutes', { n }), n));
    $('sleep').replaceChildren(new Option(say('never'), ''), ...times, new Option(say('sectionEnd'), 'section'));
    $('sleep').value = chosen;
  }

  mouth() {
    const on = $('mouth').getAttribute('aria-pressed') !== 'true';
    $('mouth').setAttribute('aria-pressed', String(on));
    this.head.view = on ? 'mouth' : null;
  }

  face() {
    const on = $('face').getAttribute('aria-pressed') !== 'true';
    $('face').setAttribute('aria-pressed', String(on));
    document.body.classList.toggle('faceless', !on);
    document.body.classList.toggle('faced', on);
  }

  #setLooks() {
    const looks = { size: $('size').value, wide: $('spacing').checked, contrast: $('contrast').checked };
    applyLooks(this.passage, looks);
    keepLooks(looks);
  }

  #restoreLooks() {
    const { size, wide, contrast } = keptLooks();
    if (size) $('size').value = size;
    $('spacing').checked = Boolean(wide);
    $('contrast').checked = Boolean(contrast);
    this.#setLooks();
  }
}
