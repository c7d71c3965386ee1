// SPDX-License-Identifier: GPL-3.0-or-later
// Time saved by the cache of sentences: latency of cached sentences, beside uncached ones and a request that needs no voice, in one run. From
// memory, from a file, and from another daemon over Redis.
// Usage: node tests/bench/run.mjs cache [RUNS] [VOICE]...
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { Redis } from '../lib/redis.mjs';
import { median, quantile } from './figures.mjs';
import { sentence } from './text.mjs';

const runs = Number(process.argv[2] ?? 40);
const chosen = process.argv.slice(3);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const agent = new http.Agent({ keepAlive: true, maxSockets: 1 });

/** Measures ms to the first byte of the body; reads all of it. */
function request(daemon, address, body) {
  return new Promise((resolve, reject) => {
    const start = performance.now();
    let first;
    const method = body === undefined ? 'GET' : 'POST';
    const asked = http.request(daemon.url + address, { agent, method, headers: body === undefined ? {} : { 'content-type': 'text/plain' } }, (answer) => {
      answer.on('data', () => (first ??= performance.now() - start));
      answer.on('end', () => (answer.statusCode === 200 ? resolve(first) : reject(new Error(`${address}: ${answer.statusCode}`))));
    });
    asked.on('error', reject);
    asked.end(body);
  });
}

/** Measures ms from `speak` on an open socket to the first media message. */
async function firstMedia(stream, voice, text) {
  const before = stream.chunks.length, from = stream.messages.length;
  const start = performance.now();
  stream.send({ type: 'speak', lang: 'it', voice, text });
  await stream.until(() => stream.chunks.length > before, 60000);
  const first = stream.chunks[before].arrived - start;
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end' }, { from });
  return first;
}

const texts = Array.from({ length: runs }, (_, i) => `${sentence.slice(0, -1)}, ${'ancora '.repeat(i % 7)}${i + 100} volte.`);
const show = (list) => `${median(list).toFixed(2)} (90 %: ${quantile(list, 0.9).toFixed(2)})`;

/** Measures each text once over HTTP and once on a stream. */
async function round(daemon, voice) {
  const stream = await daemon.stream();
  const socket = [], ask = [];
  for (const text of texts) socket.push(await firstMedia(stream, voice, text));
  // another volume is another cache entry
  for (const text of texts) ask.push(await request(daemon, `/v1/speech?lang=it&voice=${voice}&format=ndjson&volume=0.9`, text));
  await stream.close();
  return { socket, ask };
}

const counts = (daemon, what = 'cache') => Promise.all(['hit', 'miss'].map((result) => daemon.metric(`faccia_${what}_total{result="${result}"}`)));

const report = (what, { socket, ask }) => console.log(`  ${what}: speak to first media ${show(socket)}, POST to first line ${show(ask)} ms`);

const file = path.join(folder, 'cache');
let daemon = await Daemon.start(['--cache-file', file]);
const { voices } = await (await daemon.get('/v1/voices')).json();
const wanted = chosen.length ? chosen : ['espeak:it', 'festival:lp'];
const there = wanted.filter((id) => voices.some((voice) => voice.id === id));
for (const voice of there) {
  await daemon.get(`/v1/speech?lang=it&voice=${voice}`, { method: 'POST', body: 'Prova.', headers: { 'content-type': 'text/plain' } }); // starts the worker
  console.log(`${voice}, ${runs} sentences, medians`);
  report('spoken', await round(daemon, voice));
  const [, before] = await counts(daemon);
  report('from memory', await round(daemon, voice));
  if ((await counts(daemon))[1] !== before) throw new Error('not all of it came from the cache');
}
const idle = [];
for (let i = 0; i < runs; i++) idle.push(await request(daemon, '/healthz'));
console.log(`GET /healthz ${show(idle)} ms`);
await daemon.stop();
daemon = await Daemon.start(['--cache-file', file, '--cache', '0']);
for (const voice of there) {
  console.log(`${voice}, after a restart`);
  report('from the file', await round(daemon, voice));
  if ((await counts(daemon))[1]) throw new Error('not all of it came from the cache');
}
await daemon.stop();
const redis = await Redis.start();
const [one, two] = await Promise.all([0, 1].map(() => Daemon.start(['--cluster', redis.url, '--cache', '0'])));
for (const daemon of [one, two]) await eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === 'up');
for (const voice of there) {
  redis.cli('flushall');
  console.log(`${voice}, two daemons that share`);
  report('spoken by one', await round(one, voice));
  const before = await counts(two, 'cluster_sentences');
  report('from it, by the other', await round(two, voice));
  const now = await counts(two, 'cluster_sentences');
  const sizes = redis.names('*speech').map((name) => Number(redis.cli('strlen', name)));
  console.log(`  ${now[0] - before[0]} of ${now[0] - before[0] + now[1] - before[1]} were there; ${(median(sizes) / 1000).toFixed(0)} kB of Redis for a sentence`);
}
for (const daemon of [one, two]) await daemon.stop();
redis.stop();
agent.destroy();
fs.rmSync(folder, { recursive: true });
