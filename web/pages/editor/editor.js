// SPDX-License-Identifier: MIT
// The markup editor: select words, choose and hear their effect; writes APML, JSML and SSML.
import { KINDS, POINTS, moved, sentenceAt, wholeWords, withMark, within } from './marks.js';
import { read, write } from './markup.js';
import { editor as words, emotion } from '../texts/index.js';
import { bearer } from '../shared/bearer.js';
import { Frame } from '../shared/frame.js';
import { DocumentStore } from '../shared/document-store.js';
import { fill, FIRST, primary, spokenLanguage } from '../shared/languages.js';
import { placeIn, placeOf } from '../shared/problem.js';
import { Sayings } from '../shared/sayings.js';

const $ = (id) => document.getElementById(id);
const CHECK_MS = 400; // after the last change

const frame = new Frame(words);
const { head, say } = frame;
const [text, code] = ['text', 'code'].map($);
const offer = { affect: [], gesture: [], voices: [] };
let marks = [];
let missing = ''; // what the markup cannot express, in words
let before = '';
let name = 'faccia';
let checking = null; // the request under way
let timer = 0;

const valuesOf = {
  affect: () => offer.affect.map((each) => [each, emotion[frame.lang].affects[each] ?? each]),
  gesture: () => offer.gesture.map((each) => [each, each]),
  voice: () => offer.voices.filter(({ lang }) => primary(lang) === primary($('lang').value)).map((voice) => [voice.id, voice.name]),
  emphasis: () => ['strong', 'moderate', 'reduced'].map((each) => [each, say(each)]),
  gaze: () => ['left', 'right', 'up', 'down'].map((each) => [each, say(each)]),
  pause: () => [150, 300, 500, 1000, 2000].map((each) => [each, `${each} ms`]),
};
const kinds = ['affect', 'emphasis', 'pause', 'voice', 'gaze', 'gesture'];
const nameOf = ({ kind, value }) => (valuesOf[kind]().find(([each]) => String(each) === String(value)) ?? [value, value])[1];
const called = (mark) => `${say(mark.kind)} ${nameOf(mark)}`;

// The text and its marks

/** Shows the marks in the text: underlines ranges, frames point marks. */
function showMarked() {
  const cuts = [...new Set([0, text.value.length, ...marks.flatMap(({ from, to }) => [from, to])])].sort((a, b) => a - b);
  const out = [];
  const pointsAt = (at) =>
    marks.filter((mark) => POINTS.includes(mark.kind) && mark.from === at).map((mark) => Object.assign(document.createElement('span'), { className: 'point', textContent: called(mark) }));
  cuts.forEach((cut, i) => {
    out.push(...pointsAt(cut));
    const next = cuts[i + 1];
    if (next === undefined) return;
    let piece = document.createTextNode(text.value.slice(cut, next));
    for (const kind of KINDS.toReversed()) {
      const mark = marks.find((each) => each.kind === kind && each.from <= cut && each.to >= next);
      if (!mark) continue;
      const span = Object.assign(document.createElement('span'), { className: 'mark', title: called(mark) });
      span.dataset.kind = kind;
      span.append(piece);
      piece = span;
    }
    out.push(piece);
  });
  $('marked').replaceChildren(...out);
}

function item(mark) {
  const button = document.createElement('button');
  const stretch = text.value.slice(mark.from, mark.to || mark.from);
  button.type = 'button';
  button.textContent = stretch ? `${called(mark)}: ${stretch} ✕` : `${called(mark)} ✕`;
  button.ariaLabel = say('remove', { kind: say(mark.kind), value: nameOf(mark), words: stretch });
  button.addEventListener('click', () => {
    const at = marks.indexOf(mark);
    marks = marks.filter((each) => each !== mark);
    show();
    ($('marks').querySelectorAll('button')[Math.min(at, marks.length - 1)] ?? text).focus();
  });
  const li = document.createElement('li');
  li.append(button);
  return li;
}

