// SPDX-License-Identifier: GPL-3.0-or-later
// Reliability of the confidence of aligned words. Sentences with known times (Festival's voices: every word; Debian's asterisk-core-sounds-it: the start of
// each prompt) are aligned to a text with lines missing, replaced, repeated or reordered, and with noise or music between. Counts, by confidence, the words
// within 0.3 s of the truth, and those a second off or not spoken at all.
// node tests/bench/run.mjs align-confidence [SENTENCES, 14] [SEED, 1] [--voices kal,slt,lp,pc,carlo] [--program FACCIA]
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { build } from '../lib/daemon.mjs';
import { prompts } from '../lib/prompts.mjs';
import { austen, manzoni } from '../lib/texts.mjs';
import { wavOf } from '../lib/wav.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: { program: { type: 'string' }, voices: { type: 'string', default: 'kal,slt,lp,pc,carlo' } } });
const count = Number(positionals[0] ?? 14), faccia = values.program ?? path.join(build, 'server/cli/faccia');
let state = Number(positionals[1] ?? 1);
const random = (below) => {
  state = (Math.imul(state, 1664525) + 1013904223) | 0;
  return Math.floor(((state >>> 0) / 2 ** 32) * below);
};
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const file = (name) => path.join(folder, name);
const sentencesOf = (text) => text.replace(/\s+/g, ' ').split(/(?<=[.;:!?]"?) /).map((s) => s.replace(/["“”]/g, '').trim().replace(/[;:,]$/, '.')).filter((s) => s.length > 15);
const samplesOf = (name) => {
  const data = fs.readFileSync(name);
  return { rate: data.readUInt32LE(24), pcm: new Int16Array(data.buffer.slice(data.byteOffset + 44, data.byteOffset + data.length - (data.length % 2))) };
};

/** [{text, pcm, rate, words: [[byte, seconds]]}] */
function said(voice, lang, texts) {
  return texts.map((text) => {
    execFileSync(faccia, ['say', '--still', '-l', lang, '-v', `festival:${voice}`, '--wav', file('s.wav'), '--json', file('s.json'), text]);
    const words = JSON.parse(fs.readFileSync(file('s.json'))).words.map((w) => [w.byte_start, w.start]);
    return { text, ...samplesOf(file('s.wav')), words };
  });
}

function read() {
  return prompts().filter(({ text }) => text.length > 20 && !/\d|\n|beep/.test(text)).map(({ text, sound }) => {
    const { rate, pcm } = samplesOf(sound);
    return { text: text.replace(/[.!?]*\s*$/, '.'), rate, pcm, words: [[0, Math.max(0, pcm.findIndex((x) => Math.abs(x) > 400)) / rate]] };
  });
}

const noise = (rate, seconds, loud) => Int16Array.from({ length: rate * seconds }, () => (random(20001) - 10000) / 10000 * loud);
const music = (rate, seconds) => Int16Array.from({ length: rate * seconds }, (_, k) => {
  const t = k / rate, root = 110 * 2 ** ([0, 5, 7, 3, 8, 10][Math.floor(2 * t) % 6] / 12);
  return [1, 1.26, 1.5, 2, 3].reduce((sum, n) => sum + 1200 * Math.sin(2 * Math.PI * root * n * t), 0) * Math.exp(-3 * (t % 0.5));
});

const BINS = [0, 0.15, 0.5, 0.9, 1.01];
const tally = () => BINS.slice(1).map(() => ({ n: 0, right: 0, far: 0, unsaid: 0, sum: 0 }));

/** Aligns a recording to a text and adds the results to the bins. */
function measure(lang, spoken, written, bins, extras = new Map()) {
  const parts = [], places = new Map();
  let at = 0;
  const { rate } = spoken[0];
  const add = (pcm) => { parts.push(pcm); at += pcm.length; };
  spoken.forEach((s, i) => {
    if (extras.has(i)) add(extras.get(i)(rate));
    places.set(s, [...(places.get(s) ?? []), at / rate]);
    add(s.pcm);
    add(new Int16Array(Math.round(rate * 0.4)));
  });
  const all = new Int16Array(at);
  parts.reduce((to, part) => (all.set(part, to), to + part.length), 0);
  fs.writeFileSync(file('x.wav'), wavOf(all, rate));
  fs.writeFileSync(file('x.txt'), written.map(({ text }) => text).join('\n'));
  let found = [];
  try {
    execFileSync(faccia, ['align', '-q', file('x.wav'), '--text', file('x.txt'), '-l', lang, '--json', file('x.json')], { stdio: 'pipe' });
    found = JSON.parse(fs.readFileSync(file('x.json'))).words;
  } catch { /* refused by the aligner */ }
  const by = new Map(found.map((w) => [w.byte_start, w]));
  let byte = 0, have = 0, right = 0;
  for (const s of written) {
    for (const [offset, second] of s.words) {
      const w = by.get(byte + offset), heard = places.get(s);
      have += heard ? 1 : 0;
      if (!w || !(w.end > w.start)) continue;
      const bin = bins[BINS.findIndex((b, i) => w.confidence < BINS[i + 1])];
      const off = heard ? Math.min(...heard.map((p) => Math.abs(w.start - p - second))) : Infinity;
      bin.n++;
      bin.sum += w.confidence;
      if (off < 0.3) { bin.right++; right++; }
      if (off > 1) bin.far++;
      if (process.env.VERBOSE && off > 0.5) console.log(`    ${w.text} at ${w.start.toFixed(2)} confidence ${w.confidence}, ${heard ? `is at ${heard.map((p) => (p + second).toFixed(2))}` : "is not said"}: ${s.text.slice(0, 60)}`);
      if (!heard) bin.unsaid++;
    }
    byte += Buffer.byteLength(s.text) + 1;
  }
  return { have, right };
}

