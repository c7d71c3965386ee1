// SPDX-License-Identifier: MIT
// The desk of somebody who speaks through the face of a room: prepared lines, free text, answers, moods, and a log of it all.
import { words as emotionWords } from './emotion-words.js';
import { Frame } from './frame.js';
import { FIRST, fill, primary, spokenLanguage } from './languages.js';
import { Log } from './operator-log.js';
import { Waiting } from './operator-queue.js';
import { scenes, words } from './operator-words.js';
import { readCsv, readScene, writeCsv, writeTable } from './scene.js';
import { forGood } from './storage.js';

const KEY = 'faccia.scene';
const ROOMS_MS = 3000;
const STATES = ['idle', 'listening', 'thinking', 'muted'];
const USUAL_RATE = 160; // words a minute, where no rate has been asked for
const $ = (id) => document.getElementById(id);
const [text, lang, mood, state] = ['text', 'lang', 'mood', 'state'].map($);
const frame = new Frame(words);
const { head } = frame;
const say = (name, values) => frame.say(name, values);
const log = new Log($('said'), say);
const waiting = new Waiting($('queue'), say, () => ($('empty').hidden = waiting.size > 0));
const how = { rate: null, volume: 1 };
const speaking = new Set(); // ids of what was sent and has not ended
const turn = new Map(); // which variant of a line comes next, by its id
let scene = { title: '', lines: [] };
let expected = null; // the line that is likely next
let offered = null; // the choices of a line: {id, choices}
let last = null; // what was said last: {text, options}
let count = 0;
let linked = false;
let caption = null; // of the sentence that is heard

const sendable = () => head.room && text.value.trim();

function speak(what, options = {}) {
  const id = `desk-${++count}`;
  last = { text: what, options: { ...options, mode: undefined } };
  log.add('say', what, { id, ...options });
  speaking.add(id);
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
  log.add('mood', typeof mix === 'string' ? mix : JSON.stringify(mix));
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
}

/** The scene to begin with: the one that was here last, or an example in the reader's language. */
function firstScene() {
  try {
    scene = readScene(JSON.parse(forGood.get(KEY)));
  } catch {
    scene = readCsv(writeTable([['id', 'text', 'variants', 'mood', 'choices'], ...scenes[frame.lang]]));
  }
  showScene();
}

function download(name, what, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([what], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** For the operator alone. */
async function preview() {
  const { token } = frame.access;
  const answer = await fetch(`v1/speech?format=ogg&lang=${encodeURIComponent(lang.value)}`, {
    method: 'POST', body: text.value,
    headers: { 'content-type': 'text/plain', ...(token ? { authorization: `Bearer ${token}` } : {}) },
  });
  if (!answer.ok) {
    frame.problem.show(await answer.json());
    return;
  }
  const sound = new AudioContext(), source = sound.createBufferSource();
  source.buffer = await sound.decodeAudioData(await answer.arrayBuffer());
  source.connect(sound.destination);
  source.onended = () => sound.close();
  source.start();
}

function enter() {
  const room = $('room').value.trim();
  if (!room) return;
  head.setAttribute('room', room);
  $('kiosk').href = `room.html?room=${encodeURIComponent(room)}`;
  $('kiosk').hidden = false;
  log.add('enter', room);
  text.focus();
}

/** Others at a desk of this room. */
function desks({ followers, listeners }) {
  const others = followers - listeners - 1;
  return others > 0 && say('desks', { n: others });
}

async function lookAround() {
  if (linked && !document.hidden) {
    const { rooms = [] } = (await frame.load('v1/rooms')) ?? {};
    const here = rooms.find(({ name }) => name === head.room);
    $('rooms').replaceChildren(...rooms.map(({ name, listeners }) => new Option(`${name} (${listeners})`, name)));
    $('listeners').textContent = here ? [say('followers', { n: here.listeners }), desks(here)].filter(Boolean).join(' · ') : say('nobody');
  }
  setTimeout(lookAround, ROOMS_MS);
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
  const names = emotionWords[frame.lang].affects, chosen = mood.value, sign = state.value;
  mood.replaceChildren(new Option(say('neutral'), ''), ...Object.keys(names).map((name) => new Option(names[name], name)));
  mood.value = chosen;
  state.replaceChildren(...STATES.map((name) => new Option(say(name), name)));
  state.value = sign || 'idle';
}

head.addEventListener('connection', ({ detail }) => (linked = detail.state === 'open'));
head.addEventListener('joined', ({ detail }) => log.add('joined', detail.room));
head.addEventListener('sentence', ({ detail }) => {
  caption = log.show('sentence', '', { id: detail.id, by: detail.stream });
  caption.dataset.text = detail.text;
});
head.addEventListener('word', ({ detail }) => caption && (caption.textContent = `${caption.textContent} ${detail.text}`.trim()));
head.addEventListener('end', ({ detail }) => {
  speaking.delete(detail.id);
  if (caption) caption.textContent = detail.reason === 'done' ? caption.dataset.text : `${caption.textContent} …`;
  caption = null;
  log.add('end', detail.reason, { id: detail.id });
  if (detail.reason === 'stopped') log.show('stopped');
  if (!speaking.size && waiting.size) {
    const next = waiting.take();
    speak(next.text, next.options);
  }
});
head.addEventListener('chosen', ({ detail }) => {
  log.show('chosen', detail.text, { by: detail.by, id: detail.id });
  if (offered?.id === detail.id) expect(offered.choices[detail.choice]?.next);
});
head.addEventListener('state', ({ detail }) => {
  log.show('stated', `${say(detail.state)} ${detail.text ?? ''}`.trim());
  state.value = detail.state;
});
head.addEventListener('error', ({ detail }) => {
  speaking.delete(detail.id);
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
$('preview').addEventListener('click', () => text.value.trim() && preview());
$('stop').addEventListener('click', () => head.stop());
$('offer').addEventListener('click', () => {
  const [question, ...answers] = $('choices').value.split('|').map((each) => each.trim()).filter(Boolean);
  if (head.room && answers.length) offer(answers, { question, id: `desk-${++count}` });
});
$('withdraw').addEventListener('click', () => head.room && offer([]));
mood.addEventListener('change', () => express(mood.value));
state.addEventListener('change', () => head.tell(state.value));
for (const name of ['repeat', 'slower', 'faster', 'louder', 'softer']) $(name).addEventListener('click', () => change(name));
$('take').addEventListener('click', () => takeScene($('source').value));
$('file').addEventListener('change', async ({ target }) => target.files[0] && takeScene(await target.files[0].text()));
$('save-csv').addEventListener('click', () => download('scene.csv', writeCsv(scene), 'text/csv'));
$('save-json').addEventListener('click', () => download('scene.json', JSON.stringify(scene, null, 2), 'application/json'));
$('csv').addEventListener('click', () => download('log.csv', log.csv, 'text/csv'));
$('json').addEventListener('click', () => download('log.json', log.json, 'application/json'));
document.addEventListener('keydown', (event) => {
  const { key, ctrlKey, metaKey, altKey, target } = event;
  if (key === 'Escape') head.stop();
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
await frame.open();
firstScene();
const wished = new URLSearchParams(location.search).get('room');
if (wished) {
  $('room').value = wished;
  enter();
}
lookAround();