function show() {
  showMarked();
  $('marks').replaceChildren(...marks.map(item));
  $('marks-title').hidden = !marks.length;
  const markup = $('markup').value;
  const { code: written, unsaid } = write(markup, text.value, marks, $('lang').value);
  code.value = written;
  missing = unsaid.length ? say('unsaid', { markup: markup.toUpperCase(), what: [...new Set(unsaid.map(called))].join(', ') }) : '';
  $('verdict').textContent = missing;
  $('warnings').replaceChildren();
  clearTimeout(timer);
  checking?.abort(); // its answer would be about what was written before
  if (text.value.trim()) timer = setTimeout(check, CHECK_MS);
}

// Messages of the server

/** A warning of a speech begins with its place: "1:27: no gesture..." */
function placed(warning) {
  const [, line, column, message] = /^(\d+):(\d+): ([^]*)$/.exec(warning.message) ?? [];
  return line ? { ...warning, line: Number(line), column: Number(column), message } : warning;
}

function warningItem(warning) {
  const button = document.createElement('button');
  button.type = 'button';
  button.textContent = `${placeOf(warning, say)} ${warning.message}`;
  button.addEventListener('click', () => {
    const at = placeIn(code.value, warning.line ?? 1, warning.column ?? 1);
    const end = code.value.indexOf('>', at);
    code.focus();
    code.setSelectionRange(at, end < 0 ? at + 1 : end + 1);
  });
  const li = document.createElement('li');
  li.append(button);
  return li;
}

/** Has the server speak the text, and shows its warnings about ignored markup. */
async function check() {
  checking?.abort();
  const mine = (checking = new AbortController());
  try {
    const answer = await fetch('v1/speech', {
      method: 'POST',
      signal: mine.signal,
      headers: { 'content-type': 'application/json', ...bearer(frame.access.token) },
      body: JSON.stringify({ text: code.value, markup: $('markup').value, lang: $('lang').value, format: 'json' }),
    });
    const said = await answer.json();
    if (mine.signal.aborted) return;
    const warnings = answer.ok ? (said.warnings ?? []).map(placed) : [said];
    const verdict = warnings.length ? say('warned', { n: warnings.length }) : say('good');
    $('verdict').textContent = [missing, verdict].filter(Boolean).join(' ');
    $('warnings').replaceChildren(...warnings.map(warningItem));
  } catch (error) {
    if (error.name !== 'AbortError') frame.problem.show({ code: 'unreachable', message: error.message });
  }
}

function hear(from, to) {
  const piece = text.value.slice(from, to);
  if (!piece.trim()) return;
  head.stop();
  frame.problem.clear();
  const { code: spoken } = write('ssml', piece, within(marks, from, to), $('lang').value); // it can say the most
  head.speak(spoken, { markup: 'ssml', lang: $('lang').value });
}

function hearSelection() {
  const { selectionStart: from, selectionEnd: to, value } = text;
  if (from < to) hear(from, to);
  else hear(0, value.length);
}

function put(event) {
  event.preventDefault();
  const kind = $('kind').value;
  const [from, to] = wholeWords(text.value, text.selectionStart, text.selectionEnd);
  if (from === to && !POINTS.includes(kind)) {
    frame.tell('nothing');
    text.focus();
    return;
  }
  frame.tell('');
  const value = kind === 'pause' ? Number($('value').value) : $('value').value;
  marks = withMark(marks, { kind, value, from, to });
  show();
  text.setSelectionRange(from, to);
  if ($('at-once').checked) hear(...sentenceAt(text.value, from, to));
}

// Files

