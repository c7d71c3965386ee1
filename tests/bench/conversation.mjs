// SPDX-License-Identifier: GPL-3.0-or-later
// A conversation with pocketsphinx: the time from the end of speech to its words and to the answer, in real time; then as many turns as an hour has, at full
// speed, recorded as a study's session and heard by an operator, with the memory of the daemon, which must stay constant.
// node tests/bench/run.mjs conversation [--turns 360] [--timed 10]
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { Daemon } from '../lib/daemon.mjs';
import { opusOf, POCKETSPHINX, samplesOf, spoken } from '../lib/heard-speech.mjs';
import { kilobytesOf } from './figures.mjs';

const { values } = parseArgs({ options: { turns: { type: 'string', default: '360' }, timed: { type: 'string', default: '10' } } });
const [turns, timed] = [Number(values.turns), Number(values.timed)];
const PACKET_MS = 20, SILENCE_MS = 800; // by which the page knows the end (web/element/audio/endpoint.mjs)
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];

const sessions = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const daemon = await Daemon.start(['--recogniser', POCKETSPHINX, '--sessions', sessions]);
const [screen, desk] = await Promise.all([daemon.stream('?room=kitchen'), daemon.stream('?room=kitchen&watch=1')]);
await screen.wait({ type: 'joined' });
await desk.wait({ type: 'joined' });
const wav = spoken('the second one'), packets = opusOf(wav), sound = samplesOf(wav);
for (const stream of [screen, desk]) stream.send({ type: 'media', audio: 'none', fap: 'none' });
desk.send({ type: 'overhear' });
desk.send({ type: 'consent', consent: 'asked' });
await screen.wait({ type: 'consent', consent: 'asked' });
screen.send({ type: 'consent', consent: 'given' });

/** The recogniser without the daemon, with all of its input at once, start included. @returns milliseconds */
function alone() {
  const from = performance.now();
  execFileSync('sh', ['-c', `cat | ${POCKETSPHINX}`], { input: sound, stdio: ['pipe', 'pipe', 'ignore'] }); // a pipe: node's own is a socket
  return performance.now() - from;
}

/** One turn: asked, heard, answered. @returns milliseconds from the end of speech to the words, and to the answer */
async function turn(id, paced) {
  desk.send({ type: 'ask', id, lang: 'en', text: 'Tea or coffee?', choices: ['Tea', 'Coffee'] });
  await screen.wait({ type: 'choices', id });
  if (!paced) screen.send({ type: 'stop' }); // she is interrupted
  await screen.wait({ type: 'asked', id });
  screen.send({ type: 'hear', id, codec: 'opus', rate: 48000, lang: 'en' });
  const from = performance.now();
  for (const [i, packet] of packets.entries()) {
    screen.socket.send(packet);
    if (paced) await sleep(Math.max(0, from + (i + 1) * PACKET_MS - performance.now()));
  }
  screen.send({ type: 'close', id });
  const end = performance.now();
  await screen.wait({ type: 'heard', id, final: true, text: 'the second one' });
  const words = performance.now() - end;
  await desk.wait({ type: 'answered', id, reason: 'chosen', text: 'Coffee' });
  const answer = performance.now() - end;
  for (const stream of [screen, desk]) stream.messages.length = 0;
  return { words, answer };
}

const times = [];
for (let i = 0; i < timed; i++) times.push(await turn(`timed-${i}`, true));
if (timed) {
  const words = times.map((each) => each.words), answers = times.map((each) => each.answer);
  console.log(`${timed} turns in real time: from the close of the utterance to its words ${median(words).toFixed(0)} ms (most ${Math.max(...words).toFixed(0)}), to the answer ${median(answers).toFixed(0)} ms; ` +
    `pocketsphinx alone, with its start, ${median(Array.from({ length: timed }, alone)).toFixed(0)} ms; hands-free, the page closes it ${SILENCE_MS} ms after the speech`);
}
const began = performance.now(), figures = [];
for (let i = 0; i < turns; i++) {
  await turn(`turn-${i}`, false);
  if ((i + 1) % Math.ceil(turns / 12) === 0) {
    figures.push(kilobytesOf(daemon.process.pid));
    console.log(`${String(i + 1).padStart(5)} turns  ${((performance.now() - began) / 1000).toFixed(0).padStart(5)} s  ${(figures.at(-1) / 1024).toFixed(1)} MB`);
  }
}
if (figures.length > 2) console.log(`memory from turn ${Math.ceil(turns / 12) * 2} on: ${((figures.at(-1) - figures[1]) / 1024).toFixed(2)} MB more`);
desk.send({ type: 'consent', consent: 'none' });
await screen.wait({ type: 'consent', consent: 'none' });
const [name] = fs.readdirSync(sessions);
console.log(`session: ${fs.readdirSync(path.join(sessions, name)).map((file) => `${file} ${(fs.statSync(path.join(sessions, name, file)).size / 1024).toFixed(0)} KB`).join(', ')}`);
await daemon.stop();
fs.rmSync(sessions, { recursive: true });
