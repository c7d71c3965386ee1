// SPDX-License-Identifier: MIT
// The page of an operator who speaks through the face of a room: prepared lines, free text, answers, moods, and a log.
import { bearer } from '../shared/bearer.js';
import { DocumentStore } from '../shared/document-store.js';
import { Frame } from '../shared/frame.js';
import { fill, FIRST, primary, spokenLanguage } from '../shared/languages.js';
import { forGood } from '../shared/storage.js';
import { emotion, operator as words } from '../texts/index.js';
import { Log } from './log.js';
import { RoomMood } from './mood.js';
import { Overhear } from './overhear.js';
import { People } from './people.js';
import { Questions } from './questions.js';
import { Waiting } from './queue.js';
import { readCsv, readScene, writeCsv, writeTable } from './scene.js';
import { Study } from './study.js';

const KEY = 'faccia.scene';
const STATES = ['idle', 'listening', 'thinking', 'muted', 'error', 'asleep'];
const USUAL_RATE = 160; // words a minute, if no rate was requested
const $ = (id) => document.getElementById(id);
const [text, lang, state] = ['text', 'lang', 'state'].map($);
const frame = new Frame(words);
const { head } = frame;
const say = (name, values) => frame.say(name, values);
const log = new Log($('said'), say);
const waiting = new Waiting($('queue'), say, () => ($('empty').hidden = waiting.size > 0));
const store = new DocumentStore('v1/scenes', frame.access, 'application/json');
const people = new People({ rooms: $('rooms'), shown: $('listeners') }, { head, log, say, load: (address) => frame.load(address) });
const mood = new RoomMood({ svg: $('disc'), choice: $('mood'), shown: $('mix') }, {
  send: (mix, options) => head.express(mix, options), log: (what, more) => log.add('mood', what, more), say,
  called: (name) => emotion[frame.lang].affects[name] ?? name, self: () => me,
});
const study = new Study({ text: $('consent-text'), ask: $('ask-consent'), end: $('end-study'), shown: $('consent') }, { send: (...what) => head.room && head.consent(...what), log, say });
const overhear = new Overhear({ hear: $('overhear'), again: $('again') }, { head, log: (what, state) => log.add(what, state) });
const questions = new Questions($('questions'), {
  head, say, download, lang: () => frame.lang, consented: () => study.consent === 'given' || study.consent === 'none', problem: (error) => frame.problem.show(error),
  log: (what, title) => log.add(what, title),
});
const how = { rate: null, volume: 1 };
const speaking = new Map(); // texts that were sent and have not ended, by id
const turn = new Map(); // index of the next variant of each line, by its id
let scene = { title: '', lines: [] };
let expected = null; // the line suggested next
let offered = null; // the choices of a line: {id, choices}
let last = null; // the last text spoken: {text, options}
let count = 0;
let me = new URLSearchParams(location.search).get('name')?.slice(0, 16) || `desk-${Math.random().toString(36).slice(2, 6)}`;
let stopping = false; // stopped here: the following end is not caused by the listener
let caption = null; // text of the audible sentence

const sendable = () => head.room && text.value.trim();

function speak(what, options = {}) {
  const id = `${me}-${++count}`;
  last = { text: what, options: { ...options, mode: undefined } };
  log.add('say', what, { id, ...options });
  speaking.set(id, what);
  const voice = { ...(how.rate ? { rate: how.rate } : {}), ...(how.volume === 1 ? {} : { volume: how.volume }) };
  head.speak(what, { id, lang: lang.value, ...voice, ...options });
}

function offer(choices, options = {}) {
  if (head.offer(choices, options)) log.show('chose', choices.length ? [options.question, ...choices].filter(Boolean).join(' | ') : '–', options);
}

function sayLine(line) {
  const all = [line.text, ...line.variants], at = turn.get(line.id) ?? 0;
  turn.set(line.id, (at + 1) % all.length);
  if (line.mood) express(line.mood);
  speak(all[at]);
  if (line.choices.length) {
    offered = { id: `line-${line.id}`, choices: line.choices };
    offer(line.choices.map((choice) => choice.text), { id: offered.id });
  }
  expect(line.next);
}

function expect(id) {
  expected = id ?? null;
  for (const button of $('lines').querySelectorAll('button')) {
    button.classList.toggle('next', button.dataset.id === expected);
    button.ariaCurrent = button.dataset.id === expected ? 'step' : null;
  }
}

function express(mix) {
  head.express(mix);
  log.add('mood', mix);
}

function stop() {
  stopping = true;
  head.stop();
}

function showScene() {
  $('lines').replaceChildren(...scene.lines.map((line, i) => {
    const item = document.createElement('li'), button = document.createElement('button'), key = document.createElement('kbd');
    button.type = 'button';
    button.dataset.id = line.id;
    key.textContent = i < 9 ? String(i + 1) : '';
    button.append(key, line.text);
    button.addEventListener('click', () => head.room && sayLine(line));
    item.append(button);
    return item;
  }));
  $('source').value = writeCsv(scene);
  expect(expected);
}

