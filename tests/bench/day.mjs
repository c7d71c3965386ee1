// SPDX-License-Identifier: GPL-3.0-or-later
// A day of speech in some minutes: does memory stay flat? node tests/bench/day.mjs [HOURS]
// Requests for ten minutes of new text each, in all formats, two at a time; between them a room whose speaker is stopped again
// and again. What is spoken live takes its time; what is asked for by HTTP is made as fast as it goes.
import fs from 'node:fs';
import { Daemon } from '../lib/daemon.mjs';
import { prose } from './text.mjs';

const MINUTES = 10;
const formats = ['wav', 'ogg', 'fap', 'fba', 'json', 'ndjson'];
const hours = Number(process.argv[2] ?? 24);
const daemon = await Daemon.start();

/** Resident memory in MB: of the daemon, and of its voices. */
function memory() {
  const of = (pid) => Number(fs.readFileSync(`/proc/${pid}/status`, 'utf8').match(/VmRSS:\s+(\d+)/)?.[1] ?? 0) / 1000;
  const { pid } = daemon.process;
  const voices = fs.readFileSync(`/proc/${pid}/task/${pid}/children`, 'utf8').trim().split(' ').filter(Boolean);
  return [of(pid), voices.reduce((sum, child) => sum + of(child), 0)];
}

let asked = 0;
/** Ten minutes of sentences that nobody has spoken yet, in the next format; returns the seconds that they take. */
async function speak() {
  const number = asked++;
  let sentences = 0;
  const body = prose(60 * MINUTES).replace(/\. /g, () => `, ${number} ${sentences++}. `);
  const options = { method: 'POST', body, headers: { 'content-type': 'text/plain' } };
  const response = await daemon.get(`/v1/speech?lang=it&format=${formats[number % formats.length]}`, options);
  if (!response.ok) throw new Error(await response.text());
  for await (const _ of response.body);
}

async function interrupt(speaker, id) {
  speaker.send({ type: 'speak', id, lang: 'it', text: `Una frase che si interrompe, la ${id}. ${prose(30)}` });
  if (Number(id) % 2) await speaker.wait({ type: 'word', id });
  speaker.send({ type: 'stop' });
  await speaker.wait({ type: 'end', id });
  speaker.messages.length = speaker.chunks.length = 0;
}

const spoken = async () => Number((await (await daemon.get('/metrics')).text()).match(/^faccia_speech_seconds_total (.*)$/m)[1]) / 3600;
const speaker = await daemon.stream('?room=day');
const listener = await daemon.stream('?room=day&audio=opus&fap=fba');
speaker.send({ type: 'idle', on: true });
await speaker.wait({ type: 'joined' });
const started = performance.now();
const samples = [];
for (let next = 0, at = 0; at < hours; at = await spoken()) {
  await Promise.all([speak(), speak()]);
  for (let i = 0; i < 10; i++) await interrupt(speaker, String(asked * 100 + i));
  listener.messages.length = listener.chunks.length = 0;
  if (at < next) continue;
  next = at + hours / 12;
  const [own, voices] = memory();
  samples.push({ at, own, voices });
  console.log(`${at.toFixed(1).padStart(5)} h: daemon ${own.toFixed(1)} MB, voices ${voices.toFixed(1)} MB`);
}
const took = (performance.now() - started) / 1000;
// the first quarter fills the cache and the allocator's pools
const later = samples.filter(({ at }) => at >= hours / 4);
const growth = (key) => (later.at(-1)[key] - later[0][key]).toFixed(1);
console.log(`${(await spoken()).toFixed(1)} h of speech in ${took.toFixed(0)} s, ${asked} requests; after the first quarter the daemon grew by ${growth('own')} MB, the voices by ${growth('voices')} MB`);
for (const stream of [speaker, listener]) await stream.close();
await daemon.stop();
