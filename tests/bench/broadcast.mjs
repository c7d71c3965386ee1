// SPDX-License-Identifier: GPL-3.0-or-later
// One speaker in a room with many listeners: CPU time of the daemon per delivered message, beside a minimal libwebsockets program (ring.c)
// that sends the same messages at the same times to as many. Both run on core 0, the listeners on core 1. CPU times come from the kernel's
// scheduler, so other load hardly affects them. (Installs libwebsockets-dev for the ring.)
// Usage: node tests/bench/run.mjs broadcast [LISTENERS]... (1 100 1000 5000; ulimit -n must allow them)
import { execFileSync, spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { once } from 'node:events';
import readline from 'node:readline';
import { Daemon } from '../lib/daemon.mjs';
import { cpuOf, kilobytesOf } from './figures.mjs';
import { needProgram } from './need.mjs';
import { sentence } from './text.mjs';

const counts = process.argv.length > 2 ? process.argv.slice(2).map(Number) : [1, 100, 1000, 5000];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-broadcast-'));
const text = `${sentence} `.repeat(2);
const listeners = needProgram('listeners');
const bareRing = needProgram('ring', 'libwebsockets-dev', 'libwebsockets-evlib-uv');
const pin = (pid, core) => execFileSync('taskset', ['-a', '-c', '-p', String(core), String(pid)]);

/** Runs listeners while `start` makes the process speak. */
async function listen({ pid, port, count, address, start, record = [] }) {
  const before = kilobytesOf(pid);
  const child = spawn('taskset', ['-c', '1', listeners, String(port), address, String(count), ...record], { stdio: ['pipe', 'pipe', 'inherit'] });
  const ended = once(child, 'exit');
  const lines = readline.createInterface(child.stdout)[Symbol.asyncIterator]();
  const line = async () => {
    const { value, done } = await lines.next();
    if (done) throw new Error('the listeners ended');
    return value;
  };
  await line();
  const memory = (kilobytesOf(pid) - before) / count;
  const used = cpuOf(pid);
  await start();
  const heard = JSON.parse(await line());
  const seconds = cpuOf(pid) - used;
  child.stdin.end();
  await ended;
  return { ...heard, memory, cpu: seconds, each: (1e6 * seconds) / heard.messages };
}

/** Measures listeners of the daemon's speech, then of the same messages from the ring. */
async function compare(count) {
  const file = path.join(folder, `${count}.messages`);
  const daemon = await Daemon.start(['--max-connections', String(count + 10)]);
  pin(daemon.process.pid, 0);
  const own = await listen({
    pid: daemon.process.pid, port: daemon.port, count, address: '/v1/stream?room=bench', record: [file],
    start: async () => {
      const answer = await fetch(`${daemon.url}/v1/say?room=bench&lang=it`, { method: 'POST', body: text });
      if (answer.status !== 202) throw new Error(await answer.text());
    },
  });
  await daemon.stop();

  const ring = spawn('taskset', ['-c', '0', bareRing, file], { stdio: ['ignore', 'pipe', 'inherit'] });
  const ended = once(ring, 'exit');
  const port = String((await once(ring.stdout, 'data'))[0]).trim();
  const reference = await listen({ pid: ring.pid, port, count, address: '/', start: () => ring.kill('SIGUSR1') });
  ring.kill();
  await ended;
  return { own, reference };
}

console.log('CPU per delivered message, us (facciad: with the making of the speech, which is the same for all; beyond the first: without it)');
console.log('ms after the first listener had a message: half, 99 %, last; memory of an idle listener, kB');
console.log('listeners          messages  bytes each    CPU us  beyond the first      half      99 %      last    memory');
const beyond = (now, one) => (1e6 * (now.cpu - one.cpu)) / (now.messages - one.messages);
let least;
for (const count of counts) {
  const now = await compare(count);
  const rest = {};
  for (const [name, r] of Object.entries(now)) {
    if (least) rest[name] = beyond(r, least[name]);
    console.log([String(count).padStart(9), (name === 'own' ? 'facciad' : 'ring').padEnd(8), String(r.messages).padStart(8), (r.bytes / r.messages).toFixed(0).padStart(10),
      r.each.toFixed(2).padStart(10), (least ? rest[name].toFixed(2) : '-').padStart(16),
      ...[r.p50, r.p99, r.max].map((ms) => ms.toFixed(2).padStart(10)), r.memory.toFixed(1).padStart(9)].join(' '));
  }
  const ratio = (a, b) => (a / b).toFixed(2);
  console.log(`${''.padStart(9)} ratio of CPU ${ratio(now.own.each, now.reference.each)}${least ? `, beyond the first ${ratio(rest.own, rest.reference)}` : ''}`);
  least ??= now;
}
fs.rmSync(folder, { recursive: true });
