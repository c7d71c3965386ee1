// SPDX-License-Identifier: GPL-3.0-or-later
// Latency from `speak` to the first media message on loopback, beside libespeak-ng alone to its first audio callback and to the end of the
// first sentence, in one run.
// Usage: node tests/bench/run.mjs first-media [RUNS]
import { execFileSync } from 'node:child_process';
import { Daemon } from '../lib/daemon.mjs';
import { median, quantile } from './figures.mjs';
import { needProgram } from './need.mjs';
import { prose, sentence } from './text.mjs';

const runs = Number(process.argv[2] ?? 30);
const program = needProgram('espeak_first');
const daemon = await Daemon.start(['--cache', '0']);
const { voices } = await (await daemon.get('/v1/voices')).json();
const voice = voices.find((v) => v.id === 'espeak:it');

for (const [name, text] of [['one sentence', sentence], ['five minutes', prose(300)]]) {
  const library = (...args) => execFileSync(program, ['it', String(runs + 3), ...args]).toString().trim().split('\n').map(Number).slice(3);
  const alone = library(text);
  const first = text.slice(0, text.indexOf('.') + 1);
  const whole = library(first, 'whole'); // mouth movements depend on the following sounds, so the face needs the whole sentence
  const ours = [];
  for (let run = 0; run < runs + 3; run++) {
    const stream = await daemon.stream();
    await stream.wait({ type: 'hello' });
    const started = performance.now();
    stream.send({ type: 'speak', lang: 'it', voice: voice.id, text });
    await stream.until(() => stream.chunks.length > 0);
    if (run >= 3) ours.push(stream.chunks[0].arrived - started);
    stream.send({ type: 'stop' });
    await stream.wait({ type: 'end' });
    await stream.close();
  }
  console.log(`${name}: first media ${median(ours).toFixed(2)} ms (90 %: ${quantile(ours, 0.9).toFixed(2)}), ` +
    `libespeak-ng alone ${median(alone).toFixed(2)} ms, above it ${(median(ours) - median(alone)).toFixed(2)} ms; ` +
    `libespeak-ng for the first sentence (${first.length} characters) ${median(whole).toFixed(2)} ms, above that ${(median(ours) - median(whole)).toFixed(2)} ms (${runs} runs, medians)`);
}
await daemon.stop();
