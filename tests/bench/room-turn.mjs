// SPDX-License-Identifier: GPL-3.0-or-later
// One utterance in a room with many listeners on several daemons that share it over Redis, or on one: total CPU time, and the delay of
// listeners after the first listener of all.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import readline from 'node:readline';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { Redis } from '../lib/redis.mjs';
import { childrenOf, cpuOf, waitOf } from './figures.mjs';
import { needProgram } from './need.mjs';

const sum = (list) => list.reduce((a, b) => a + b, 0);
const pin = (pid) => execFileSync('taskset', ['-a', '-c', '-p', '0', String(pid)]);

/** Starts one daemon alone, or several that share a Redis. */
export async function startDaemons(count, options) {
  const redis = count > 1 ? await Redis.start() : null;
  const daemons = [];
  for (let i = 0; i < count; i++) daemons.push(await Daemon.start([...options, ...(redis ? ['--cluster', redis.url] : [])]));
  if (redis) for (const daemon of daemons) await eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === 'up', 'the cluster');
  return { redis, daemons };
}

/**
 * Runs daemons and Redis on core 0, the listeners on core 1. restSeconds: how long to measure idle daemons; `rest` is their idle CPU time scaled
 * to the duration of the speech. CPU seconds: `all` of daemons and Redis, `redis`, `clients` of the listeners. `took`: seconds from the request
 * until all had the end; `waited`: longest time in it that a daemon or Redis waited for a processor. `homes`: how often a daemon became the
 * room's leader; more than once means that the room split.
 */
export async function roomTurn(daemonCount, count, text, restSeconds = 0) {
  const listeners = needProgram('listeners');
  const { redis, daemons } = await startDaemons(daemonCount, ['--max-connections', String(count + 20)]);
  const pids = [...daemons.map((daemon) => daemon.process.pid), ...(redis ? [redis.process.pid] : [])];
  pids.forEach(pin);
  const child = spawn('taskset', ['-c', '1', listeners, daemons.map(({ port }) => port).join(','), '/v1/stream?room=bench', String(count)], { stdio: ['pipe', 'pipe', 'inherit'] });
  const ended = once(child, 'exit');
  const lines = readline.createInterface(child.stdout)[Symbol.asyncIterator]();
  const line = async () => (await lines.next()).value;
  if ((await line()) !== 'ready') throw new Error('the listeners ended');
  // until the leader knows of all listeners
  await eventually(async () => {
    const rooms = await Promise.all(daemons.map(async (daemon) => (await (await daemon.get('/v1/rooms')).json()).rooms[0]?.listeners ?? 0));
    return Math.max(...rooms) === count;
  }, 'all to listen');
  const atRest = pids.map(cpuOf), restFrom = performance.now();
  if (restSeconds) await new Promise((resolve) => setTimeout(resolve, 1000 * restSeconds));
  const clientPids = childrenOf(child.pid);
  const before = pids.map(cpuOf), waitedBefore = pids.map(waitOf), clientsBefore = clientPids.map(cpuOf), from = performance.now();
  const answer = await daemons.at(-1).get('/v1/say?room=bench&lang=it', { method: 'POST', body: text });
  if (answer.status !== 202) throw new Error(await answer.text());
  const heard = JSON.parse(await line());
  const used = pids.map((pid, i) => cpuOf(pid) - before[i]), took = performance.now() - from;
  const waited = Math.max(...pids.map((pid, i) => waitOf(pid) - waitedBefore[i]));
  const clients = sum(clientPids.map((pid, i) => cpuOf(pid) - clientsBefore[i]));
  const sent = redis ? sum(await Promise.all(daemons.map((daemon) => daemon.metric('faccia_bus_messages_total{way="sent"}')))) : 0;
  child.stdin.end();
  await ended;
  for (const daemon of daemons) await daemon.stop();
  redis?.stop();
  const homes = redis ? sum(daemons.map(({ log }) => log.split('spoken by this daemon from now on').length - 1)) : 1;
  const rest = restSeconds ? (sum(before.map((value, i) => value - atRest[i])) * took) / (from - restFrom) : 0;
  return { ...heard, sent, all: sum(used), redis: redis ? used.at(-1) : 0, rest, clients, took: took / 1000, waited, homes };
}
