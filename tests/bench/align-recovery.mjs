// SPDX-License-Identifier: GPL-3.0-or-later
// Alignment of a recording that differs from its text: consecutive prompts of Debian's asterisk-core-sounds-it, some missing from the text, and
// others added to it.
// Counts sentences of both that are found in the right place, and those of only one side that are reported.
// node tests/bench/run.mjs align-recovery [PROMPTS, 60] [SEED, 1] [--program FACCIA]
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { build } from '../lib/daemon.mjs';
import { madeOf, prompts } from '../lib/prompts.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: { program: { type: 'string' } } });
const count = Number(positionals[0] ?? 60), faccia = values.program ?? path.join(build, 'server/cli/faccia');
let state = Number(positionals[1] ?? 1);
const random = (below) => {
  state = (Math.imul(state, 1664525) + 1013904223) | 0;
  return Math.floor(((state >>> 0) / 2 ** 32) * below);
};
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const file = (name) => path.join(folder, name);
const pool = prompts().filter(({ text }) => text.length > 20 && !/\d|\n|beep/.test(text));
for (let i = pool.length - 1; i > 0; i--) {
  const j = random(i + 1);
  [pool[i], pool[j]] = [pool[j], pool[i]];
}

/** Prints the number of sentences found correctly. `read` and `written`: prompts, in order. */
function measure(name, read, written, { between = () => 0 } = {}) {
  const made = madeOf(read, { between });
  fs.writeFileSync(file('x.wav'), made.wav);
  const text = written.map((p) => p.text.replace(/[.!?]*\s*$/, '.')).join('\n');
  fs.writeFileSync(file('x.txt'), text);
  const before = process.resourceUsage();
  let failed = '';
  try {
    execFileSync('bash', ['-c', '"$@"; times >&2', '-', faccia, 'align', '-q', file('x.wav'), '--text', file('x.txt'), '--gender', 'male', '--json', file('x.json')],
      { stdio: ['ignore', 'ignore', fs.openSync(file('err'), 'w')] });
  } catch {
    failed = 'refused';
  }
  const err = fs.readFileSync(file('err'), 'utf8'), cpu = err.trim().split('\n').at(-1).split(' ').reduce((s, t) => s + Number(t.match(/m([\d.]+)s/)?.[1] ?? 0) + 60 * (parseInt(t) || 0), 0);
  if (failed) return console.log(`${name}: ${err.split('\n')[0]}`);
  const { words } = JSON.parse(fs.readFileSync(file('x.json')));
  let byte = 0, there = 0, right = 0, missing = 0, told = 0, hidden = [], wrong = [];
  for (const p of written) {
    const length = Buffer.byteLength(p.text.replace(/[.!?]*\s*$/, '.')), own = words.filter((w) => w.byte_start >= byte && w.byte_end <= byte + length);
    byte += length + 1;
    const known = own.filter((w) => w.end > w.start), places = made.places.filter((q) => q.name === p.name);
    const sure = known.length ? known.reduce((s, w) => s + (w.confidence ?? 1), 0) / known.length : 0;
    if (!places.length) {
      missing++;
      if (known.length <= own.length / 4 || sure < 0.15) told++;
      else hidden.push(`${p.text.slice(0, 30)} ${sure.toFixed(2)}`);
      continue;
    }
    there++;
    const good = known.length > own.length / 2 && places.some((q) => Math.abs(known[0].start - q.start) < 0.3 && Math.abs(known.at(-1).end - q.end) < 0.3);
    if (good) right++;
    else wrong.push(`${p.text.slice(0, 30)} ${known.length ? `${known[0].start.toFixed(1)}..${known.at(-1).end.toFixed(1)} sure ${sure.toFixed(2)}` : 'not found'}, is ${places.map((q) => `${q.start.toFixed(1)}..${q.end.toFixed(1)}`)}`);
  }
  console.log(`${name}: ${right} of ${there} sentences within 0.3 s at both ends; ${told} of ${missing} that are not read are told; ` +
    `${made.seconds.toFixed(0)} s of sound, ${(cpu / made.seconds * 60).toFixed(2)} s of processor for each minute`);
  if (process.env.VERBOSE) console.log([...wrong, ...hidden].map((w) => `    ${w}`).join('\n'));
  void before;
}

const main = pool.slice(0, count), others = pool.slice(count, 2 * count);
measure('as it is written', main, main);
const some = new Set(Array.from({ length: Math.ceil(count / 10) }, () => random(count)));
measure('one sentence in ten is not read', main.filter((_, i) => !some.has(i)), main);
measure('one in ten is not in the text', main.flatMap((p, i) => (some.has(i) ? [others[i], p] : [p])), main);
measure('one in ten is read twice', main.flatMap((p, i) => (some.has(i) ? [p, p] : [p])), main);
measure('one in ten is read otherwise', main.map((p, i) => (some.has(i) ? others[i] : p)), main);
const cut = count >> 1;
measure('a third of the text is not read', [...main.slice(0, count / 3), ...main.slice(2 * count / 3)], main);
measure('a minute of silence, and music', main, main, { between: (i) => (i === cut ? { silence: 60, music: 40 } : 0) });
measure('an announcement of 20 sentences', [...others.slice(0, 20), ...main], main);
fs.rmSync(folder, { recursive: true });
