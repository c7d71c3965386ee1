// SPDX-License-Identifier: GPL-3.0-or-later
// How the phones' times of the voices lie beside what is heard: the median of a boundary's time less that of its event in the spectrum, ms
// (positive: the phone's time is late), and how far half of them lie from that. Usage: node tests/bench/phones.mjs [VOICE]...
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build } from '../lib/daemon.mjs';
import { sentences } from '../lib/sentences.mjs';
import { median } from './figures.mjs';

const VOICES = ['espeak:it', 'espeak:it+f2', 'espeak:pt-br', 'espeak:tr', 'espeak:en-us', 'festival:lp', 'festival:pc', 'festival:slt', 'festival:kal'];
const SHOWN = 0.06; // s: an event farther from its boundary is another's
const STEP = 0.001; // s

const FRICATIVES = /^[sʃfθ]/u, STOPS = /^(?!tʃ|ts)[ptkc]/u, NASALS = /^[mnɲŋ]/u, VOWELS = /^[aeiouyɐɑæʌɛɔəɪʊøœɯɨɜ]/u;

// What is looked for at a boundary: the sounds before and after it, the band that tells, Hz, and whether it rises or falls there.
const EVENTS = {
  'hiss begins': [VOWELS, FRICATIVES, [3500, 7500], 1],
  'hiss ends': [FRICATIVES, VOWELS, [3500, 7500], -1],
  'voice after hiss': [FRICATIVES, VOWELS, [100, 900], 1],
  'closure': [VOWELS, STOPS, [100, 3500], -1],
  'voice after stop': [STOPS, VOWELS, [100, 900], 1],
  'nasal begins': [VOWELS, NASALS, [900, 3000], -1],
  'nasal ends': [NASALS, VOWELS, [900, 3000], 1],
};
// A stop's burst lies within it, not at its end: how long before the end is shown apart.
const BURST = [STOPS, VOWELS, [1500, 7500], 1];

/** A band's energy in dB, a value each STEP: two poles on either side, squared, smoothed over 4 ms. */
function band(pcm, rate, [low, high]) {
  const pass = (input, hz, kind) => {
    const w = (2 * Math.PI * Math.min(hz, 0.45 * rate)) / rate, alpha = Math.sin(w) / Math.SQRT2, cos = Math.cos(w);
    const b = kind === 'high' ? [(1 + cos) / 2, -(1 + cos), (1 + cos) / 2] : [(1 - cos) / 2, 1 - cos, (1 - cos) / 2];
    const out = new Float64Array(input.length);
    for (let i = 2; i < input.length; i++)
      out[i] = (b[0] * input[i] + b[1] * input[i - 1] + b[2] * input[i - 2] + 2 * cos * out[i - 1] - (1 - alpha) * out[i - 2]) / (1 + alpha);
    return out;
  };
  const twoWays = (input, hz, kind) => pass(pass(input, hz, kind).reverse(), hz, kind).reverse(); // no delay
  const filtered = twoWays(twoWays(pcm, low, 'high'), high, 'low');
  const sums = new Float64Array(filtered.length + 1);
  filtered.forEach((x, i) => (sums[i + 1] = sums[i] + x * x));
  const half = Math.round(0.002 * rate);
  return Float64Array.from({ length: Math.floor(pcm.length / rate / STEP) }, (_, k) => {
    const at = Math.round(k * STEP * rate), from = Math.max(0, at - half), to = Math.min(filtered.length, at + half + 1);
    return 10 * Math.log10((sums[to] - sums[from]) / (to - from) + 1);
  });
}

/** Where the band changes most within 10 ms, between the two times, s; undefined when it hardly does. */
function steepest(levels, from, to, sign) {
  const side = 5;
  let best = 6, at; // dB at least
  for (let k = Math.max(side, Math.round(from / STEP)); k <= Math.min(levels.length - 1 - side, Math.round(to / STEP)); k++) {
    const change = sign * (levels[k + side] - levels[k - side]);
    if (change > best) [best, at] = [change, k * STEP];
  }
  return at;
}

function measure(voice, lang) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'phones-'));
  const [wav, json] = ['a.wav', 'a.json'].map((name) => path.join(folder, name));
  execFileSync(path.join(build, 'server/app/faccia'), ['say', '--voice', voice, '--lang', lang, '--wav', wav, '--json', json, sentences[lang].join('\n')], { stdio: ['ignore', 'ignore', 'inherit'] });
  const bytes = fs.readFileSync(wav);
  const { phones } = JSON.parse(fs.readFileSync(json));
  fs.rmSync(folder, { recursive: true });
  const rate = bytes.readUInt32LE(24);
  const pcm = Float64Array.from({ length: (bytes.length - 44) >> 1 }, (_, i) => bytes.readInt16LE(44 + 2 * i));
  const levels = new Map();
  const levelsOf = (hz) => levels.get(String(hz)) ?? levels.set(String(hz), band(pcm, rate, hz)).get(String(hz));
  const out = {};
  for (const [name, event] of [...Object.entries(EVENTS), ['burst before end', BURST]]) {
    const found = [];
    for (let i = 1; i < phones.length; i++) {
      const [before, after] = [phones[i - 1], phones[i]];
      if (!event[0].test(before.ipa) || !event[1].test(after.ipa) || /ː/.test(before.ipa + after.ipa)) continue;
      const from = event === BURST ? before.start + 0.005 : Math.max((before.start + before.end) / 2, after.start - SHOWN);
      const to = event === BURST ? after.start + 0.02 : Math.min((after.start + after.end) / 2, after.start + SHOWN);
      const at = steepest(levelsOf(event[2]), from, to, event[3]);
      if (at !== undefined) found.push(1000 * (after.start - at));
    }
    if (found.length < 5) continue;
    const middle = median(found);
    out[name] = `${middle.toFixed(0)} ±${median(found.map((x) => Math.abs(x - middle))).toFixed(0)} (${found.length})`;
  }
  return out;
}

const LANG = { it: 'it', lp: 'it', pc: 'it', slt: 'en', kal: 'en', 'pt-br': 'pt-BR', tr: 'tr', 'en-us': 'en' };
const names = [...Object.keys(EVENTS), 'burst before end'];
console.log(`| voice | ${names.join(' | ')} |\n|---|${names.map(() => '---|').join('')}`);
for (const voice of process.argv.length > 2 ? process.argv.slice(2) : VOICES) {
  const row = measure(voice, LANG[voice.split(':')[1].split('+')[0]] ?? 'en');
  console.log(`| ${voice} | ${names.map((name) => row[name] ?? '').join(' | ')} |`);
}
