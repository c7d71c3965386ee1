// SPDX-License-Identifier: MIT
// The first page: speaks what is typed, or what a link holds.
import { copy } from '../shared/copy.js';
import { keepsStill, makeFilm, makesFilms } from '../shared/film.js';
import { FilmButton } from '../shared/film-button.js';
import { Frame } from '../shared/frame.js';
import { fillHeads, keptHead } from './head-choice.js';
import { FIRST, fill, primary, spokenLanguage } from '../shared/languages.js';
import { makeLink, readLink } from './link.js';
import { speak as words } from '../texts/index.js';
import { handOn, Recorder } from '../shared/take.js';
import { Transcript } from './transcript.js';
import { fillVoices } from '../shared/voice-choice.js';

const $ = (id) => document.getElementById(id);
const [form, text, lang, voice, rate, markup, room] = ['form', 'text', 'lang', 'voice', 'rate', 'markup', 'room'].map($);
const wish = readLink(location.search); // before the token is taken out of the address
const frame = new Frame(words, { captions: wish.captions === undefined ? {} : { on: wish.captions } });
const { head } = frame;
const say = (name, values) => frame.say(name, values);

const wanted = wish.lang ? [wish.lang, ...navigator.languages] : navigator.languages; // languages
let offered = FIRST;
let voices = [];
let last = null; // last request: {text, options}
let waiting = 0; // what we have asked for and has not ended
let heard = null; // the number of the utterance that is heard
let paused = false;
let transcript = null;

// Choices

function offer(tags, usual) {
  const chosen = lang.value && lang.dataset.chosen ? lang.value : spokenLanguage(wanted, tags, usual);
  offered = tags;
  fill(lang, tags, { page: frame.lang, others: say('otherLanguages'), chosen });
  showLanguage();
}

/** Has the fields follow the language that is spoken. */
function showLanguage() {
  text.lang = lang.value;
  const untouched = !text.value.trim() || Object.values(words).some(({ sample }) => sample === text.value);
  if (untouched) text.value = words[primary(lang.value)]?.sample ?? '';
  showVoices();
}

function showVoices() {
  const names = { automatic: say('automatic'), male: say('male'), female: say('female'), nameOf: (tag) => frame.nameOf(tag) };
  fillVoices(voice, voices, lang.value, names);
}

function showRate() {
  $('rate-value').value = say('unit', { n: rate.value });
}

function showButtons() {
  const busy = waiting > 0 || heard !== null;
  $('pause').querySelector('.text').textContent = say(paused ? 'resume' : 'pause');
  $('pause').ariaDisabled = String(!busy);
  $('repeat').ariaDisabled = String(!last);
}

function enterRoom() {
  if (!room.checkValidity()) room.reportValidity();
  else if (room.value) head.setAttribute('room', room.value);
  else head.removeAttribute('room');
}

// Speaking

async function perform(what, options) {
  last = { text: what, options };
  frame.problem.clear();
  frame.tell(null);
  head.stop();
  paused = false;
  waiting++;
  showButtons();
  await head.speak(what, options);
  waiting--;
  showButtons();
}

/** What the fields say about the voice. */
function manner() {
  const options = { lang: lang.value, rate: Number(rate.value) };
  const { voice: id, lang: tag } = voices.find((each) => each.id === voice.value) ?? {};
  if (id) Object.assign(options, { voice: id, lang: tag });
  if (markup.value !== 'auto') options.markup = markup.value;
  return options;
}

function speak() {
  if (!transcript) return; // the head is still on its way
  perform(text.value, { ...manner(), id: transcript.newId(), phones: true });
}

function repeat() {
  if (last) perform(last.text, { ...last.options, id: transcript.repeatId(last.options.id) });
}

function pause() {
  if ($('pause').ariaDisabled === 'true') return;
  if (paused) head.resume();
  else head.pause();
  paused = !paused;
  showButtons();
}

function stop() {
  if (!transcript) return;
  head.stop();
  paused = false;
  showButtons();
}

form.addEventListener('submit', (event) => {
  event.preventDefault();
  speak();
});
$('pause').addEventListener('click', pause);
$('stop').addEventListener('click', stop);
$('repeat').addEventListener('click', repeat);
lang.addEventListener('change', () => {
  lang.dataset.chosen = 'yes';
  showLanguage();
});
rate.addEventListener('input', showRate);
rate.addEventListener('change', () => transcript && (head.rate = Number(rate.value)));
room.addEventListener('change', enterRoom);
document.addEventListener('keydown', (event) => {
  if (event.key === 'Escape') stop();
  if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) speak();
});

// Events of the head

