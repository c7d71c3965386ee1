// SPDX-License-Identifier: GPL-3.0-or-later
// Quality loss by coding: the daemon's coder at several bit rates, beside known distortions, by voice, as measured by likeness.mjs.
// Usage: node tests/bench/run.mjs sound [VOICE]... (default: espeak:it and Festival's LP)
import { execFileSync, spawnSync } from 'node:child_process';
import { Daemon } from '../lib/daemon.mjs';
import { likeness } from './likeness.mjs';
import { needProgram } from './need.mjs';
import { sentence, varied } from './text.mjs';

const LEVELS = 5;
const RATES = [8000, 10000, 12000, 14000, 16000, 20000, 24000, 32000, 64000];
const text = `${sentence} ${varied(500, 3)}`;

const program = needProgram('sound');
const daemon = await Daemon.start();
const { voices } = await (await daemon.get('/v1/voices')).json();
const wanted = process.argv.length > 2 ? process.argv.slice(2) : ['espeak:it', 'festival:lp'];

const raw = (rate) => ['-t', 's16', '-c', '1', '-r', String(rate)];
/** Converts 16-bit mono sound with sox: sample rate, effects. */
const sox = (pcm, from, to, ...effects) => execFileSync('sox', ['-G', ...raw(from), '-', ...raw(to), '-', ...effects], { input: pcm, maxBuffer: 1 << 28 });
const samples = (pcm) => Float64Array.from(new Int16Array(pcm.buffer.slice(pcm.byteOffset, pcm.byteOffset + (pcm.length & ~1))));

/** Adds white noise at that many dB below the sound. */
function noisy(sound, decibels) {
  const power = sound.reduce((sum, x) => sum + x * x, 0) / sound.length;
  const scale = Math.sqrt((3 * power) / 10 ** (decibels / 10));
  let state = 1;
  return sound.map((x) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return x + scale * (state / 2 ** 31 - 1);
  });
}

for (const id of wanted) {
  const voice = voices.find((v) => v.id === id);
  if (!voice) continue;
  const answer = await daemon.get(`/v1/speech?lang=${voice.lang}&voice=${encodeURIComponent(id)}`, { method: 'POST', body: text, headers: { 'content-type': 'text/plain', connection: 'close' } });
  const wav = Buffer.from(await answer.arrayBuffer());
  const [rate, pcm] = [wav.readUInt32LE(24), wav.subarray(44)];
  const seconds = pcm.length / 2 / rate;
  const original = samples(sox(pcm, rate, 48000));
  const top = Math.min(rate / 2, 12000);
  console.log(`${id}, ${rate} Hz, ${seconds.toFixed(0)} s; bands up to ${top} Hz`);
  const show = (name, sound, bits = '') => {
    const { nsim, off } = likeness(original, sound, top);
    console.log(`  ${name.padEnd(34)} ${bits.padStart(8)}  likeness ${nsim.toFixed(4)}  bands off by ${off.toFixed(2)} dB`);
  };
  show('itself', original);
  show('one sample later', Float64Array.from([0, ...original]));
  show('1 dB softer', original.map((x) => x * 0.891));
  for (const decibels of [50, 40, 30, 20]) show(`noise ${decibels} dB below`, noisy(original, decibels));
  for (const hertz of [8000, 6000, 4000, 3000])
    if (hertz < rate / 2) show(`nothing above ${hertz} Hz`, samples(sox(pcm, rate, 48000, 'sinc', `-${hertz}`)));
  const code = (name, ...args) => {
    const coded = spawnSync(program, [rate, ...args].map(String), { input: pcm, maxBuffer: 1 << 28 });
    if (coded.status) throw new Error(String(coded.stderr));
    const [bytes, ms] = String(coded.stderr).split(' ').map(Number);
    show(`${name}, ${(ms / seconds).toFixed(1)} ms/s`, samples(coded.stdout), `${((bytes * 8) / seconds / 1000).toFixed(1)} kbit`);
  };
  for (const bitrate of RATES) code(`Opus at ${bitrate / 1000} kbit/s`, bitrate);
  for (let level = 0; level < LEVELS; level++) code(`level ${level} of coder_pool.h`, 0, level);
}
await daemon.stop();
