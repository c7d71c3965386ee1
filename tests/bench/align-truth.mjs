// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of aligned words and phones on recordings of people whose times are known, and how far their confidence can be trusted.
// FOLDER holds NAME.wav, NAME.txt and NAME.truth.json ({lang, by, split, words: [{text, start, end}], phones: [{label, start, end}]}, seconds), as
// tests/bench/align-truth-people.py prepares them. Errors are of starts and ends of words and of starts of phones that both have; figures are means over persons.
// node tests/bench/run.mjs align-truth FOLDER [--split dev|test] [--only NAME,...] [--program FACCIA] [--by stretch|pocketsphinx] [--each] [--noise DB]
//   [--unsaid]
// --noise: white noise, so far below the recording; --unsaid: every third line of the text is a sentence that nobody says.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { build } from '../lib/daemon.mjs';
import { soundClass } from '../lib/boundaries.mjs';
import { wavOf } from '../lib/wav.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: {
  split: { type: 'string' }, only: { type: 'string' }, program: { type: 'string' }, by: { type: 'string' }, each: { type: 'boolean' }, noise: { type: 'string' }, unsaid: { type: 'boolean' } } });
const source = positionals[0], faccia = values.program ?? path.join(build, 'server/cli/faccia');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const file = (name) => path.join(folder, name);
const letters = (text) => text.toLowerCase().replace(/[^\p{L}\p{N}]/gu, '');

/** Boundaries of words, keyed by how many letters of the text come before them: {starts, ends}. */
function boundaries(words) {
  const starts = new Map(), ends = new Map();
  let at = 0;
  for (const word of words) {
    starts.set(at, word);
    at += letters(word.text).length;
    ends.set(at, word);
  }
  return { starts, ends };
}

/** Pairs phones of the same class in order. */
function phonePairs(known, found) {
  const a = known.map((p) => [soundClass(p.label), p]).filter(([c]) => c), b = found.map((p) => [soundClass(p.ipa), p]).filter(([c]) => c);
  // nearer pairs first: a phone may be missing on either side, but not move by more than a second
  const cost = Array.from({ length: a.length + 1 }, () => new Float64Array(b.length + 1));
  const change = (i, j) => (a[i][0] === b[j][0] ? 0 : 1.2) + Math.min(0.5, 0.1 * Math.abs(a[i][1].start - b[j][1].start));
  for (let i = 0; i <= a.length; i++)
    for (let j = 0; j <= b.length; j++)
      cost[i][j] = !i ? j : !j ? i : Math.min(cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + change(i - 1, j - 1));
  const list = [];
  for (let i = a.length, j = b.length; i && j; ) {
    if (cost[i][j] === cost[i - 1][j - 1] + change(i - 1, j - 1)) {
      if (a[i - 1][0] === b[j - 1][0]) list.push([a[i - 1][1], b[j - 1][1]]);
      i--;
      j--;
    } else if (cost[i][j] === cost[i - 1][j] + 1) i--;
    else j--;
  }
  return list;
}

/** What a reading at an even pace would give: letters spread evenly between the first and the last sound. */
function stretched(name, truth) {
  const all = truth.words.reduce((n, w) => n + letters(w.text).length, 0);
  const from = truth.words[0]?.start ?? 0, to = truth.words.at(-1)?.end ?? 0;
  let at = 0;
  return { phones: [], words: truth.words.map((w) => {
    const start = from + ((to - from) * at) / all;
    at += letters(w.text).length;
    return { ...w, start, end: from + ((to - from) * at) / all, confidence: 1 };
  }) };
}