head.addEventListener('hello', ({ detail }) => {
  const kept = keptHead(detail.models);
  if (kept && head.model === null) head.model = kept;
  fillHeads($('head-box'), detail.models, head.model, (name) => {
    head.model = name;
  });
  offer([...detail.languages.map(({ tag }) => tag), ...(detail.more_languages ?? [])], detail.lang);
});
head.addEventListener('progress', ({ detail }) => {
  if (detail.ratio === null) $('progress').removeAttribute('value');
  else $('progress').value = detail.ratio;
});
for (const type of ['ready', 'error'])
  head.addEventListener(type, ({ detail }) => {
    if (type === 'ready' || detail.code === 'bad-model') $('loading').hidden = true;
  });
head.addEventListener('begin', ({ detail }) => {
  heard = detail.utterance;
  showButtons();
});
head.addEventListener('end', ({ detail }) => {
  if (detail.utterance === heard) heard = null;
  if (heard === null) paused = false;
  showButtons();
});
for (const type of ['paused', 'resumed'])
  head.addEventListener(type, () => {
    paused = type === 'paused';
    showButtons();
  });
head.addEventListener('connection', ({ detail }) => {
  if (detail.state === 'open') return;
  heard = null;
  paused = false;
  showButtons();
});

// Link to the Face Player with the last utterance

const recorder = new Recorder(head, () => ($('to-player').hidden = false));
$('to-player').addEventListener('click', async (event) => {
  event.preventDefault();
  try {
    await handOn(recorder.take);
    location.href = $('to-player').href;
  } catch {
    frame.tell('notHandedOn'); // the browser keeps nothing for this page
  }
});

// The transcript, and the link

function openTranscript(PlainText) {
  transcript = new Transcript($('said'), PlainText, (sentence, id) =>
    perform(sentence.text, { lang: sentence.lang, voice: sentence.voice, rate: Number(rate.value), markup: 'plain', id }));
  transcript.follow(head);
  const show = () => ($('said').hidden = $('said-buttons').hidden = !$('said').children.length);
  head.addEventListener('sentence', show);
  $('said-copy').addEventListener('click', async () => {
    frame.tell((await copy(transcript.text, $('said-field'))) ? 'copied' : 'selected');
  });
  $('said-save').addEventListener('click', () => {
    URL.revokeObjectURL($('said-save').href);
    $('said-save').href = URL.createObjectURL(new Blob([`${transcript.text}\n`], { type: 'text/plain' }));
  });
  $('said-save').href = '#';
  $('said-clear').addEventListener('click', () => {
    transcript.clear();
    $('said-field').hidden = true;
    show();
    text.focus();
  });
}

$('link').addEventListener('click', async () => {
  const state = {
    text: text.value, lang: lang.value, voice: voice.value, rate: Number(rate.value), markup: markup.value, room: room.value,
    captions: head.captions,
  };
  frame.tell((await copy(makeLink(location.href, state), $('link-field'))) ? 'linkCopied' : 'selected');
});

/** Fills the fields as the link says. It is not spoken at once: the reader does that. */
function follow() {
  if (wish.rate) rate.value = wish.rate;
  if (wish.markup) markup.value = wish.markup;
  if (wish.room) room.value = wish.room;
  if (wish.markup || wish.room) $('more').open = true;
  if (wish.room) enterRoom();
  if (wish.text) text.value = wish.text;
}

/** The voice of the link, and its language, when it is known which there are. */
function choose() {
  const found = voices.find(({ id }) => id === wish.voice);
  if (found && primary(found.lang) !== primary(lang.value)) {
    lang.value = spokenLanguage([found.lang], offered);
    lang.dataset.chosen = 'yes';
    showLanguage();
  }
  if (found) voice.value = found.id;
  if (wish.voice && !found) frame.problem.show({ code: 'unknown-voice', field: 'voice' });
  else if (wish.lang && primary(wish.lang) !== primary(lang.value)) frame.problem.show({ code: 'unknown-language', field: 'lang' });
}

// The film

new FilmButton(frame, $('film'), $('film-progress'), async (told, signal) => {
  const order = { text: text.value, model: head.model ?? undefined, still: keepsStill(head) || undefined, ...manner() };
  const film = await makeFilm(order, frame.access.token, told, signal);
  return film && { film, name: 'faccia.mp4' };
});

frame.onTranslate(() => {
  fill(lang, offered, { page: frame.lang, others: say('otherLanguages'), chosen: lang.value });
  showVoices();
  showRate();
  showButtons();
});
offer(FIRST);
follow();
const greeted = new Promise((resolve) => head.addEventListener('hello', resolve, { once: true }));
const { PlainText } = await frame.open();
openTranscript(PlainText);
({ voices } = (await frame.load('v1/voices')) ?? { voices: [] });
showVoices();
await greeted;
choose();
$('film').hidden = !(await makesFilms(frame.access.token));
if (wish.text && document.activeElement === document.body) $('speak').focus(); // it was hidden until now
