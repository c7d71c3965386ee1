// SPDX-License-Identifier: MIT
// All voices of the server on one face: one sentence, spoken by each.
const words = {
  it: {
    face: 'La testa', back: 'Una voce sola', text: 'Frase da dire', lang: 'Lingua', all: 'Tutte di seguito', stop: 'Ferma', voices: 'Voci',
    hint: 'Le registrazioni dicono soltanto il proprio testo. Esc: ferma.', female: 'donna', male: 'uomo', neutral: '', none: 'Il server non risponde.',
  },
  pt: {
    face: 'A cabeça', back: 'Uma só voz', text: 'Frase a dizer', lang: 'Idioma', all: 'Todas em seguida', stop: 'Parar', voices: 'Vozes',
    hint: 'As gravações dizem só o seu próprio texto. Esc: parar.', female: 'mulher', male: 'homem', neutral: '', none: 'O servidor não responde.',
  },
  tr: {
    face: 'Baş', back: 'Tek ses', text: 'Söylenecek cümle', lang: 'Dil', all: 'Hepsi sırayla', stop: 'Dur', voices: 'Sesler',
    hint: 'Kayıtlar yalnızca kendi metinlerini söyler. Esc: dur.', female: 'kadın', male: 'erkek', neutral: '', none: 'Sunucu yanıt vermiyor.',
  },
  en: {
    face: 'The head', back: 'One voice', text: 'Sentence to speak', lang: 'Language', all: 'All in turn', stop: 'Stop', voices: 'Voices',
    hint: 'Recordings say their own text only. Esc: stop.', female: 'woman', male: 'man', neutral: '', none: 'The server does not answer.',
  },
};

const samples = {
  it: 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura.',
  pt: 'Amor é fogo que arde sem se ver, é ferida que dói, e não se sente.',
  tr: 'Gelin tanış olalım, işi kolay kılalım, sevelim sevilelim.',
  en: 'Shall I compare thee to a summer’s day? Thou art more lovely.',
};

const $ = (id) => document.getElementById(id);
const [head, form, text, lang, list] = ['head', 'form', 'text', 'lang', 'voices'].map($);
const primary = (tag) => tag.split('-')[0].toLowerCase();
let voices = [];

const chosen = () => voices.filter((voice) => primary(voice.lang) === lang.value);

/** A language in its own words; its tag when the browser does not know it. */
function name(tag) {
  try {
    return new Intl.DisplayNames([tag], { type: 'language' }).of(tag);
  } catch {
    return tag;
  }
}

function speak(voice) {
  head.speak(text.value, { voice: voice.id, lang: voice.lang });
}

function item(voice) {
  const button = document.createElement('button');
  button.type = 'button';
  button.dataset.voice = voice.id;
  button.append(voice.name);
  const about = document.createElement('small');
  about.textContent = [voice.id, voice.lang, (words[lang.value] ?? words.en)[voice.gender], voice.quality, voice.licence].filter(Boolean).join(' · ');
  button.append(about);
  button.addEventListener('click', () => {
    head.stop();
    $('problem').textContent = '';
    speak(voice);
  });
  const li = document.createElement('li');
  li.append(button);
  return li;
}

function show() {
  const table = words[lang.value] ?? words.en;
  document.documentElement.lang = words[lang.value] ? lang.value : 'en';
  text.lang = lang.value;
  for (const element of document.querySelectorAll('[data-text]')) element.textContent = table[element.dataset.text];
  if (Object.values(samples).includes(text.value) || !text.value.trim()) text.value = samples[lang.value] ?? '';
  list.replaceChildren(...chosen().map(item));
}

function mark(id) {
  for (const button of list.querySelectorAll('button')) button.toggleAttribute('aria-current', button.dataset.voice === id);
  $('now').textContent = voices.find((voice) => voice.id === id)?.name ?? '';
}

head.addEventListener('begin', ({ detail }) => mark(detail.voice));
head.addEventListener('end', () => mark(null));
head.addEventListener('error', ({ detail }) => ($('problem').textContent = detail.message));
form.addEventListener('submit', (event) => {
  event.preventDefault();
  head.stop();
  $('problem').textContent = '';
  chosen().forEach(speak);
});
$('stop').addEventListener('click', () => head.stop());
lang.addEventListener('change', show);
document.addEventListener('keydown', (event) => event.key === 'Escape' && head.stop());

try {
  ({ voices } = await (await fetch('/v1/voices')).json());
  const tags = [...new Set(voices.map((voice) => primary(voice.lang)))];
  const first = Object.keys(samples).filter((tag) => tags.includes(tag));
  const others = tags.filter((tag) => !first.includes(tag)).sort();
  lang.replaceChildren(...[...first, ...others].map((tag) => new Option(name(tag), tag)));
} catch {
  $('problem').textContent = words.it.none;
}
show();