const MODEL = '/usr/share/pocketsphinx/model/en-us', plainWord = (text) => text.toLowerCase().replace(/[^a-z']/g, '');
let known;
/** Forced alignment by pocketsphinx, of English words that its dictionary has; null if it finds no path. */
function sphinx(name, truth) {
  known ??= new Set(fs.readFileSync(`${MODEL}/cmudict-en-us.dict`, 'utf8').split('\n').map((line) => line.split(' ')[0]));
  if (truth.lang !== 'en') return null;
  const words = truth.words.map(({ text }) => ({ text, plain: plainWord(text) })), said = words.filter(({ plain }) => known.has(plain));
  fs.writeFileSync(file('u.fsg'), [`FSG_BEGIN u`, `NUM_STATES ${said.length + 1}`, 'START_STATE 0', `FINAL_STATE ${said.length}`,
    ...said.map(({ plain }, i) => `TRANSITION ${i} ${i + 1} 1.0 ${plain}`), 'FSG_END', ''].join('\n'));
  fs.writeFileSync(file('ctl'), 'u\n');
  execFileSync('sox', ['-V0', path.join(source, `${name}.wav`), '-t', 'raw', '-e', 'signed', '-b', '16', '-c', '1', '-r', '16000', file('u.raw')]);
  execFileSync('pocketsphinx_batch', ['-hmm', `${MODEL}/en-us`, '-dict', `${MODEL}/cmudict-en-us.dict`, '-ctl', file('ctl'), '-cepdir', folder, '-cepext', '.raw', '-adcin', 'yes',
    '-fsgctl', file('ctl'), '-fsgdir', folder, '-fsgext', '.fsg', '-hypseg', file('seg'), '-beam', '1e-100', '-wbeam', '1e-80', '-pbeam', '1e-100', '-remove_silence', 'no'], { stdio: 'ignore' });
  const line = fs.readFileSync(file('seg'), 'utf8').trim().replace(/^.* L -?\d+ /, '');
  const segments = [...line.matchAll(/(\d+) -?\d+ -?\d+ (\S+)(?= )/g)].map(([, frame, word]) => [frame / 100, word.replace(/\(\d+\)$/, '')]);
  const last = Number(line.split(' ').at(-1)) / 100;
  const found = segments.map(([start, word], i) => ({ word, start, end: segments[i + 1]?.[0] ?? last })).filter(({ word }) => !/^[<[+]/.test(word));
  if (found.length !== said.length) return null;
  let i = 0;
  return { phones: [], words: words.map(({ text, plain }) => (known.has(plain) ? { text, ...found[i++], confidence: 1 } : { text, start: 0, end: 0, confidence: 0 })) };
}

const others = { stretch: stretched, pocketsphinx: sphinx };

const OTHERS = {
  en: ['The ship sailed slowly out of the harbour before dawn.', 'Nobody had told the captain about the storm in the north.', 'Seven barrels of salted fish were left behind on the pier.',
    'Please leave your umbrella beside the kitchen door.', 'Our neighbours painted their wooden fence bright yellow.'],
};

/** The sound with white noise: 16 bits, one channel. */
function noisy(sound) {
  const data = fs.readFileSync(sound), at = data.indexOf('data') + 8;
  const pcm = new Int16Array(data.buffer.slice(data.byteOffset + at, data.byteOffset + data.length - ((data.length - at) % 2)));
  const level = Math.sqrt(pcm.reduce((sum, x) => sum + x * x, 0) / pcm.length) * 10 ** (-Number(values.noise) / 20);
  let state = 3;
  fs.writeFileSync(file('noisy.wav'), wavOf(pcm.map((x) => {
    state = (Math.imul(state, 1664525) + 1013904223) | 0;
    return Math.max(-32768, Math.min(32767, x + (state / 2 ** 31) * level * Math.sqrt(3)));
  }), data.readUInt32LE(24)));
  return file('noisy.wav');
}

/** By `faccia align`; null if it refuses. Words of lines that are not said come as `unsaid`. */
function aligned(name, truth) {
  const lines = fs.readFileSync(path.join(source, `${name}.txt`), 'utf8').trim().split('\n'), sound = path.join(source, `${name}.wav`);
  const other = (i) => (values.unsaid && i % 3 === 1 && lines.length > 3 ? OTHERS[truth.lang]?.[i % 5] : undefined);
  const written = lines.map((line, i) => other(i) ?? line);
  fs.writeFileSync(file('x.txt'), written.join('\n'));
  try {
    execFileSync(faccia, ['align', '-q', values.noise ? noisy(sound) : sound, '--text', file('x.txt'), '-l', truth.lang, '--json', file('x.json')], { stdio: 'pipe' });
  } catch {
    return null;
  }
  const found = JSON.parse(fs.readFileSync(file('x.json'))), words = [], unsaid = [];
  let from = 0;
  lines.forEach((line, i) => {
    const to = from + Buffer.byteLength(written[i]), own = found.words.filter((w) => w.byte_start >= from && w.byte_start < to);
    if (other(i)) {
      unsaid.push(...own);
      words.push({ text: line, start: 0, end: 0, confidence: 0 });
    } else words.push(...own);
    from = to + 1;
  });
  return { ...found, words, unsaid };
}

const quantile = (sorted, q) => sorted[Math.min(sorted.length - 1, Math.floor(sorted.length * q))];
function figures(errors) {
  const sorted = errors.map((x) => Math.abs(x) * 1000).sort((x, y) => x - y), n = sorted.length;
  const within = (ms) => sorted.filter((x) => x <= ms).length / n;
  return n ? { n, median: quantile(sorted, 0.5), mean: sorted.reduce((s, x) => s + x, 0) / n, p90: quantile(sorted, 0.9), worst: sorted[n - 1], in20: within(20), in50: within(50), in100: within(100) } : null;
}
const shown = (name, f) => `${name.padEnd(16)} ${f ? [String(f.n).padStart(5), ...['median', 'mean', 'p90', 'worst'].map((k) => f[k].toFixed(0).padStart(7)), ...['in20', 'in50', 'in100'].map((k) => (100 * f[k]).toFixed(1).padStart(6))].join(' ') : '    -'}`;
const means = (list) => {
  const given = list.filter(Boolean);
  return given.length ? Object.fromEntries(Object.keys(given[0]).map((k) => [k, k === 'n' ? given.reduce((s, f) => s + f.n, 0) : k === 'worst' ? Math.max(...given.map((f) => f.worst)) : given.reduce((s, f) => s + f[k], 0) / given.length])) : null;
};

const persons = new Map(), judged = [];
let seconds = 0;
for (const name of fs.readdirSync(source).filter((n) => n.endsWith('.truth.json')).map((n) => n.slice(0, -11)).sort()) {
  const truth = JSON.parse(fs.readFileSync(path.join(source, `${name}.truth.json`)));
  if ((values.split && truth.split !== values.split) || (values.only && !values.only.split(',').includes(name))) continue;
  const began = process.hrtime.bigint(), found = (others[values.by] ?? aligned)(name, truth);
  seconds += Number(process.hrtime.bigint() - began) / 1e9;
  const person = truth.person ?? name, kept = persons.get(person) ?? { words: [], phones: [], refused: 0 };
  persons.set(person, kept);
  if (!found) {
    kept.refused++;
    continue;
  }
  const known = found.words.filter((w) => w.end > w.start), own = boundaries(truth.words), other = boundaries(found.words);
  const gone = found.words.length - known.length;
  for (const side of ['starts', 'ends'])
    for (const [at, word] of own[side]) {
      const match = other[side].get(at);
      if (match && match.end > match.start) kept.words.push(side === 'starts' ? match.start - word.start : match.end - word.end);
    }
  for (const [at, word] of own.starts) {
    const match = other.starts.get(at);
    if (match && match.end > match.start) judged.push({ name, text: word.text, off: Math.abs(match.start - word.start), confidence: match.confidence });
  }
  for (const word of (found.unsaid ?? []).filter((w) => w.end > w.start)) judged.push({ name, text: word.text, off: Infinity, confidence: word.confidence });
  kept.gone = (kept.gone ?? 0) + gone;
  kept.phones.push(...phonePairs(truth.phones, found.phones).map(([a, b]) => b.start - a.start));
}
console.log(`                     n  median    mean    90 %   worst   20ms   50ms  100ms   (ms; %)`);
for (const kind of ['words', 'phones']) {
  if (values.each) for (const [person, kept] of persons) if (kept[kind].length) console.log(shown(`${kind} ${person}`, figures(kept[kind])));
  console.log(shown(`${kind}, mean`, means([...persons.values()].map((kept) => figures(kept[kind])))));
}
const lost = [...persons].filter(([, kept]) => kept.refused || kept.gone);
if (lost.length) console.log(`not found: ${lost.map(([person, kept]) => `${person} ${kept.refused ? `${kept.refused} recordings` : `${kept.gone} words`}`).join(', ')}`);
for (const [from, to] of [[0, 0.2], [0.2, 0.4], [0.4, 0.6], [0.6, 0.8], [0.8, 0.9], [0.9, 1.01]]) {
  const these = judged.filter((w) => w.confidence >= from && w.confidence < to);
  if (these.length) console.log(`confidence ${from.toFixed(1)} to ${Math.min(1, to).toFixed(1)}: ${String(these.length).padStart(4)} words, ${((100 * these.filter((w) => w.off <= 0.1).length) / these.length).toFixed(1)} % of their starts within 100 ms`);
}
const sure = judged.filter((w) => w.confidence >= 0.8);
console.log(`confidence >= 0.8: ${sure.length} of ${judged.length} words, ${((100 * sure.filter((w) => w.off <= 0.1).length) / (sure.length || 1)).toFixed(1)} % within 100 ms`);
const unsaid = judged.filter((w) => w.off === Infinity);
if (values.unsaid) console.log(`of words that are not said ${unsaid.length} were placed, ${unsaid.filter((w) => w.confidence >= 0.5).length} with a confidence of 0.5 or more`);
if (process.env.VERBOSE) for (const w of judged.filter((x) => x.off > 0.1)) console.log(`  ${w.name} ${w.text}: ${w.off.toFixed(2)} s, confidence ${w.confidence}`);
console.log(`${seconds.toFixed(1)} s`);
fs.rmSync(folder, { recursive: true });
