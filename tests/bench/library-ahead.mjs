// SPDX-License-Identifier: GPL-3.0-or-later
// Latency of a prerendered passage (--library-ahead), beside the same passage without prerendering, and beside its text while other works
// are being prerendered: ms from `speak` on an open socket to the first media message. The three take turns.
// Usage: node tests/bench/run.mjs library-ahead [VOICE] [PASSAGES]
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { median, quantile } from './figures.mjs';
import { sentence } from './text.mjs';

const voice = process.argv[2] ?? 'festival:lp';
const count = Number(process.argv[3] ?? 20);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-ahead-'));
const paragraph = (i, word) => `${sentence.slice(0, -1)}, ${word} ${i + 100}. ${sentence}`;
const works = (name, length, word) => {
  fs.mkdirSync(path.join(folder, name));
  fs.writeFileSync(path.join(folder, name, 'opera.it.md'), `# Opera\n\n${Array.from({ length }, (_, i) => paragraph(i, word)).join('\n\n')}\n`);
};
works('some', count, 'volta');
works('many', 3000, 'giro');

const start = (name, ahead) => Daemon.start(['--library', path.join(folder, name), '--library-index', path.join(folder, `${name}${ahead}.index`), '--cache', '256', ...(ahead ? ['--library-ahead', voice] : [])]);
const ahead = async (daemon) => (await (await daemon.get('/v1/library')).json()).ahead;

async function firstMedia(stream, what) {
  const before = stream.chunks.length, from = stream.messages.length;
  const begin = performance.now();
  stream.send({ type: 'speak', voice, lang: 'it', ...what });
  await stream.until(() => stream.chunks.length > before, 60000);
  const first = stream.chunks[before].arrived - begin;
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end' }, { from });
  return first;
}

const ways = { 'not spoken ahead': await start('some', false), 'spoken ahead': await start('some', true), 'while others are spoken ahead': await start('many', true) };
const daemons = Object.values(ways);
await eventually(async () => (await ahead(daemons[1]))?.state === 'done', 'what is spoken ahead', 170000);
const streams = await Promise.all(daemons.map((daemon) => daemon.stream()));
const times = daemons.map(() => []);
let beside = 0;
for (let i = 0; i < count; i++)
  for (const [k, daemon] of daemons.entries()) {
    if (k === 2) beside += await eventually(async () => (await ahead(daemon))?.state === 'speaking', 'speaking ahead');
    times[k].push(await firstMedia(streams[k], k === 2 ? { text: paragraph(i, 'volta') } : { passage: `opera-it:1:p${i + 1}` }));
  }
console.log(`${voice}, ${count} passages, medians (90 %), ms from speak to the first media message`);
for (const [k, name] of Object.keys(ways).entries()) console.log(`  ${name}: ${median(times[k]).toFixed(1)} (${quantile(times[k], 0.9).toFixed(1)}), ${(median(times[k]) / median(times[0])).toFixed(2)} of the first`);
console.log(`  load ${os.loadavg()[0].toFixed(1)}; ${beside} of ${count} met the voice at work`);
for (const stream of streams) await stream.close();
for (const daemon of daemons) await daemon.stop();
fs.rmSync(folder, { recursive: true });