function save() {
  const markup = $('markup').value;
  const url = URL.createObjectURL(new Blob([code.value], { type: `application/${markup}+xml` }));
  Object.assign(document.createElement('a'), { href: url, download: `${name}.${markup}` }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

const works = new DocumentStore('v1/library/files', frame.access);

/** Suggests the works that can be opened here. */
async function showWorks() {
  const names = ((await works.list()) ?? []).map(({ name }) => name);
  $('work-names').replaceChildren(...names.filter((each) => /\.(apml|jsml|ssml)$/.test(each)).map((each) => new Option(each, each)));
}

/** @param {string} file name entered or selected @returns {string} the name with the extension of a markup */
const workFile = (file) => (/\.(apml|jsml|ssml)$/.test(file) ? file : `${file}.${$('markup').value}`);

async function saveWork(event) {
  event.preventDefault();
  frame.problem.clear();
  const file = workFile($('work-name').value);
  $('markup').value = file.slice(-4);
  show();
  try {
    await works.save(file, code.value);
    $('work-name').value = file;
    $('news').textContent = say('workSaved', { file });
    await showWorks();
  } catch (error) {
    frame.problem.show(error);
  }
}

async function openWork() {
  const file = workFile($('work-name').value);
  frame.problem.clear();
  try {
    openText(await works.read(file), file);
    $('markup').value = file.slice(-4);
    show();
  } catch (error) {
    frame.problem.show(error);
  }
}

async function openFile([file]) {
  if (file) openText(await file.text(), file.name);
}

function openText(content, file) {
  const found = read(content);
  name = file.replace(/\.\w+$/, '');
  if (FIRST.includes(found.lang)) $('lang').value = found.lang;
  text.value = before = found.text;
  marks = found.marks.filter(({ kind }) => kinds.includes(kind));
  $('news').textContent = found.lost.length ? say('lost', { what: found.lost.join(', ') }) : '';
  fillValues();
  show();
}

const sayings = new Sayings(frame, $('sayings'), {
  selected() {
    if (text.selectionStart === text.selectionEnd) return null;
    const [from, to] = wholeWords(text.value, text.selectionStart, text.selectionEnd);
    return { word: text.value.slice(from, to), lang: $('lang').value, context: text.value.slice(...sentenceAt(text.value, from, to)) };
  },
  lang: () => $('lang').value,
  file: () => $('work-name').value || name,
  quiet: () => head.stop(),
});

// The form

function fillValues() {
  const chosen = $('value').value;
  $('value').replaceChildren(...valuesOf[$('kind').value]().map(([value, label]) => new Option(label, value)));
  $('value').value = chosen;
  if ($('value').selectedIndex < 0) $('value').selectedIndex = 0;
}

text.addEventListener('input', () => {
  marks = moved(marks, before, text.value);
  before = text.value;
  show();
});
$('mark').addEventListener('submit', put);
$('kind').addEventListener('change', fillValues);
$('lang').addEventListener('change', () => {
  text.lang = $('lang').value;
  fillValues();
  show();
});
$('markup').addEventListener('change', show);
$('hear').addEventListener('click', hearSelection);
$('hear-all').addEventListener('click', () => hear(0, text.value.length));
$('stop').addEventListener('click', () => head.stop());
$('save').addEventListener('click', save);
$('works').addEventListener('submit', saveWork);
$('work-open').addEventListener('click', openWork);
$('work-name').addEventListener('focus', showWorks, { once: true });
$('work-name').addEventListener('change', () => sayings.showPlaces());
$('file').addEventListener('change', () => openFile($('file').files));
document.addEventListener('keydown', (event) => {
  if (event.key === 'Escape') head.stop();
  if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) hearSelection();
});
frame.onTranslate(() => {
  const chosen = $('kind').value;
  $('kind').replaceChildren(...kinds.map((kind) => new Option(say(kind), kind)));
  $('kind').value = chosen || 'affect';
  fill($('lang'), FIRST, { page: frame.lang, others: say('otherLanguages'), chosen: $('lang').value || spokenLanguage(navigator.languages, FIRST) });
  if (!text.value || Object.values(words).some(({ sample }) => sample === text.value)) text.value = before = words[primary($('lang').value)]?.sample ?? '';
  text.lang = $('lang').value;
  fillValues();
  show();
});

await frame.open();
const [expressions, voices] = await Promise.all([frame.load('v1/expressions'), frame.load('v1/voices')]);
const named = (kind) => (expressions?.expressions ?? []).filter((each) => each.kind === kind).map((each) => each.name);
Object.assign(offer, { affect: named('affect'), gesture: [...new Set([...named('gesture'), ...named('signal')])], voices: voices?.voices ?? [] });
fillValues();
show();
