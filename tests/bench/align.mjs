// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of aligned phones where the truth is known (Festival's voices as recordings), and speed of alignment: seconds of sound per
// second of CPU, beside sox copying the same file, in one run.
// Usage: node tests/bench/run.mjs align [VOICE[,VOICE]... [SENTENCES]]
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build } from '../lib/daemon.mjs';
import { errors } from '../lib/boundaries.mjs';
import { austen, manzoni } from '../lib/texts.mjs';

const voices = (process.argv[2] ?? 'lp,pc,slt,kal').split(','), sentences = Number(process.argv[3] ?? Infinity);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const file = (name) => path.join(folder, name);
const read = (name) => JSON.parse(fs.readFileSync(file(name)));
const faccia = path.join(build, 'server/cli/faccia');

/** Measures the CPU seconds of a command. */
const cpu = (...command) => {
  const out = execFileSync('bash', ['-c', '"$@" >/dev/null; times', '-', ...command]).toString().trim().split('\n').at(-1);
  return out.split(' ').reduce((sum, t) => sum + Number(t.match(/m([\d.]+)s/)[1]) + 60 * parseInt(t), 0);
};

console.log('voice          phones  same  median   90 %  within 50 ms   x real time');
for (const [voice, lang, text] of [['lp', 'it', manzoni], ['pc', 'it', manzoni], ['slt', 'en', austen], ['kal', 'en', austen]]) {
  if (!voices.includes(voice)) continue;
  fs.writeFileSync(file('text'), text.split(/(?<=[.!?])\s/).slice(0, sentences).join(' '));
  execFileSync(faccia, ['say', '--still', '-l', lang, '-v', `festival:${voice}`, '--wav', file('wav'), '--json', file('truth'), '-f', file('text')]);
  const seconds = cpu(faccia, 'align', '-q', file('wav'), '--text', file('text'), '-l', lang, '--json', file('found'));
  const e = errors(read('truth').phones, read('found').phones);
  const length = read('found').duration;
  console.log(`festival:${voice.padEnd(4)} ${String(e.phones).padStart(7)} ${String(e.pairs).padStart(5)} ${e.median.toFixed(1).padStart(6)} ms ` +
    `${e.p90.toFixed(1).padStart(5)} ms ${(100 * e.within50).toFixed(1).padStart(8)} %   ${(length / seconds).toFixed(0).padStart(10)}`);
  if (voice === 'kal') console.log(`sox reads and writes the same: ${(length / cpu('sox', file('wav'), file('copy.wav'))).toFixed(0)} x real time`);
}
fs.rmSync(folder, { recursive: true });
