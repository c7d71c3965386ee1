// SPDX-License-Identifier: GPL-3.0-or-later
// A day of speech at full speed, and the memory of the daemon and its voices, which must stay constant. POST /v1/speech in all formats,
// some aborted by the client, and sockets that connect, speak, idle, change their mood, stop and leave. No sentence repeats, so a small
// cache turns over all the time.
// Usage: node tests/bench/run.mjs day [--hours 24] [--minutes 10] (ends after that many minutes in any case)
import { parseArgs } from 'node:util';
import WebSocket from 'ws';
import { Daemon } from '../lib/daemon.mjs';
import { childrenOf, kilobytesOf } from './figures.mjs';
import { varied } from './text.mjs';

const { values: options } = parseArgs({ options: { hours: { type: 'string', default: '24' }, minutes: { type: 'string', default: '10' } } });
const [AIM, LIMIT] = [Number(options.hours) * 3600, Number(options.minutes) * 60];
const [POSTS, SOCKETS] = [4, 4]; // concurrent
const MARKS = [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1];
// frequencies: Opus takes more time than all others
const FORMATS = [...Array(14).fill('fapc'), 'fap', 'fap', 'ndjson', 'json', 'wav', 'ogg'];
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

const daemon = await Daemon.start(['--cache', '2']);
const started = performance.now();
const elapsed = () => (performance.now() - started) / 1000;
let [seconds, sentences, posts, left, talks, over] = [0, 0, 0, 0, 0, false];

/** New sentences, made unique by numbers. */
const text = (length) => varied(length, sentences + 1).replace(/\. /g, () => ` ${++sentences}. `);

async function post() {
  const format = FORMATS[posts++ % FORMATS.length];
  const abort = new AbortController();
  const answer = await fetch(`${daemon.url}/v1/speech?lang=it&format=${format}`, { method: 'POST', body: text(600), signal: abort.signal });
  if (!answer.ok) throw new Error(await answer.text());
  if (posts % 23) {
    await answer.arrayBuffer();
    return;
  }
  await answer.body.getReader().read();
  abort.abort();
  left++;
}

/** A client that connects, speaks three times and leaves, every second one in the middle of a word. */
async function talk() {
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?lang=it`, { perMessageDeflate: false });
  const heard = [];
  let told = () => {};
  socket.on('message', (data, binary) => {
    heard.push(binary ? 'media' : JSON.parse(data).type);
    told();
  });
  const until = async (type, from) => {
    while (!heard.slice(from).includes(type)) await new Promise((resolve) => (told = resolve));
  };
  await new Promise((resolve, reject) => socket.on('open', resolve).on('error', reject));
  const send = (message) => socket.send(JSON.stringify(message));
  send({ type: 'idle' });
  for (let i = 0; i < 3; i++) {
    const from = heard.length;
    send({ type: 'speak', text: text(150) });
    await until('begin', from);
    send({ type: 'express', mix: [{ name: ['joy', 'sadness', 'surprise'][i], intensity: 0.5 }] });
    await sleep(150);
    send({ type: 'stop' });
    await until('end', from);
  }
  if (++talks % 2) send({ type: 'speak', text: text(150) });
  const closed = new Promise((resolve) => socket.on('close', resolve));
  socket.close();
  await closed;
}

const repeat = async (act) => {
  while (!over) await act();
};

const workers = new Set(childrenOf(daemon.process.pid));
const began = workers.size;
/** Memory of daemon and voices. A worker that exited was replaced; the log says why. */
function memory() {
  const voices = childrenOf(daemon.process.pid);
  voices.forEach((pid) => workers.add(pid));
  return { daemon: kilobytesOf(daemon.process.pid), voices: voices.reduce((sum, pid) => sum + kilobytesOf(pid), 0) };
}

/** Seconds of speech so far, by the daemon's metric. */
const said = async () => Number((await (await daemon.get('/metrics')).text()).match(/^faccia_speech_seconds_total (\S+)/m)[1]);

const samples = [];
async function watch() {
  console.log('    part   hours said   minutes   posts   talks   daemon kB   voices kB');
  for (const mark of MARKS) {
    let part = 0;
    while (part < mark) {
      await sleep(100);
      seconds = await said();
      part = Math.max(seconds / AIM, elapsed() / LIMIT);
    }
    samples.push({ mark, ...memory() });
    const { daemon: own, voices: theirs } = samples.at(-1);
    console.log([`${(100 * mark).toFixed(0)} %`.padStart(8), (seconds / 3600).toFixed(2).padStart(12), (elapsed() / 60).toFixed(2).padStart(9), String(posts).padStart(7),
      String(talks).padStart(7), String(own).padStart(11), String(theirs).padStart(11)].join(' '));
  }
  over = true;
}

await Promise.all([watch(), ...Array.from({ length: POSTS }, () => repeat(post)), ...Array.from({ length: SOCKETS }, () => repeat(talk))]);
const { code } = await daemon.stop();
const ratio = (name, mark) => (samples.at(-1)[name] / samples.find((sample) => sample.mark === mark)[name]).toFixed(3);
console.log(`\n${(seconds / 3600).toFixed(1)} hours of speech in ${(elapsed() / 60).toFixed(1)} minutes (${(seconds / elapsed()).toFixed(0)} times as fast), ${sentences} sentences, ${left} posts left early`);
for (const name of ['daemon', 'voices'])
  console.log(`memory of the ${name} at the end: ${[0.01, 0.25, 0.5].map((mark) => `${ratio(name, mark)} of that at ${100 * mark} %`).join(', ')}`);
if (workers.size > began) console.log(`${workers.size - began} workers were replaced:\n${daemon.log}`);
if (code) throw new Error(`the daemon ended with ${code}:\n${daemon.log}`);