/** @param {string} source JSON or a table */
function takeScene(source) {
  try {
    scene = source.trimStart().startsWith('{') ? readScene(JSON.parse(source)) : readCsv(source);
  } catch (error) {
    frame.problem.show({ code: 'bad-scene', message: say('badScene', { place: error.message }) });
    return;
  }
  frame.problem.clear();
  forGood.set(KEY, JSON.stringify(scene));
  frame.tell('sceneTaken');
  showScene();
  showBackdrop();
}

function showBackdrop() {
  $('backdrop').value = scene.backdrop ?? '';
  if (head.room) head.showBackdrop(scene.backdrop ?? '');
}

/** Runs a command on the stored scene whose name is in the field, and shows an error of the server. */
async function onStoredScene(act, done) {
  const name = $('scene-name').value.trim();
  if (!$('stored').reportValidity()) return;
  try {
    await act(name);
    frame.problem.clear();
    frame.tell(done);
    log.add(done, name);
  } catch (error) {
    frame.problem.show(error);
  }
  await showStored();
}

async function showStored() {
  const scenes = await store.list();
  $('stored').hidden = !scenes;
  $('no-scenes').hidden = Boolean(scenes);
  $('kept').replaceChildren(...(scenes ?? []).map(({ name }) => new Option(name)));
}

/** Loads the first scene: the last one used here, or an example in the user's language. */
function firstScene() {
  try {
    scene = readScene(JSON.parse(forGood.get(KEY)));
  } catch {
    scene = readCsv(writeTable([['id', 'text', 'variants', 'mood', 'choices'], ...words[frame.lang].sampleScene]));
  }
  showScene();
  $('backdrop').value = scene.backdrop ?? '';
}

function enter() {
  const room = $('room').value.trim();
  if (!room) return;
  if (room !== head.room) study.left();
  head.setAttribute('watch', me);
  head.setAttribute('room', room);
  $('kiosk').href = `room.html?room=${encodeURIComponent(room)}`;
  $('kiosk').hidden = false;
  log.add('enter', room);
  text.focus();
}

function change(by) {
  if (by === 'repeat' && last) speak(last.text, last.options);
  if (by === 'slower' || by === 'faster') {
    how.rate = Math.round(Math.min(400, Math.max(60, (how.rate ?? USUAL_RATE) * (by === 'slower' ? 0.85 : 1.15))));
    head.rate = how.rate;
  }
  if (by === 'louder' || by === 'softer') how.volume = Math.min(4, Math.max(0.25, how.volume * (by === 'louder' ? 1.25 : 0.8)));
  log.add(by, by.endsWith('er') && by !== 'louder' && by !== 'softer' ? String(how.rate) : String(how.volume));
}

function showChoices() {
  const sign = state.value;
  mood.translate();
  study.translate();
  questions.translate();
  state.replaceChildren(...STATES.map((name) => new Option(say(name), name)));
  state.value = sign || 'idle';
}

head.addEventListener('connection', ({ detail }) => {
  if (detail.state !== 'open') study.lost();
});
head.addEventListener('authorized', ({ detail }) => (me = detail.subject || me));
head.addEventListener('joined', ({ detail }) => {
  log.add('joined', detail.room);
  if (scene.backdrop) head.showBackdrop(scene.backdrop);
  study.joined();
});
head.addEventListener('observers', ({ detail }) => people.observers(detail.observers, me));
head.addEventListener('expressed', ({ detail }) => mood.heard(detail));
head.addEventListener('consent', ({ detail }) => {
  study.heard(detail);
  if (detail.consent !== 'given') overhear.forget();
  if (detail.consent === 'declined') questions.forget();
});
head.addEventListener('sentence', ({ detail }) => {
  caption = log.show('sentence', detail.text, { shown: '', id: detail.id, by: detail.id?.replace(/-\d+$/, '') ?? '' });
  caption.dataset.text = detail.text;
});
head.addEventListener('word', ({ detail }) => caption && (caption.textContent = `${caption.textContent} ${detail.text}`.trim()));
head.addEventListener('end', ({ detail }) => {
  if (detail.reason === 'failed' && speaking.has(detail.id)) log.show('refused', speaking.get(detail.id), { id: detail.id });
  speaking.delete(detail.id);
  if (caption) caption.textContent = detail.reason === 'done' ? caption.dataset.text : `${caption.textContent} …`;
  caption = null;
  const listener = detail.reason === 'stopped' && !stopping; // perhaps by a touch
  log.add('end', listener && log.silent ? '' : detail.reason, { id: detail.id, listener: listener && !log.silent });
  if (detail.reason === 'stopped') log.show('stopped', '', { listener });
  stopping = false;
  if (!speaking.size && waiting.size) {
    const next = waiting.take();
    speak(next.text, next.options);
  }
});
head.addEventListener('chosen', ({ detail }) => {
  log.show('chosen', detail.text, { by: detail.by, id: detail.id, listener: true });
  if (offered?.id === detail.id) expect(offered.choices[detail.choice]?.next);
});
head.addEventListener('heard', ({ detail }) => {
  const { id, text: words, final, by, confidence } = detail;
  if (final && words) log.show('heard', words, { id, by, listener: true, ...(confidence === undefined ? {} : { confidence }) });
});
head.addEventListener('state', ({ detail }) => {
  log.show('stated', `${say(detail.state)} ${detail.text ?? ''}`.trim(), { listener: Boolean(detail.text) });
  state.value = detail.state;
});
head.addEventListener('error', ({ detail }) => {
  log.add('error', detail.message, { id: detail.id });
});

