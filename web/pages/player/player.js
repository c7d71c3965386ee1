// SPDX-License-Identifier: MIT
// The Face Player: shows FAP files and their sound frame by frame, and edits them.
import { bearer } from '../shared/bearer.js';
import { Frame } from '../shared/frame.js';
import { fill, FIRST, spokenLanguage } from '../shared/languages.js';
import { Anatomy } from './anatomy.js';
import { drawnOver, History, keysOf, mirrored, smooth, spline } from './curve.js';
import { emptyFaps, isFapc, readCoded, readFap, wholeWav, writeFap } from './file.js';
import { isFba, mono, readFapcFile, readFba, supplyFba } from './player-kit.js';
import { FILM, Film } from './film.js';
import { FilmButton } from '../shared/film-button.js';
import { openGestureForm } from './gesture.js';
import { Plots } from './plots.js';
import { lastTake } from '../shared/take.js';
import { player as words } from '../texts/index.js';

const FACE = /\.(fapc?|fba|bits)$/i;

const $ = (id) => document.getElementById(id);
const NEAR = 0.02; // of a curve's range: maximum deviation of its keys

const frame = new Frame(words, { captions: { on: false } });
const { head, say } = frame;
const draw = (drawn) => reshape(drawnOver(valuesOf(number()), drawn));
const plots = new Plots($('plots'), { seek: (seconds) => goTo(Math.round(seconds * take.fps)), key: putKey, drop: dropKey, draw });
const anatomy = new Anatomy(head, $('anatomy'));
const film = new Film($('film'), $('film-start'));
const { faps: table } = await (await fetch('faps.json')).json();
const fapOf = (number) => table[number - 1];
const sound = { context: null, buffer: null, source: null, began: 0, from: 0 };
let take = null; // { name, fps, frames, high, duration, samples, rate, phones, words }
let history = new History();
let keys = new Map(); // FAP number -> frames
let copied = null;
let now = 0; // frame

const context = () => (sound.context ??= new AudioContext());
const number = () => Number($('curve').value);
const valuesOf = (n) => take.frames.map((values) => values[n]);

// Opening

async function open({ bytes, name, audio = null, times = null }) {
  const coded = isFapc(bytes) ? readFapcFile : isFba(bytes) ? (data, most) => supplyFba(readFba(data, most)) : null;
  const read = coded ? readCoded(bytes, coded) : readFap(new TextDecoder().decode(bytes));
  edit({ ...read, name, ...times }, audio && (await context().decodeAudioData(audio)));
}

/** @param {object} read as of player-file.js, with phones and words where they are known @param {AudioBuffer|null} buffer */
function edit(read, buffer) {
  stop();
  sound.buffer = buffer;
  const { name, fps, frames, high, phones = [], words: said = [] } = read;
  take = {
    name, fps, frames, high, phones, words: said, duration: Math.max(frames.length / fps, buffer?.duration ?? 0),
    samples: buffer ? mono(buffer) : null, rate: buffer?.sampleRate ?? 0,
  };
  history = new History();
  keys = new Map();
  $('scrub').max = frames.length - 1;
  frame.problem.clear();
  $('news').textContent = say('opened', { name, n: frames.length, fps });
  $('start').hidden = true;
  $('empty-box').open = false;
  for (const id of ['plots', 'transport', 'edit', 'gesture-box']) $(id).hidden = false;
  plots.open(take);
  fillGroups();
  goTo(0);
}

async function speak() {
  const wish = { text: $('text').value, lang: $('lang').value, seed: 1 };
  const get = async (format) => {
    const answer = await fetch('v1/speech', {
      method: 'POST',
      headers: { 'content-type': 'application/json', ...bearer(frame.access.token) },
      body: JSON.stringify({ ...wish, format }),
    });
    if (!answer.ok) throw await answer.json();
    return answer;
  };
  const [face, audio, times] = await Promise.all([get('fap'), get('wav'), get('json')]);
  const [bytes, heard, json] = [new Uint8Array(await face.arrayBuffer()), await audio.arrayBuffer(), await times.json()];
  const name = wish.text.trim().split(/\s+/).slice(0, 3).join('-').replace(/[^\p{L}\p{N}-]/gu, '') || 'faccia';
  await open({ bytes, name, audio: wholeWav(heard), times: json });
}

/** Opens the last utterance of the page that led here. */
async function openLast() {
  const last = await lastTake();
  if (!last) return frame.tell('nothingSpoken');
  const buffer = last.pcm.length ? context().createBuffer(1, last.pcm.length, last.rate) : null;
  buffer?.copyToChannel(Float32Array.from(last.pcm, (x) => x / 32768), 0);
  edit(last, buffer);
}

