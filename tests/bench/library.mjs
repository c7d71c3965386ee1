// SPDX-License-Identifier: GPL-3.0-or-later
// The library's index: indexing speed and search latency, beside sqlite3 on the same index and grep on the same files.
// node tests/bench/run.mjs library [MEGABYTES, 20] [SEARCHES, 500] [TURNS, 1: all searches again, of each the best turn]
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { sentencesOf } from '../lib/works.mjs';

const megabytes = Number(process.argv[2] ?? 20);
const count = Number(process.argv[3] ?? 500);
const turns = Number(process.argv[4] ?? 1);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const works = path.join(folder, 'works');
const index = path.join(folder, 'works.index');
const WORDS = 60000;

fs.mkdirSync(works);
const words = new Map();
for (let i = 0; i < megabytes; i++) {
  const sentences = sentencesOf(i + 1, WORDS);
  const text = [];
  for (let size = 0; size < 1 << 20; ) {
    const paragraph = Array.from({ length: 4 }, () => sentences.next().value).join(' ');
    if (size < 50000) for (const word of paragraph.match(/\w+/g)) words.set(word, (words.get(word) ?? 0) + 1);
    text.push(paragraph);
    size += paragraph.length;
  }
  fs.writeFileSync(path.join(works, `work-${i}.it.txt`), text.join('\n\n'));
}
/** CPU seconds of a process. */
const used = (pid) => fs.readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ').slice(11, 13).reduce((sum, ticks) => sum + Number(ticks) / 100, 0);
/** The same in ms, by the scheduler's accounting. */
const spent = (pid) => fs.readdirSync(`/proc/${pid}/task`).reduce((sum, task) => sum + Number(fs.readFileSync(`/proc/${pid}/task/${task}/schedstat`, 'utf8').split(' ')[0]) / 1e6, 0);
const quantiles = (times) => {
  times.sort((a, b) => a - b);
  return ['0.5', '0.9', '0.99'].map((q) => `${q}: ${times[Math.min(times.length - 1, Math.floor(times.length * q))].toFixed(2)} ms`).join(', ');
};

const begun = performance.now();
const daemon = await Daemon.start(['--library', works, '--library-index', index], {}, { voices: false });
await eventually(async () => (await (await daemon.get('/v1/library?limit=1')).json()).state === 'ready', 'the index', 3600000);
const seconds = (performance.now() - begun) / 1000;
const size = fs.statSync(index).size;
console.log(`${megabytes} MiB in ${megabytes} works: read and indexed in ${seconds.toFixed(1)} s (${(megabytes / seconds).toFixed(2)} MiB/s), ${used(daemon.process.pid).toFixed(1)} s of processor; index ${(size / 2 ** 20).toFixed(0)} MiB`);
await eventually(async () => { const now = used(daemon.process.pid); await new Promise((resolve) => setTimeout(resolve, 1000)); return used(daemon.process.pid) - now < 0.1; }, 'quiet', 600000);

// queries of one to three words, by their frequency in the text
const all = [...words].flatMap(([word, n]) => Array(Math.ceil(n / 3)).fill(word));
let state = 7;
const pick = () => all[(state = (Math.imul(state, 1664525) + 1013904223) >>> 0) % all.length];
const queries = Array.from({ length: count }, (_, i) => Array.from({ length: 1 + (i % 3) }, pick).join(' '));
const ask = async (q) => {
  const from = performance.now();
  const response = await fetch(`${daemon.url}/v1/library/search?q=${encodeURIComponent(q)}`);
  await response.text();
  if (response.status !== 200) console.log(`${q}: ${response.status}`);
  return performance.now() - from;
};
for (const q of queries.slice(0, 50)) await ask(q);
const times = Array(count).fill(Infinity), costs = Array(count).fill(Infinity);
for (let turn = 0; turn < turns; turn++)
  for (const [i, q] of queries.entries()) {
    const before = spent(daemon.process.pid);
    times[i] = Math.min(times[i], await ask(q));
    costs[i] = Math.min(costs[i], spent(daemon.process.pid) - before);
  }
console.log(`${count} searches over HTTP, one after the other, best of ${turns}: ${quantiles(times)}`);
console.log(`of the processor, all of the daemon's threads, whatever ran beside: ${quantiles(costs)}`);

// requests passages by id, from any work and section; then speaks them, and for comparison their text, in turns
const shelf = (await (await daemon.get('/v1/library?limit=1000')).json()).works;
const places = [];
for (let i = 0; places.length < count; i++) {
  const { id, sections } = shelf[i % shelf.length];
  const { blocks } = await (await daemon.get(`/v1/library/works/${id}/sections/${1 + ((i * 7) % sections)}`)).json();
  for (let k = 0; k < 10 && places.length < count; k++) places.push(blocks[(k * 37) % blocks.length].id);
}
const lookups = [], lookupCosts = [];
for (const id of places) {
  const [before, from] = [spent(daemon.process.pid), performance.now()];
  await (await fetch(`${daemon.url}/v1/library/passages/${id}`)).text();
  lookups.push(performance.now() - from);
  lookupCosts.push(spent(daemon.process.pid) - before);
}
console.log(`${count} passages by id over HTTP: ${quantiles(lookups)}; of the processor: ${quantiles(lookupCosts)}`);
await daemon.logged(/ready: /);
const stream = await daemon.stream();
const spoken = { passage: [], text: [] };
for (const [i, id] of places.slice(0, 60).entries()) {
  const { text } = await (await daemon.get(`/v1/library/passages/${places[(i + 60) % places.length]}`)).json();
  for (const [way, what] of Object.entries({ passage: { passage: id }, text: { text } })) {
    const [chunks, messages, from] = [stream.chunks.length, stream.messages.length, performance.now()];
    stream.send({ type: 'speak', voice: 'espeak:it', lang: 'it', ...what });
    await stream.until(() => stream.chunks.length > chunks);
    spoken[way].push(stream.chunks[chunks].arrived - from);
    stream.send({ type: 'stop' });
    await stream.wait({ type: 'end' }, { from: messages });
  }
}
await stream.close();
for (const [way, times] of Object.entries(spoken)) console.log(`60 spoken by ${way}, from speak to first media: ${quantiles(times)}`);

const script = queries.slice(0, 100).map((q) => `SELECT count(*) FROM (SELECT rowid FROM found WHERE found MATCH '${q.split(' ').map((w) => `word:${w}`).join(' AND ')}' ORDER BY rank LIMIT 20);`);
const bare = spawnSync('sqlite3', ['-cmd', '.timer on', index], { input: script.join('\n'), encoding: 'utf8' });
console.log(`100 of them by sqlite3, words as written, all ranked: ${quantiles([...bare.stdout.matchAll(/real ([\d.]+)/g)].map(([, s]) => 1000 * s))}`);
const grep = queries.slice(0, 10).map((q) => { const from = performance.now(); spawnSync('grep', ['-rlwF', q.split(' ')[0], works]); return performance.now() - from; });
console.log(`10 of them by grep -rlwF, first word only: ${quantiles(grep)}`);
await daemon.stop();
fs.rmSync(folder, { recursive: true });
