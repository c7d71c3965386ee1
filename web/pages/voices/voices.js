// SPDX-License-Identifier: MIT
// All voices of the server on one face: one sentence, spoken by each.
import { Frame } from '../shared/frame.js';
import { fill, primary, spokenLanguage } from '../shared/languages.js';
import { voices as words } from '../texts/index.js';

const $ = (id) => document.getElementById(id);
const [form, text, lang, list] = ['form', 'text', 'lang', 'voices'].map($);
const frame = new Frame(words);
const { head } = frame;
let voices = [];

const chosen = () => voices.filter((voice) => primary(voice.lang) === lang.value);
const tags = () => [...new Set(voices.map((voice) => primary(voice.lang)))];

function speak(voice) {
  head.speak(text.value, { voice: voice.id, lang: voice.lang });
}

function begin(some) {
  head.stop();
  frame.problem.clear();
  some.forEach(speak);
}

function item(voice) {
  const button = document.createElement('button');
  button.type = 'button';
  button.dataset.voice = voice.id;
  button.append(voice.name);
  const about = document.createElement('small');
  about.textContent = [voice.id, voice.lang, words[frame.lang][voice.gender], voice.quality, voice.licence].filter(Boolean).join(' · ');
  button.append(about);
  button.addEventListener('click', () => begin([voice]));
  const li = document.createElement('li');
  li.append(button);
  return li;
}

function show() {
  text.lang = lang.value;
  if (Object.values(words).some(({ sample }) => sample === text.value) || !text.value.trim()) text.value = words[lang.value]?.sample ?? '';
  list.replaceChildren(...chosen().map(item));
}

function mark(id) {
  for (const button of list.querySelectorAll('button')) {
    if (button.dataset.voice === id) button.setAttribute('aria-current', 'true');
    else button.removeAttribute('aria-current');
  }
  $('now').textContent = voices.find((voice) => voice.id === id)?.name ?? '';
}

head.addEventListener('begin', ({ detail }) => mark(detail.voice));
head.addEventListener('end', () => mark(null));
form.addEventListener('submit', (event) => {
  event.preventDefault();
  begin(chosen());
});
$('stop').addEventListener('click', () => head.stop());
lang.addEventListener('change', show);
document.addEventListener('keydown', (event) => event.key === 'Escape' && head.stop());
frame.onTranslate(() => {
  fill(lang, tags(), { page: frame.lang, others: frame.say('otherLanguages'), chosen: lang.value });
  show();
});

await frame.open();
({ voices } = (await frame.load('v1/voices')) ?? { voices: [] });
lang.replaceChildren();
fill(lang, tags(), { page: frame.lang, others: frame.say('otherLanguages'), chosen: spokenLanguage(navigator.languages.map(primary), tags()) });
show();
