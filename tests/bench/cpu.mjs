// SPDX-License-Identifier: GPL-3.0-or-later
// CPU seconds for each second of speech: the whole daemon with its voice worker, streaming PCM and FAPs in real time to several
// clients at once, next to the espeak-ng program that writes the same speech to WAV files, in one run.
// Usage: node tests/bench/cpu.mjs [CLIENTS] [SECONDS]
import { execFileSync } from 'node:child_process';
import { Daemon } from '../lib/daemon.mjs';
import { cpuSeconds } from './figures.mjs';
import { prose } from './text.mjs';

const clients = Number(process.argv[2] ?? 40);
const seconds = Number(process.argv[3] ?? 30);
const text = prose(seconds);

// the shell's own accounting of what it has started
const reference = () => {
  const out = execFileSync('bash', ['-c', 'for i in $(seq "$1"); do espeak-ng -v it -w /dev/null -- "$2"; done; times', '-', String(clients), text]).toString();
  const [user, system] = out.trim().split('\n').at(-1).split(' ').map((t) => {
    const [, minutes, rest] = t.match(/(\d+)m([\d.]+)s/);
    return Number(minutes) * 60 + Number(rest);
  });
  return user + system;
};

const daemon = await Daemon.start(['--cache', '0']);
const idle = cpuSeconds(daemon.process.pid);
const streams = await Promise.all(Array.from({ length: clients }, () => daemon.stream()));
streams.forEach((stream) => stream.send({ type: 'speak', lang: 'it', voice: 'espeak:it', text }));
const ends = await Promise.all(streams.map((stream) => stream.wait({ type: 'end' }, { milliseconds: seconds * 4000 + 20000 })));
const ours = cpuSeconds(daemon.process.pid) - idle;
const speech = ends.reduce((sum, end) => sum + end.duration, 0);
await daemon.stop();
const alone = reference();
console.log(`${clients} clients, ${speech.toFixed(0)} s of speech: faccia ${((ours / speech) * 1000).toFixed(2)} ms of CPU for each second, ` +
  `espeak-ng ${((alone / speech) * 1000).toFixed(2)} ms, ratio ${(ours / alone).toFixed(2)}`);
