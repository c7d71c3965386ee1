// SPDX-License-Identifier: GPL-3.0-or-later
// Each voice plugin beside its engine's own program, on the same text in one run: speed relative to real time, latency to the first
// audio of a sentence in a running daemon, and memory.
// Usage: node tests/bench/run.mjs voices [SECONDS OF TEXT] [VOICE]...
import { spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build, Daemon } from '../lib/daemon.mjs';
import { median } from './figures.mjs';
import { needPackages, needProgram } from './need.mjs';
import { prose, sentence } from './text.mjs';

needPackages('espeak-ng', 'festival', 'time');
const seconds = Number(process.argv[2] ?? 60);
const chosen = process.argv.slice(3);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const wav = path.join(folder, 'bare.wav');

// Engines by voice: a command that reads the file `text` and writes the file `wav`.
const festival = (voice) => (text) => ['text2wave', '-eval', `(voice_${voice})`, '-o', wav, text];
const engines = {
  'espeak:it': (text) => ['espeak-ng', '-v', 'it', '-w', wav, '-f', text],
  'festival:lp': festival('lp_diphone'),
  'festival:pc': festival('pc_diphone'),
};
const daemon = await Daemon.start(['--cache', '0']);
const { voices } = await (await daemon.get('/v1/voices')).json();
const bare = path.join(build, 'tests/bench/bench_kokoro_bare');
if (voices.some((voice) => voice.id === 'kokoro:if_sara')) {
  needProgram('kokoro_bare');
  engines['kokoro:if_sara'] = (text) => [bare, 'if_sara', text]; // the same graph; prints its measurements
}

/** Runs a program: {wall: seconds, memory: peak in MB, told: printed numbers}. */
function run(argv) {
  return new Promise((resolve, reject) => {
    const start = performance.now();
    const child = spawn('/usr/bin/time', ['-f', '%M', ...argv], { stdio: ['ignore', 'pipe', 'pipe'] });
    let text = '', said = '';
    child.stdout.on('data', (data) => (said += data));
    child.on('error', reject);
    child.stderr.on('data', (data) => (text += data));
    child.on('close', () => resolve({ wall: (performance.now() - start) / 1000, memory: Number(text.trim().split('\n').at(-1)) / 1024, told: said.trim().split(/\s+/).map(Number) }));
  });
}

const durationOf = (file) => {
  const bytes = fs.readFileSync(file);
  return (bytes.length - 44) / bytes.readUInt32LE(28);
};

/** Peak memory of the plugin's worker and its children, MB. */
function memoryOf(daemon, plugin) {
  const processes = fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name)).flatMap((name) => {
    try {
      const status = fs.readFileSync(`/proc/${name}/status`, 'latin1');
      const field = (key) => Number(status.match(new RegExp(`^${key}:\\s+(\\d+)`, 'm'))?.[1] ?? 0);
      return [{ pid: Number(name), parent: field('PPid'), peak: field('VmHWM') / 1024, command: fs.readFileSync(`/proc/${name}/cmdline`, 'latin1') }];
    } catch {
      return []; // it has just ended
    }
  });
  const below = (p) => [p, ...processes.filter((q) => q.parent === p.pid).flatMap(below)];
  return processes.filter((p) => p.parent === daemon.process.pid && p.command.includes(`/${plugin}.so`)).flatMap(below).reduce((sum, p) => sum + p.peak, 0);
}

async function firstAudio(daemon, voice) {
  const times = [];
  const stream = await daemon.stream();
  for (let i = 0; i < 12; i++) {
    const before = stream.chunks.length;
    const start = performance.now();
    stream.send({ type: 'speak', lang: 'it', voice, id: `u${i}`, text: `${sentence.slice(0, -1)}, ${"ancora ".repeat(i % 6)}${i > 5 ? "e poi" : "poi"} basta.` }); // each text is unique, because of the cache
    await stream.until(() => stream.chunks.length > before, 60000);
    times.push(performance.now() - start);
    stream.send({ type: 'stop' });
    await stream.wait({ type: 'end', id: `u${i}` });
  }
  await stream.close();
  return { first: times[0], usual: median(times.slice(2)) };
}

const text = path.join(folder, 'text');
const latin = path.join(folder, 'text.latin1');
fs.writeFileSync(text, prose(seconds));
fs.writeFileSync(latin, prose(seconds).replace(/[’‘]/g, "'"), 'latin1');
for (const [voice, program] of Object.entries(engines).filter(([voice]) => !chosen.length || chosen.includes(voice))) {
  const file = path.join(folder, 'faccia.wav');
  const ours = await run([path.join(build, 'server/cli/faccia'), 'say', '-l', 'it', '-v', voice, '--wav', file, '-f', text]);
  const alone = await run(program(voice.startsWith('festival') ? latin : text));
  const audio = await firstAudio(daemon, voice);
  const name = path.basename(program(text)[0]);
  const speed = (run, seconds) => `${(seconds / run.wall).toPrecision(3)} x real time`;
  const first = voice.startsWith('kokoro') ? `, first piece after ${(1000 * alone.told[2]).toFixed(0)} ms` : '';
  console.log(`${voice}: faccia with face ${speed(ours, durationOf(file))}, ${name} ${speed(alone, first ? alone.told[0] : durationOf(wav))}${first}, ` +
    `first audio ${audio.usual.toFixed(1)} ms (the first time ${audio.first.toFixed(0)} ms), ` +
    `worker ${memoryOf(daemon, voice.split(':')[0]).toFixed(0)} MB, ${name} ${alone.memory.toFixed(0)} MB`);
}
await daemon.stop();
fs.rmSync(folder, { recursive: true });