$('enter').addEventListener('submit', (event) => {
  event.preventDefault();
  enter();
});
$('form').addEventListener('submit', (event) => {
  event.preventDefault();
  if (!sendable()) return;
  speak(text.value);
  text.value = '';
});
$('now').addEventListener('click', () => sendable() && speak(text.value, { mode: 'interrupt' }));
$('later').addEventListener('click', () => {
  if (!sendable()) return;
  if (speaking.size) waiting.add(text.value, {});
  else speak(text.value);
  text.value = '';
});
$('preview').addEventListener('click', async () => {
  if (!text.value.trim()) return;
  await preview(text.value, { lang: lang.value, token: frame.access.token }).catch((error) => frame.problem.show(error));
});
$('stop').addEventListener('click', stop);
$('offer').addEventListener('click', () => {
  const [question, ...answers] = $('choices').value.split('|').map((each) => each.trim()).filter(Boolean);
  if (head.room && answers.length) offer(answers, { question, id: `${me}-${++count}` });
});
$('withdraw').addEventListener('click', () => head.room && offer([]));
state.addEventListener('change', () => head.tell(state.value));
for (const name of ['repeat', 'slower', 'faster', 'louder', 'softer']) $(name).addEventListener('click', () => change(name));
$('take').addEventListener('click', () => takeScene($('source').value));
$('stored').addEventListener('submit', (event) => {
  event.preventDefault();
  onStoredScene(async (name) => takeScene(await store.read(name)), 'sceneTaken');
});
$('keep-scene').addEventListener('click', () => onStoredScene((name) => store.save(name, JSON.stringify(scene, null, 1)), 'sceneKept'));
$('drop-scene').addEventListener('click', () => onStoredScene((name) => store.remove(name), 'sceneDropped'));
$('store').addEventListener('toggle', () => $('store').open && showStored());
$('scene-name').addEventListener('focus', showStored);
$('backdrop-form').addEventListener('submit', (event) => {
  event.preventDefault();
  const backdrop = $('backdrop').value.trim();
  scene = { ...scene, backdrop };
  if (!backdrop) delete scene.backdrop;
  forGood.set(KEY, JSON.stringify(scene));
  showBackdrop();
  log.add('backdrop', backdrop);
});
$('file').addEventListener('change', async ({ target }) => target.files[0] && takeScene(await target.files[0].text()));
$('save-csv').addEventListener('click', () => download('scene.csv', writeCsv(scene), 'text/csv'));
$('save-json').addEventListener('click', () => download('scene.json', JSON.stringify(scene, null, 2), 'application/json'));
$('csv').addEventListener('click', () => download('log.csv', log.csv, 'text/csv'));
$('json').addEventListener('click', () => download('log.json', log.json, 'application/json'));
document.addEventListener('keydown', (event) => {
  const { key, ctrlKey, metaKey, altKey, target } = event;
  if (key === 'Escape') stop();
  if (key === 'Enter' && ctrlKey) $('form').requestSubmit();
  if (ctrlKey || metaKey || altKey || target.closest('input, textarea, select')) return;
  const act = { r: 'repeat', s: 'slower', l: 'louder' }[key.toLowerCase()];
  if (act) change(act);
  if (/^[1-9]$/.test(key) && head.room && scene.lines[key - 1]) sayLine(scene.lines[key - 1]);
});

frame.onTranslate(() => {
  fill(lang, FIRST, { page: frame.lang, others: say('otherLanguages'), chosen: lang.value || spokenLanguage(navigator.languages.map(primary), FIRST) });
  showChoices();
  waiting.show();
});
const wished = new URLSearchParams(location.search).get('room');
$('kiosk').hidden = !wished; // before the page is shown, so that nothing moves for it
await frame.open();
firstScene();
frame.load('v1/expressions').then((known) => (mood.affects = (known?.expressions ?? []).filter(({ kind }) => kind === 'affect')));
if (wished) {
  $('room').value = wished;
  enter();
}
people.follow();

/** Offers a file for download. */
function download(name, what, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([what], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/**
 * Plays a text as the head would say it, to the operator alone.
 * @param {string} text @param {{lang: string, token: string|null}} how @throws {{code: string}}
 */
async function preview(text, { lang, token }) {
  const answer = await fetch(`v1/speech?format=ogg&lang=${encodeURIComponent(lang)}`, {
    method: 'POST', body: text,
    headers: { 'content-type': 'text/plain', ...bearer(token) },
  });
  if (!answer.ok) throw await answer.json();
  const sound = new AudioContext(), source = sound.createBufferSource();
  source.buffer = await sound.decodeAudioData(await answer.arrayBuffer());
  source.connect(sound.destination);
  source.onended = () => sound.close();
  source.start();
}
