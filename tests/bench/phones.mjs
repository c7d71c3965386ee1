// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of the voices' phone times against the sound, and the table that corrects them (models/boundaries.md).
// Usage: node tests/bench/run.mjs phones [--write FILE] [--lang TAG] [--text FILE] [VOICE]...
// The sentences are those of the voice's language, or of --lang, or the lines of --text: any voice that `faccia say --voice` speaks with can be measured, also
// one of a configuration (FACCIA_CONFIG).
// By voice and event: median of a boundary's time minus that of its spectral event, ms (positive: the boundary is late), ± half-width that contains half of
// them; mean absolute error (count) of the voice. Below it, if a correction is useful, the error after cross-validated correction: each half of the sentences
// (every other one) is corrected by the other half. --write FILE: writes the table learned from all sentences, where it holds in cross-validation; the file
// keeps entries of voices that are not named.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { build, root } from '../lib/daemon.mjs';
import { sentences } from '../lib/sentences.mjs';
import { median } from './figures.mjs';

const { values: wanted, positionals } = parseArgs({ allowPositionals: true, options: { write: { type: 'string' }, lang: { type: 'string' }, text: { type: 'string' } } });
const VOICES = ['it', 'pt-br', 'pt', 'tr', 'en-us', 'en-gb'].flatMap((lang) => [`espeak:${lang}`, `espeak:${lang}+f2`]).concat(['lp', 'pc', 'slt', 'kal'].map((name) => `festival:${name}`));
const STEP = 0.001; // s
const NEAR = 0.06; // s: an event farther away belongs to another boundary
const LEAST = 6, ENOUGH = 8; // ms, number of boundaries: omits smaller corrections, those from fewer boundaries,
const WORTH = 0.9; // and those that leave more than this share of the error in cross-validation

// First and last letters of phones by class; the table uses the same names.
const { sounds } = JSON.parse(fs.readFileSync(path.join(root, 'models/boundaries.json')));

// Spectral events of boundaries: sounds before and after, frequency band in Hz, and whether it rises or falls. `lead`, s: the event precedes the boundary
// by this, because the packs release the lips before a stop's end (contact.release of /p/ and /b/). `seen`: only reported, not corrected.
const EVENTS = {
  'hiss begins': { before: 'vowel', after: 'sibilant', band: [3500, 7500], sign: 1 },
  'f begins': { before: 'vowel', after: 'f', band: [3500, 7500], sign: 1 },
  'hiss ends': { before: 'hiss', after: 'vowel', band: [3500, 7500], sign: -1 },
  'voice after hiss': { before: 'hiss', after: 'vowel', band: [100, 900], sign: 1, seen: true },
  'closure': { before: 'vowel', after: 'voiceless stop', band: [100, 3500], sign: -1 },
  'voiced closure': { before: 'vowel', after: 'voiced stop', band: [900, 3500], sign: -1 },
  'nasal begins': { before: 'vowel', after: 'nasal', band: [900, 3000], sign: -1 },
  'nasal ends': { before: 'nasal', after: 'vowel', band: [900, 3000], sign: 1 },
  'p lets go': { before: 'p', after: 'vowel', band: [200, 7500], sign: 1, lead: 0.03 },
  'b lets go': { before: 'b', after: 'vowel', band: [900, 7500], sign: 1, lead: 0.012 },
};

/** First or last letter of a phone, without diacritics. */
const letter = (ipa, last) => [...ipa.normalize('NFC').replace(/[\u02b0-\u036f\u1dc0-\u1dff]/gu, '')].at(last ? -1 : 0);
const fits = ({ before, after }, [a, b]) => a.ipa && b.ipa && sounds[before].includes(letter(a.ipa, true)) && sounds[after].includes(letter(b.ipa, false));

