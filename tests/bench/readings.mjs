// SPDX-License-Identifier: GPL-3.0-or-later
// Normalising numbers, signs and abbreviations: CPU time per kilobyte in four languages, beside ICU's sentence and word segmentation, in one
// run; and latency to first media of short and long texts with and without it (`normalize=off`), in turns.
// Usage: node tests/bench/run.mjs readings [ROUNDS] [LONGEST TEXT, kB]
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { Daemon, root } from '../lib/daemon.mjs';
import { manzoni } from '../lib/texts.mjs';
import { median, quantile } from './figures.mjs';
import { needProgram } from './need.mjs';

const rounds = Number(process.argv[2] ?? 10);
const longest = Number(process.argv[3] ?? 1000);
const program = needProgram('readings');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const file = path.join(folder, 'text');

/** Texts of a language's table of readings, nearly all of which need normalising. */
const table = (lang) => fs.readFileSync(path.join(root, `tests/readings/${lang}.tsv`), 'utf8').split('\n').filter(Boolean).map((line) => line.split('\t')[0]);
/** Repeats lines up to that many kilobytes. */
function fill(lines, kilobytes, end = '\n') {
  let text = '';
  for (let i = 0; text.length < kilobytes * 1000; i++) text += lines[i % lines.length] + end;
  return text;
}

function cost(name, lang, lines) {
  fs.writeFileSync(file, fill(lines, 100));
  const kilobytes = fs.statSync(file).size / 1000;
  const [ours, breaks, bare] = [0, 1, 2].map((k, _, { length }) =>
    (median(JSON.parse(execFileSync(program, [lang, file, String(Math.max(length, rounds))])).map((round) => round[k])) * 1e6) / kilobytes);
  console.log(`${name}: ${ours.toFixed(0)} µs of processor for a kilobyte; ICU's sentences and words ${breaks.toFixed(0)} µs, ratio ${(ours / breaks).toFixed(1)}; letters composed alone ${bare.toFixed(0)} µs`);
}

for (const lang of ['it', 'en', 'pt-BR', 'tr']) cost(`${lang}, its table of readings`, lang, table(lang));
const prose = manzoni.split(/(?<=\.)\s+/);
cost('it, a novel', 'it', prose);
fs.rmSync(folder, { recursive: true });

const daemon = await Daemon.start(['--cache', '0', '--max-message', String(2 * longest * 1000), '--max-text', String(2 * longest * 1000)]);
async function first(text, normalize) {
  const stream = await daemon.stream();
  await stream.wait({ type: 'hello' });
  const started = performance.now();
  stream.send({ type: 'speak', lang: 'it', voice: 'espeak:it', text, normalize });
  await stream.until(() => stream.chunks.length > 0);
  const milliseconds = stream.chunks[0].arrived - started;
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end' });
  await stream.close();
  return milliseconds;
}
const numbers = ['Il 26 novembre pago € 3,50 al Sig. Rossi.', ...prose];
for (const kilobytes of [0.1, 100, 1000].filter((size) => size <= longest)) {
  const text = kilobytes < 1 ? numbers[0] : fill(numbers, kilobytes, ' ');
  const times = { on: [], off: [] };
  for (let run = 0; run < rounds + 2; run++)
    for (const way of run % 2 ? ['on', 'off'] : ['off', 'on']) {
      const milliseconds = await first(text, way);
      if (run >= 2) times[way].push(milliseconds);
    }
  const [on, off] = [median(times.on), median(times.off)];
  console.log(`${kilobytes < 1 ? 'one sentence' : `${kilobytes} kB`}: first media ${on.toFixed(2)} ms (90 %: ${quantile(times.on, 0.9).toFixed(2)}); normalize=off ${off.toFixed(2)} ms (${quantile(times.off, 0.9).toFixed(2)}); later by ${(on - off).toFixed(2)} ms (${rounds} runs by turns, medians)`);
}
await daemon.stop();
