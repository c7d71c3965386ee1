// SPDX-License-Identifier: GPL-3.0-or-later
// One speaker in a room to many listeners: all of them at one daemon, and as many at several that share the room by Redis. What
// the processors do for it in all (daemons and Redis, in making, sending and handing on), and how much later than the first listener of
// all a listener has a message. Daemons and Redis on core 0, the listeners on core 1; the two in turns.
// Usage: node tests/bench/cluster-rooms.mjs [LISTENERS [DAEMONS [TURNS]]] (4000 4 3; ulimit -n must allow them)
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import readline from 'node:readline';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { Redis } from '../lib/redis.mjs';
import { cpuOf } from './figures.mjs';
import { needProgram } from './need.mjs';
import { sentence } from './text.mjs';

const [count = 4000, several = 4, turns = 3] = process.argv.slice(2).map(Number);
const text = `${sentence} `.repeat(3);
const listeners = needProgram('listeners');
const pin = (pid) => execFileSync('taskset', ['-a', '-c', '-p', '0', String(pid)]);

async function turn(daemonCount) {
  const redis = daemonCount > 1 ? await Redis.start() : null;
  const options = ['--max-connections', String(count + 20), ...(redis ? ['--cluster', redis.url] : [])];
  const daemons = [];
  for (let i = 0; i < daemonCount; i++) daemons.push(await Daemon.start(options));
  if (redis) for (const daemon of daemons) await eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === 'up', 'the cluster');
  const pids = [...daemons.map((daemon) => daemon.process.pid), ...(redis ? [redis.process.pid] : [])];
  pids.forEach(pin);
  const child = spawn('taskset', ['-c', '1', listeners, daemons.map(({ port }) => port).join(','), '/v1/stream?room=bench', String(count)], { stdio: ['pipe', 'pipe', 'inherit'] });
  const ended = once(child, 'exit');
  const lines = readline.createInterface(child.stdout)[Symbol.asyncIterator]();
  const line = async () => (await lines.next()).value;
  if ((await line()) !== 'ready') throw new Error('the listeners ended');
  // the home knows of all
  await eventually(async () => {
    const rooms = await Promise.all(daemons.map(async (daemon) => (await (await daemon.get('/v1/rooms')).json()).rooms[0]?.listeners ?? 0));
    return Math.max(...rooms) === count;
  }, 'all to listen');
  const before = pids.map(cpuOf);
  const answer = await daemons.at(-1).get('/v1/say?room=bench&lang=it', { method: 'POST', body: text });
  if (answer.status !== 202) throw new Error(await answer.text());
  const heard = JSON.parse(await line());
  const used = pids.map((pid, i) => cpuOf(pid) - before[i]);
  const sent = redis ? (await Promise.all(daemons.map((daemon) => daemon.metric('faccia_bus_messages_total{way="sent"}')))).reduce((a, b) => a + b) : 0;
  child.stdin.end();
  await ended;
  for (const daemon of daemons) await daemon.stop();
  redis?.stop();
  const sum = (list) => list.reduce((a, b) => a + b, 0);
  return { ...heard, sent, all: sum(used), redis: redis ? used.at(-1) : 0 };
}

console.log(`${count} listeners, the same speech to all; ms after the first listener of all had a message`);
console.log('daemons   messages   CPU s  of it Redis   half   99 %   last   sent on the bus');
const ratios = [];
for (let i = 0; i < turns; i++) {
  const [one, more] = [await turn(1), await turn(several)];
  for (const [daemons, r] of [[1, one], [several, more]])
    console.log([String(daemons).padStart(7), String(r.messages).padStart(10), r.all.toFixed(3).padStart(7), r.redis.toFixed(4).padStart(12), ...[r.p50, r.p99, r.max].map((ms) => ms.toFixed(1).padStart(6)), String(r.sent).padStart(10)].join(' '));
  ratios.push(more.all / one.all);
  console.log(`        CPU ratio ${ratios.at(-1).toFixed(3)}, Redis ${((100 * more.redis) / one.all).toFixed(2)} % of the one daemon's, 99 % later by ${(more.p99 - one.p99).toFixed(1)} ms`);
}
process.exit(0);