/** Energy of a band in dB every STEP: two-pole filters on both sides, squared, smoothed over 4 ms. */
function band(pcm, rate, [low, high]) {
  const pass = (input, hz, kind) => {
    const w = (2 * Math.PI * Math.min(hz, 0.45 * rate)) / rate, alpha = Math.sin(w) / Math.SQRT2, cos = Math.cos(w);
    const b = kind === 'high' ? [(1 + cos) / 2, -(1 + cos), (1 + cos) / 2] : [(1 - cos) / 2, 1 - cos, (1 - cos) / 2];
    const out = new Float64Array(input.length);
    for (let i = 2; i < input.length; i++)
      out[i] = (b[0] * input[i] + b[1] * input[i - 1] + b[2] * input[i - 2] + 2 * cos * out[i - 1] - (1 - alpha) * out[i - 2]) / (1 + alpha);
    return out;
  };
  const twoWays = (input, hz, kind) => pass(pass(input, hz, kind).reverse(), hz, kind).reverse(); // zero phase
  const filtered = twoWays(twoWays(pcm, low, 'high'), high, 'low');
  const sums = new Float64Array(filtered.length + 1);
  filtered.forEach((x, i) => (sums[i + 1] = sums[i] + x * x));
  const half = Math.round(0.002 * rate);
  return Float64Array.from({ length: Math.floor(pcm.length / rate / STEP) }, (_, k) => {
    const at = Math.round(k * STEP * rate), from = Math.max(0, at - half), to = Math.min(filtered.length, at + half + 1);
    return 10 * Math.log10((sums[to] - sums[from]) / (to - from) + 1);
  });
}

/**
 * Time of the largest change of the band within 10 ms between the two times, s; undefined if there is hardly any. `first`: the first change that
 * is audible beside the vowel, because a burst may be weaker than the vowel.
 */
function steepest(levels, from, to, sign, first) {
  const side = 5;
  let best = 6, at; // minimum, dB
  const audible = first ? Math.max(...levels.subarray(Math.round(from / STEP), Math.round((to + NEAR) / STEP))) - 40 : -Infinity;
  for (let k = Math.max(side, Math.round(from / STEP)); k <= Math.min(levels.length - 1 - side, Math.round(to / STEP)); k++) {
    if (first && at !== undefined && k * STEP > at + 0.006) break;
    const change = sign * (levels[k + side] - levels[k - side]);
    if (change > best && levels[k + side] > audible) [best, at] = [change, k * STEP];
  }
  return at;
}

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'phones-'));
process.on('exit', () => fs.rmSync(folder, { recursive: true }));

const own = wanted.text && fs.readFileSync(wanted.text, 'utf8').split('\n').map((line) => line.trim()).filter(Boolean);
const speaks = new Map(execFileSync(path.join(build, 'server/cli/faccia'), ['voices'], { stdio: ['ignore', 'pipe', 'inherit'] }).toString().split('\n').map((line) => line.split(/\s+/)));

/** Sentences of a language, also those of another region of it. */
function linesOf(lang) {
  const known = Object.keys(sentences).find((tag) => tag.split('-')[0] === lang.split('-')[0]);
  if (!own && !known) throw new Error(`there are no sentences in ${lang}: --text FILE, one a line, at least 25`);
  return own ?? sentences[known];
}

/** Speaks every other sentence, from `half` on. Returns phones and sound. */
function say(voice, lang, half, table) {
  const [wav, json, models] = ['a.wav', 'a.json', 'models'].map((name) => path.join(folder, name));
  fs.rmSync(models, { recursive: true, force: true });
  fs.mkdirSync(models);
  for (const name of ['speech', 'normalization', 'expressions.json']) fs.symlinkSync(path.join(root, 'models', name), path.join(models, name));
  if (table) fs.writeFileSync(path.join(models, 'boundaries.json'), JSON.stringify({ sounds, voices: { [voice]: table } }));
  const text = linesOf(lang).filter((_, i) => i % 2 === half).join('\n');
  execFileSync(path.join(build, 'server/cli/faccia'), ['say', '--voice', voice, '--lang', lang, '--wav', wav, '--json', json, text],
    { stdio: ['ignore', 'ignore', 'inherit'], env: { ...process.env, FACCIA_MODELS: models } });
  const bytes = fs.readFileSync(wav), rate = bytes.readUInt32LE(24);
  return { phones: JSON.parse(fs.readFileSync(json)).phones, rate, pcm: Float64Array.from({ length: (bytes.length - 44) >> 1 }, (_, i) => bytes.readInt16LE(44 + 2 * i)) };
}

/** By event: indices of the phones that begin there, and times of the event in the sound. */
function heard({ phones, rate, pcm }) {
  const levels = new Map();
  const levelsOf = (hz) => levels.get(String(hz)) ?? levels.set(String(hz), band(pcm, rate, hz)).get(String(hz));
  return Object.fromEntries(Object.entries(EVENTS).map(([name, event]) => {
    const found = [];
    for (let i = 1; i < phones.length; i++) {
      const [before, after] = [phones[i - 1], phones[i]];
      if (!fits(event, [before, after]) || /ː/.test(before.ipa + after.ipa)) continue;
      // A burst lies within the stop; other events are searched between the middles of the two sounds.
      const from = event.lead ? before.start + (before.end - before.start) / 4 : Math.max((before.start + before.end) / 2, after.start - NEAR);
      const to = event.lead ? after.start + 0.01 : Math.min((after.start + after.end) / 2, after.start + NEAR);
      const at = steepest(levelsOf(event.band), from, to, event.sign, event.lead);
      if (at !== undefined) found.push({ i, at: at + (event.lead ?? 0) });
    }
    return [name, found];
  }));
}

