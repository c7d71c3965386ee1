// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings at other rates: accuracy of pitch and times, for a person (Debian's asterisk-core-sounds-it and
// -it-wav) and a synthetic voice.
// node tests/bench/run.mjs tempo [PROMPTS, 30] [person|voice, both]
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build } from '../lib/daemon.mjs';
import { madeOf, prompts } from '../lib/prompts.mjs';
import { say } from '../lib/speech.mjs';
import { compareTempo } from '../lib/tempo.mjs';
import { manzoni } from '../lib/texts.mjs';
import { wavOf } from '../lib/wav.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const file = (name) => path.join(folder, name);
const chosen = prompts().slice(0, Number(process.argv[2] ?? 30)), person = madeOf(chosen);
const texts = { person: chosen.map(({ text }) => text.replace(/[.!?]*\s*$/, '.')).join('\n'), voice: manzoni };
const voice = say(['-l', 'it', '-v', 'festival:pc'], manzoni);
const sounds = { person, voice };
for (const [name, { pcm, rate }] of Object.entries(sounds)) {
  fs.writeFileSync(file(`${name}.wav`), wavOf(pcm, rate));
  fs.writeFileSync(file(`${name}.txt`), texts[name]);
  const { stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['align', file(`${name}.wav`), '--text', file(`${name}.txt`), '-l', 'it', '--json', file(`${name}.timing.json`)]);
  if (`${stderr}`) console.log(`${name}: ${`${stderr}`.trim().split('\n').length} remarks of the alignment`);
}
fs.writeFileSync(file('config.json'), JSON.stringify({ recording: { folder, seconds: 300 } }));
const env = { FACCIA_VOICE_CONFIG: file('config.json'), FACCIA_DEADLINE_BASE: '400' };
console.log('        speed  duration  pitch off (places)   off in time: median, most   phones off, most');
for (const name of process.argv[3] ? [process.argv[3]] : Object.keys(sounds)) {
  const own = say(['-v', `recording:${name}`], texts[name], env);
  if (own.status !== 0) throw new Error(own.stderr);
  const pace = Math.trunc(texts[name].match(/[\p{L}\p{N}]+/gu).length / (sounds[name].pcm.length / sounds[name].rate / 60)); // like the plugin
  for (const speed of [0.5, 0.7, 0.85, 1.15, 1.3, 1.6, 2]) {
    const rate = Math.round(pace * speed), real = rate / pace, is = say(['-v', `recording:${name}`, '-r', String(rate)], texts[name], env);
    const c = compareTempo(own, is, real);
    const phones = Math.max(...own.json.phones.map((p, i) => Math.abs(is.json.phones[i].start * real - p.start)));
    console.log(`${name.padEnd(7)} ${real.toFixed(3)}  ${c.duration.toFixed(4)}    ${(100 * c.pitch).toFixed(2)} % (${c.pitches})`.padEnd(45),
      `${(1000 * c.lag).toFixed(0)}, ${(1000 * c.most).toFixed(0)} ms`.padEnd(20), `${(1000 * phones).toFixed(0)} ms`);
  }
}
fs.rmSync(folder, { recursive: true });
