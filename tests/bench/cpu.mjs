// SPDX-License-Identifier: GPL-3.0-or-later
// CPU seconds per second of speech: the daemon with its voice worker, streaming PCM and FAPs in real time to several clients, beside
// the espeak-ng program writing the same speech to WAV files. They take turns, so that other load affects both; the ratio is the median
// over the turns. Clients only count bytes, because computing would evict the daemon's data from the CPU caches at its expense.
// Usage: node tests/bench/run.mjs cpu [CLIENTS] [SECONDS] [TURNS]
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import WebSocket from 'ws';
import { Daemon } from '../lib/daemon.mjs';
import { childrenOf, median } from './figures.mjs';
import { needPackages } from './need.mjs';
import { prose } from './text.mjs';

const clients = Number(process.argv[2] ?? 40);
const seconds = Number(process.argv[3] ?? 30);
const turns = Number(process.argv[4] ?? 5);
const text = prose(seconds);
needPackages('espeak-ng');

/** CPU time of the reference by the shell's accounting. */
function reference() {
  const out = execFileSync('bash', ['-c', 'for i in $(seq "$1"); do espeak-ng -v it -w /dev/null -- "$2"; done; times', '-', String(clients), text]).toString();
  const [user, system] = out.trim().split('\n').at(-1).split(' ').map((t) => {
    const [, minutes, rest] = t.match(/(\d+)m([\d.]+)s/);
    return Number(minutes) * 60 + Number(rest);
  });
  return user + system;
}

/** CPU seconds of a process: {user, kernel}. */
function used(pid) {
  const stat = fs.readFileSync(`/proc/${pid}/stat`, 'latin1');
  const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
  return { user: Number(fields[11]) / 100, kernel: Number(fields[12]) / 100 };
}

const daemon = await Daemon.start(['--cache', '0']);
const voices = childrenOf(daemon.process.pid);
const parts = () => {
  const sum = { user: used(daemon.process.pid).user, kernel: used(daemon.process.pid).kernel, voices: 0 };
  for (const pid of voices) sum.voices += used(pid).user + used(pid).kernel;
  return sum;
};
const sockets = await Promise.all(Array.from({ length: clients }, () => new Promise((resolve, reject) => {
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?lang=it&voice=espeak:it&audio=pcm&fap=plain`, { perMessageDeflate: false });
  socket.on('open', () => resolve(socket)).on('error', reject);
})));

/** Lets all clients speak. Returns the seconds of speech. */
async function speak() {
  const ends = await Promise.all(sockets.map((socket) => new Promise((resolve) => {
    const hear = (data, binary) => {
      if (binary || !data.includes('"type":"end"')) return;
      socket.off('message', hear);
      resolve(JSON.parse(data).duration);
    };
    socket.on('message', hear);
    socket.send(JSON.stringify({ type: 'speak', text }));
  })));
  return ends.reduce((sum, duration) => sum + duration, 0);
}

const rows = [];
for (let turn = 0; turn < turns; turn++) {
  const before = parts();
  const speech = await speak();
  const after = parts();
  const alone = reference();
  const each = Object.fromEntries(Object.keys(after).map((name) => [name, ((after[name] - before[name]) / speech) * 1000]));
  rows.push({ speech, ...each, ours: each.user + each.kernel + each.voices, alone: (alone / speech) * 1000 });
}
await daemon.stop();
const of = (name) => median(rows.map((row) => row[name])).toFixed(2);
const ratios = rows.map(({ ours, alone }) => ours / alone);
console.log(`${clients} clients, ${turns} turns of ${rows[0].speech.toFixed(0)} s of speech, medians: faccia ${of('ours')} ms of CPU for each second ` +
  `(voice ${of('voices')}, daemon ${of('user')}, kernel ${of('kernel')}), espeak-ng ${of('alone')} ms`);
console.log(`ratio ${median(ratios).toFixed(2)} (${Math.min(...ratios).toFixed(2)} to ${Math.max(...ratios).toFixed(2)})`);