async function openFiles(files) {
  const like = (pattern) => [...files].find(({ name }) => pattern.test(name));
  const [face, audio, times, speaker] = [like(FACE), like(/\.(wav|ogg|opus|mp3|flac)$/i), like(/\.json$/i), like(FILM)];
  if (speaker) {
    await film.open(speaker);
    $('film').hidden = $('film-place').hidden = false;
    if (!face && take) show();
  }
  if (!face) return;
  await open({
    bytes: new Uint8Array(await face.arrayBuffer()), name: face.name.replace(FACE, ''),
    audio: audio ? wholeWav(await audio.arrayBuffer()) : null, times: times ? JSON.parse(await times.text()) : null,
  });
}

const attempt = (act) => async (...args) => {
  try {
    await act(...args);
  } catch (error) {
    frame.problem.show({ code: 'bad-fap', ...error, message: error.message });
  }
};

// Time

function goTo(k) {
  if (!take) return;
  now = Math.min(take.frames.length - 1, Math.max(0, k));
  if (sound.source) begin(now / take.fps);
  show();
}

function show(seconds = now / take.fps) {
  const pose = {};
  take.frames[now].forEach((value, n) => n > 2 && value && (pose[n] = value));
  head.pose(pose);
  film.at(seconds, Boolean(sound.source));
  plots.at(seconds);
  $('scrub').value = now;
  $('where').textContent = `${now} (${seconds.toFixed(2)} s)`;
  if (document.activeElement !== $('value')) $('value').value = take.frames[now][number()] ?? 0;
}