const all = tally();
for (const voice of values.voices.split(',')) {
  const lang = ['kal', 'slt', 'ked'].includes(voice) ? 'en' : 'it', bins = tally();
  const more = lang === 'en' ? ' She was a woman of mean understanding, little information, and uncertain temper. The business of her life was to get her daughters married. Its solace was visiting and news. Mr. Bennet was among the earliest of those who waited on Mr. Bingley. He had always intended to visit him, though to the last always assuring his wife that he should not go.'
    : ' Per una di queste stradicciole, tornava bel bello dalla passeggiata verso casa don Abbondio. Diceva tranquillamente il suo ufizio, e talvolta chiudeva il breviario. Giunto a una voltata della stradetta, vide una cosa che non si aspettava. Due uomini stavano, uno dirimpetto all\'altro. Le case del villaggio erano bianche sotto la luna.';
  const other = lang === 'en' ? 'The ship sailed slowly out of the harbour before dawn. Nobody had told the captain about the storm in the north. Seven barrels of salted fish were left behind on the pier.' : 'La nave uscì lentamente dal porto prima dell\'alba. Nessuno aveva detto al capitano della tempesta. Sette barili di pesce salato rimasero sul molo.';
  const pool = voice === 'carlo' ? read() : said(voice, lang, sentencesOf((lang === 'en' ? austen : manzoni) + more));
  for (let i = pool.length - 1; i > 0; i--) {
    const j = random(i + 1);
    [pool[i], pool[j]] = [pool[j], pool[i]];
  }
  const main = pool.slice(0, Math.min(count, pool.length)), others = voice === 'carlo' ? pool.slice(main.length, main.length + 4) : sentencesOf(other).map((text) => ({ text, pcm: null, words: [[0, 0], [4, 0.3]] }));
  const k = 1 + random(main.length - 3), sayable = voice === 'carlo' ? others : said(voice, lang, others.map(({ text }) => text));
  const runs = {
    'as written': [main, main],
    'a line not read': [main.filter((_, i) => i !== k), main],
    'a line not written': [main.toSpliced(k, 0, sayable[0]), main],
    'read otherwise': [main.map((s, i) => (i === k || i === k + 1 ? sayable[i - k] : s)), main],
    'two in the other order': [main.map((s, i) => (i === k ? main[k + 1] : i === k + 1 ? main[k] : s)), main],
    'the text goes wrong': [main, [...main.slice(0, k + 1), ...sayable]],
    'the wrong text': [main, sayable],
    'noise': [main, main, new Map([[k, (rate) => noise(rate, 3, 3000)], [0, (rate) => noise(rate, 2, 2000)]])],
    'music': [main, main, new Map([[k, (rate) => music(rate, 8)]])],
  };
  const told = Object.entries(runs).map(([name, run]) => {
    const { have, right } = measure(lang, run[0], run[1], bins, run[2]);
    return `${name} ${right}/${have}`;
  });
  console.log(`${voice}: words within 0.3 s: ${told.join(', ')}`);
  bins.forEach((b, i) => Object.keys(b).forEach((key) => (all[i][key] += b[key])));
}
console.log('confidence       words  mean  within 0.3 s  over 1 s off or not said  (not said)');
let gap = 0, n = 0;
all.forEach((b, i) => {
  if (!b.n) return;
  gap += Math.abs(b.sum - b.right);
  n += b.n;
  const percent = (x) => `${((100 * x) / b.n).toFixed(1)} %`;
  console.log(`${BINS[i].toFixed(2)} to ${Math.min(1, BINS[i + 1]).toFixed(2)}  ${String(b.n).padStart(7)}  ${(b.sum / b.n).toFixed(2)}  ${percent(b.right).padStart(12)}  ${percent(b.far).padStart(24)}  ${String(b.unsaid).padStart(9)}`);
});
console.log(`mean distance of confidence from the share that is right: ${(gap / n).toFixed(3)} (${n} words)`);
fs.rmSync(folder, { recursive: true });
