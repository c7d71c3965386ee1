// SPDX-License-Identifier: GPL-3.0-or-later
// Parsing speed of marked-up documents: MB/s on one core, beside expat alone on the same file. Usage: node tests/bench/run.mjs markup
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { median } from './figures.mjs';

import { needProgram } from './need.mjs';
const MEGABYTES = 4;
const words = 'La mamma parla piano mentre il vento soffia forte sopra le case bianche del porto e nessuno risponde perché è tardi'.split(' ');
const text = (n, from) => Array.from({ length: n }, (_, i) => words[(from + i * 7) % words.length]).join(' ');
const sentence = (n, from) => text(n, from).replace(/^./, (letter) => letter.toUpperCase());
const documents = {
  ssml: ['<speak version="1.1" xml:lang="it">\n', (i) => `<p><s>${text(9, i)}, <prosody rate="slow" pitch="+10%">${text(5, i + 1)}</prosody> ${text(6, i)}.</s> ${text(12, i)} <break time="300ms"/> ${text(8, i)}. <emphasis level="strong">${text(2, i)}</emphasis> ${text(9, i)}?</p>\n`, '</speak>\n'],
  apml: ['<apml xml:lang="it">\n', (i) => `<performative type="inform"><theme affect="joy">${text(6, i)} <emphasis x-pitchaccent="Hstar">${text(1, i)}</emphasis><boundary type="LH"/></theme> <rheme certainty="certain">${text(9, i)}.<boundary type="LL"/></rheme></performative>\n`, '</apml>\n'],
  jsml: ['<jsml>\n', (i) => `<SENT>${text(6, i)} <HAPPY WEIGHT="0.3">${text(2, i)}</HAPPY>, ${text(9, i)} <BREAK MSECS="200"/> ${text(4, i)}.</SENT>\n`, '</jsml>\n'],
  'prose in ssml': ['<speak xml:lang="it">\n', (i) => `<p>${Array.from({ length: 8 }, (_, k) => `${sentence(12, i + k)}.`).join(' ')}</p>\n`, '</speak>\n'],
};

const program = needProgram('markup');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
for (const [name, [begin, middle, end]] of Object.entries(documents)) {
  const parts = [begin];
  for (let i = 0, size = 0; size < MEGABYTES * 1e6; i++) size += Buffer.byteLength(parts[parts.push(middle(i)) - 1]);
  const file = path.join(folder, 'document');
  fs.writeFileSync(file, `${parts.join('')}${end}`);
  const megabytes = fs.statSync(file).size / 1e6;
  const rounds = JSON.parse(execFileSync(program, [file, '7']));
  const [bare, ours] = [0, 1].map((k) => median(rounds.map((r) => r[k])));
  console.log(`${name}: ${(megabytes / ours).toFixed(0)} MB/s; expat alone ${(megabytes / bare).toFixed(0)} MB/s, ratio ${(ours / bare).toFixed(2)}`);
}
fs.rmSync(folder, { recursive: true });