function begin(from) {
  sound.source?.node?.stop();
  const source = { node: null };
  sound.source = source;
  context().resume();
  Object.assign(sound, { began: sound.context.currentTime, from });
  if (sound.buffer && from < sound.buffer.duration) {
    source.node = sound.context.createBufferSource();
    source.node.buffer = sound.buffer;
    source.node.connect(sound.context.destination);
    source.node.start(0, from);
  }
  const step = () => {
    if (sound.source !== source) return;
    const heard = sound.from + sound.context.currentTime - sound.began - (sound.context.outputLatency || 0);
    if (heard >= take.duration) {
      if ($('loop').checked) begin(0);
      else stop();
      return;
    }
    now = Math.min(take.frames.length - 1, Math.max(0, Math.floor(heard * take.fps)));
    show(Math.max(0, heard));
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
  showPlay();
}

function stop() {
  sound.source?.node?.stop();
  sound.source = null;
  if (take) film.at(now / take.fps, false);
  showPlay();
}

/** What is drawn over the head; the zone is that of the chosen curve. */
function showAnatomy() {
  const [mesh, points, zone] = ['mesh', 'points', 'zone'].map((id) => $(id).checked);
  anatomy.show({ mesh, points, zone: zone ? number() || 3 : 0 }); // the jaw, before there are curves
}

const showPlay = () => ($('play').textContent = say(sound.source ? 'pause' : 'play'));

// Curves

function fillGroups() {
  const used = (n) => take.frames.some((values) => values[n]);
  const chosen = $('group').value || '2';
  const groups = [...new Set(table.map(({ group }) => group))].filter((group) => group > 1);
  $('group').replaceChildren(...groups.map((group) => new Option(`${group}: ${words[frame.lang].groups[group]}`, group)));
  $('group').value = chosen;
  const list = table.filter(({ group }) => group === Number($('group').value));
  const kept = $('curve').value;
  $('curve').replaceChildren(...list.map(({ number: n, name }) => new Option(`${n} ${name}${used(n) ? '' : ' ·'}`, n)));
  $('curve').value = kept;
  if ($('curve').selectedIndex < 0) $('curve').selectedIndex = 0;
  drawCurves();
  showAnatomy();
}

function keysNow() {
  const n = number();
  if (!keys.has(n)) {
    const values = valuesOf(n);
    keys.set(n, keysOf(values, Math.max(1, NEAR * (Math.max(...values) - Math.min(...values)))));
  }
  return keys.get(n);
}

function drawCurves() {
  if (!take) return;
  const group = Number($('group').value);
  const moves = (n) => n === number() || take.frames.some((values) => values[n]);
  const shown = table.filter((fap) => fap.group === group && moves(fap.number));
  plots.show(shown.map(({ number: n, name }) => ({ number: n, name, values: valuesOf(n) })), number(), take.fps, keysNow());
  const { undo, redo } = history.can;
  $('undo').setAttribute('aria-disabled', String(!undo));
  $('redo').setAttribute('aria-disabled', String(!redo));
}

function put(changes) {
  for (const { number: n, after } of changes) after.forEach((value, k) => (take.frames[k][n] = value));
  drawCurves();
  show();
}

/** Records a changed curve for undo. */
function change(n, after) {
  const { min, max } = fapOf(n);
  const whole = after.map((value) => Math.round(Math.min(max, Math.max(min, value))));
  const changes = [{ number: n, before: valuesOf(n), after: whole }];
  history.add(changes);
  put(changes);
}

/** Interpolates the curve through its keys near one of them; the rest is unchanged. */
function through(places, values, k) {
  const at = places.indexOf(k);
  const near = places.slice(Math.max(0, at - 2), at + 3);
  const piece = spline(near, near.map((place) => values[place]));
  return values.map((value, i) => (i >= near[0] && i <= near.at(-1) ? piece[i - near[0]] : value));
}

function putKey(k, value, from) {
  const values = valuesOf(number());
  const places = keysNow().filter((place) => place !== from || place === 0 || place === values.length - 1);
  values[k] = value;
  const next = [...new Set([...places, k])].sort((a, b) => a - b);
  keys.set(number(), next);
  change(number(), through(next, values, k));
}

function dropKey(k) {
  const places = keysNow();
  const at = places.indexOf(k);
  if (at <= 0 || at === places.length - 1) return;
  const next = places.filter((place) => place !== k);
  keys.set(number(), next);
  const values = valuesOf(number());
  change(number(), through(next, values, next[at - 1]));
}

function reshape(after, n = number()) {
  keys.delete(n);
  change(n, after);
}

function back(changes) {
  if (!changes) return;
  for (const { number: n } of changes) keys.delete(n);
  put(changes);
}

function save() {
  if (!take) return;
  const url = URL.createObjectURL(new Blob([writeFap(take)], { type: 'text/plain' }));
  const link = document.createElement('a');
  Object.assign(link, { href: url, download: `${take.name}.fap` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** Films the take in this page: the server has never seen it. */
async function filmed(told, signal) {
  const { frames, fps, name } = take;
  const { filmTake } = await import('./film-kit.js');
  const look = { head: await frame.access.load(`v1/models/${encodeURIComponent(frame.shown?.model)}`), view: head.view, width: 640, height: 480 };
  const made = await filmTake({ frames, fps, buffer: sound.buffer }, look, told, signal);
  return made && { film: made.blob, name: name + made.suffix };
}

new FilmButton(frame, $('film-make'), $('film-progress'), filmed);
const on = (id, type, act) => $(id).addEventListener(type, (event) => take && act(event));
$('open').addEventListener('submit', (event) => {
  event.preventDefault();
  attempt(speak)();
});
$('empty').addEventListener('submit', (event) => {
  event.preventDefault();
  edit(emptyFaps(Number($('empty-fps').value), Number($('empty-seconds').value)), null);
});
$('files').addEventListener('change', () => attempt(openFiles)($('files').files));
on('play', 'click', () => (sound.source ? stop() : begin(now >= take.frames.length - 1 ? 0 : now / take.fps)));
on('before', 'click', () => goTo(now - 1));
on('after', 'click', () => goTo(now + 1));
on('scrub', 'input', () => goTo(Number($('scrub').value)));
on('group', 'change', fillGroups);
on('curve', 'change', () => {
  drawCurves();
  show();
  showAnatomy();
});
for (const id of ['mesh', 'points', 'zone']) $(id).addEventListener('change', showAnatomy);
on('film-start', 'input', () => show());
on('edit', 'submit', (event) => {
  event.preventDefault();
  putKey(now, Number($('value').value));
});
on('drop', 'click', () => dropKey(keysNow().reduce((best, k) => (Math.abs(k - now) < Math.abs(best - now) ? k : best), Infinity)));
on('smooth', 'click', () => reshape(smooth(valuesOf(number()))));
on('scale', 'click', () => reshape(valuesOf(number()).map((value) => value * Number($('factor').value))));
on('mirror', 'click', () => {
  const other = table.find(({ name }) => name === mirrored(fapOf(number()).name));
  if (other.number !== number()) reshape(valuesOf(number()), other.number);
});
on('copy', 'click', () => (copied = valuesOf(number())));
on('paste', 'click', () => copied && reshape(valuesOf(number()).map((_, k) => copied[Math.min(k, copied.length - 1)])));
on('undo', 'click', () => back(history.undo()));
on('redo', 'click', () => back(history.redo()));
on('save', 'click', save);
document.addEventListener('keydown', (event) => {
  if (!take || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== 'z' || event.target.matches('input[type="text"]')) return;
  event.preventDefault();
  back(event.shiftKey ? history.redo() : history.undo());
});
frame.onTranslate(() => {
  if (Object.values(words).some(({ sample }) => sample === $('text').value) || !$('text').value) $('text').value = say('sample');
  fill($('lang'), FIRST, { page: frame.lang, others: say('otherLanguages'), chosen: $('lang').value || spokenLanguage(navigator.languages, FIRST) });
  showPlay();
  if (take) fillGroups();
});
openGestureForm(() => ({ take, now }), table, frame);
await frame.open();
if (location.hash === '#last') attempt(openLast)();