const off = (phones, found) => found.map(({ i, at }) => 1000 * (phones[i].start - at));
const told = (values) => {
  const middle = median(values);
  return `${middle.toFixed(0)} ±${median(values.map((x) => Math.abs(x - middle))).toFixed(0)}`;
};
const mean = (values) => values.reduce((sum, x) => sum + Math.abs(x), 0) / values.length;

/** Corrections of the boundaries of each event. */
function learned(events, names) {
  return names.map((name) => ({ before: EVENTS[name].before, after: EVENTS[name].after, ms: -Math.round(median(events[name])) }));
}

function measure(voice, lang) {
  const halves = [0, 1].map((half) => {
    const own = say(voice, lang, half), events = heard(own);
    return { half, events, values: Object.fromEntries(Object.entries(events).map(([name, found]) => [name, off(own.phones, found)])) };
  });
  const all = Object.fromEntries(Object.keys(EVENTS).map((name) => [name, halves.flatMap(({ values }) => values[name])]));
  const candidates = Object.keys(EVENTS).filter((name) => !EVENTS[name].seen && all[name].length >= ENOUGH && halves.every(({ values }) => values[name].length));
  /** Cross-validation: each half corrected by what the other one gives. */
  const crossed = (names) => {
    const moved = halves.map(({ half, events }, k) => {
      const { phones } = say(voice, lang, half, learned(halves[1 - k].values, names));
      return Object.fromEntries(Object.entries(events).map(([name, found]) => [name, off(phones, found)]));
    });
    return Object.fromEntries(Object.keys(EVENTS).map((name) => [name, moved.flatMap((values) => values[name])]));
  };
  const tried = crossed(candidates.filter((name) => Math.abs(median(all[name])) >= LEAST));
  const good = candidates.filter((name) => Math.abs(median(all[name])) >= LEAST && mean(tried[name]) < WORTH * mean(all[name]));
  return { table: learned(all, good), good, all, unseen: crossed(good) };
}

function langOf(voice) {
  const lang = wanted.lang ?? speaks.get(voice);
  if (!lang) throw new Error(`no voice '${voice}': see faccia voices`);
  return lang;
}

const shown = (row, moved) => (row.length < 5 ? '' : `${told(row)}; ${mean(row).toFixed(0)}${moved ? '' : ` (${row.length})`}`);
const names = Object.keys(EVENTS);
console.log(`| voice | ${names.join(' | ')} |\n|---|${names.map(() => '---|').join('')}`);
const tables = {};
for (const voice of positionals.length ? positionals : VOICES) {
  const { table, good, all, unseen } = measure(voice, langOf(voice));
  console.log(`| ${voice} | ${names.map((name) => shown(all[name])).join(' | ')} |`);
  if (good.length) console.log(`| moved | ${names.map((name) => (good.includes(name) || EVENTS[name].seen ? shown(unseen[name], true) : '')).join(' | ')} |`);
  tables[voice] = table.length ? table : undefined;
}
if (wanted.write) {
  const old = JSON.parse(fs.readFileSync(wanted.write)).voices;
  const voices = Object.fromEntries(Object.entries({ ...old, ...tables }).filter(([, table]) => table).sort(([a], [b]) => (a < b ? -1 : 1)));
  const rows = Object.entries(voices).map(([voice, rules]) => `  ${JSON.stringify(voice)}: [\n${rules.map((rule) => `   { "before": ${JSON.stringify(rule.before)}, "after": ${JSON.stringify(rule.after)}, "ms": ${rule.ms} }`).join(',\n')}\n  ]`);
  const letters = Object.entries(sounds).map(([name, all]) => `  ${JSON.stringify(name)}: ${JSON.stringify(all)}`);
  fs.writeFileSync(wanted.write, `{\n "sounds": {\n${letters.join(',\n')}\n },\n "voices": {\n${rows.join(',\n')}\n }\n}\n`);
}
