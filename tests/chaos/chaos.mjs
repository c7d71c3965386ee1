// SPDX-License-Identifier: GPL-3.0-or-later
// See run.sh. Speakers request more than can be spoken, half of them with `again`; listeners join at any daemon, and rejoin elsewhere
// when theirs goes.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { setTimeout as sleep } from 'node:timers/promises';
import WebSocket from 'ws';
import { Chance } from '../lib/chaos.mjs';
import { build, Daemon } from '../lib/daemon.mjs';
import { Redis } from '../lib/redis.mjs';
import { Worker } from '../lib/worker.mjs';
import { Checker, Ear } from './checker.mjs';
import { clocksIn } from './clocks.mjs';
import { faultsOf } from './faults.mjs';
import { SlowRoad } from './slow-road.mjs';
import { waysOf } from './ways.mjs';

// run.sh creates the network and the disk, if the machine allows it
if (!process.env.FACCIA_CHAOS_PLACE) {
  const run = spawn('sh', [path.join(import.meta.dirname, 'run.sh'), ...process.argv.slice(2)], { stdio: 'inherit' });
  process.exit((await once(run, 'exit'))[0] ?? 1);
}
const type = 'string';
const { values, positionals } = parseArgs({ allowPositionals: true, options: { minutes: { type }, speakers: { type }, listeners: { type }, seed: { type }, only: { type } } });
const [minutes, speakers, listeners, seed] = [['minutes', 10], ['speakers', 200], ['listeners', 2000], ['seed', Date.now() % 1e6]].map(([name, otherwise], i) => Number(values[name] ?? positionals[i] ?? otherwise));
if ([minutes, speakers, listeners, seed].some((number) => !(number >= 0))) {
  console.error('minutes, speakers, listeners and seed are numbers: see run.sh --help');
  process.exit(2);
}
const DAEMONS = 4, WORKERS = 2, SUSPECT_MS = 30000, ROOMS = Math.max(1, Math.round(speakers / 10)), SETTLE_MS = 60000;
const TEXTS = ['Buongiorno.', 'Il vento porta via le foglie del viale.', 'Uno, due. E tre.', 'La mamma parla piano.'];
const disk = process.env.FACCIA_CHAOS_DISK || null;
const logs = process.env.FACCIA_CHAOS_LOGS; // a folder for the daemons' logs
const chance = new Chance(seed);
const checker = new Checker();
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-chaos-'));
const plugin = (name) => {
  const at = path.join(folder, name);
  fs.mkdirSync(at);
  fs.symlinkSync(path.join(build, `server/plugins/${name}.so`), path.join(at, `${name}.so`));
  return at;
};
const near = plugin('espeak'), far = plugin('command');
const config = path.join(folder, 'voices.json');
fs.writeFileSync(config, JSON.stringify({ command: { voices: [{ id: 'dear', lang: 'it', raw: 16000, argv: ['sh', '-c', 'sleep 0.1; head -c 24000 /dev/zero', 'sh', '{text}'] }] } }));

const clocks = clocksIn(folder);
const redis = await Redis.start({ env: clocks?.env('redis', 'redis-server') });
const ways = waysOf(redis.port);
const road = await SlowRoad.open(redis.port);
let made = 0, over = false, quiet = false;
const codes = {}, started = [], speaking = new Set();
const world = {
  redis, road, disk, ways, clocks,
  startDaemon: async (at) => {
    const cache = disk ? ['--cache-file', path.join(disk, `cache-${made++ % (2 * DAEMONS)}`)] : [];
    const daemon = await Daemon.start(['--cluster', road.url, '--plugins', near, '--max-connections', '10000', ...(logs ? ['--log', 'json'] : []), ...cache], clocks?.env(at, 'facciad'));
    started.push(daemon);
    return daemon;
  },
  startWorker: () => Worker.start(['--cluster', road.url, '--plugins', far, '--voice-config', config, '--sandbox', 'off']),
};
world.daemons = await Promise.all(Array.from({ length: DAEMONS }, (_, at) => world.startDaemon(at)));
world.workers = await Promise.all(Array.from({ length: WORKERS }, world.startWorker));

const roomOf = (i) => `room-${i % ROOMS}`;
/** Connects to a running daemon; null if that fails. */
async function enter(room, query) {
  const { port, process: child } = world.daemons[chance.below(DAEMONS)];
  if (child.exitCode !== null || child.signalCode) return null;
  const socket = new WebSocket(`ws://127.0.0.1:${port}/v1/stream?lang=it&room=${room}${query}`, { perMessageDeflate: false, handshakeTimeout: 8000 });
  const closed = new Promise((resolve) => socket.on('close', resolve));
  socket.on('error', () => {});
  return { socket, closed, port };
}

/** The connection lasts until its daemon dies. It does not notice a frozen daemon, and clients do not give up by themselves. */
async function speak(i) {
  const room = roomOf(i);
  for (let number = 0; !over; ) {
    const way = await enter(room, '&audio=none&fap=none&watch=1');
    if (!way) {
      await sleep(200);
      continue;
    }
    const waiting = new Map(), mine = new Set(); // mine: requested on this connection; another connection of the speaker also receives the room's end events
    speaking.add(way);
    let joined = false, wake = () => {};
    way.socket.on('message', (data, binary) => {
      if (binary) return;
      const message = JSON.parse(data);
      if (message.type === 'joined') joined = true;
      if (message.type === 'error' && message.id?.startsWith(`s${i}-`)) codes[message.code] = (codes[message.code] ?? 0) + 1;
      if (message.type === 'end' && mine.has(message.id)) {
        checker.answer(message.id, message.reason);
        waiting.delete(message.id);
      }
      wake();
    });
    let open = true;
    way.closed.then(() => {
      open = false;
      wake();
    });
    while (open && !(over && !waiting.size)) {
      if (joined && !quiet && waiting.size < 2) {
        const id = `s${i}-${number++}`, again = chance.one(2);
        waiting.set(id, true);
        mine.add(id);
        checker.ask(id, { room, again, port: way.port });
        way.socket.send(JSON.stringify({ type: 'speak', id, text: chance.of(TEXTS), again, voice: chance.one(4) ? 'command:dear' : undefined }));
      } else {
        const timer = sleep(1000);
        await Promise.race([timer, new Promise((resolve) => (wake = resolve))]);
        if (!quiet) await sleep(chance.below(2000));
      }
    }
    for (const id of waiting.keys()) checker.lose(id);
    speaking.delete(way);
    way.socket.terminate();
  }
}

/** Connections that the daemon also considers open, as "local port, remote port": the packet that closes one may be lost. */
function standing() {
  const lines = execFileSync('ss', ['-Htn', 'state', 'established'], { maxBuffer: 1 << 26 }).toString().trim().split('\n');
  return new Set(lines.map((line) => line.trim().split(/\s+/).slice(-2).map((end) => end.split(':').at(-1)).join(' ')));
}

/** Closes long-waiting connections that their daemon has dropped already. */
function drop() {
  if (![...checker.waiting.values()].some((since) => since < Date.now() - SUSPECT_MS)) return;
  const stand = standing();
  for (const { socket, port } of speaking) if (socket.readyState === WebSocket.OPEN && !stand.has(`${port} ${socket._socket?.localPort}`)) socket.terminate();
}

async function listen(i) {
  for (let visit = 0; !over; visit++) {
    const way = await enter(roomOf(i), '&audio=none&fap=plain');
    if (!way) {
      await sleep(200);
      continue;
    }
    const ear = new Ear(checker, roomOf(i), `l${i}.${visit} at ${way.port}`);
    way.socket.on('message', (data, binary) => {
      if (binary) ear.media(data.readUInt32LE(4), data.readUInt32LE(16), data.readUInt32LE(20));
      else ear.message(JSON.parse(data));
    });
    await Promise.race([way.closed, ended]);
    way.socket.terminate();
  }
}

const dropping = setInterval(drop, 5000);
let finish;
const ended = new Promise((resolve) => (finish = resolve));
const all = [...Array.from({ length: speakers }, (_, i) => speak(i)), ...Array.from({ length: listeners }, (_, i) => listen(i))];
console.log(`${minutes} min, ${DAEMONS} daemons, ${WORKERS} workers, ${speakers} speakers in ${ROOMS} rooms, ${listeners} listeners, seed ${seed}`);
const missing = [[ways.netem, 'tc netem (the way to Redis is slow by a proxy)'], [ways.netem ?? ways.tbf, 'tc tbf'], [ways.loss, 'lost packets (iptables)'], [disk, 'a full disk (tmpfs)'], [clocks, 'stepped clocks']];
console.log(`left out: ${missing.filter(([there]) => !there).map(([, what]) => what).join(', ') || 'nothing'}`);
const faults = Object.fromEntries(Object.entries(faultsOf(world, chance)).filter(([name]) => !values.only || name.includes(values.only)));
const happened = Object.fromEntries(Object.keys(faults).map((name) => [name, 0]));
const until = Date.now() + minutes * 60000;
await sleep(5000);
const busy = new Set();
while (Date.now() < until) {
  const name = chance.of(Object.keys(faults));
  // never the same fault twice at once, so that each gets repaired
  const kind = name.split(' ')[1] === 'daemon' || name.split(' ')[1] === 'worker' ? name.split(' ')[1] : name.includes('Redis') ? 'Redis' : name;
  if (!busy.has(kind)) {
    busy.add(kind);
    happened[name]++;
    if (process.env.FACCIA_CHAOS_TRACE) console.log(`# ${((Date.now() - checker.from) / 1000).toFixed(1)} s: ${name}`);
    faults[name]().catch((e) => console.log(`# ${name}: ${e.message}`)).finally(() => busy.delete(kind));
  }
  await sleep(chance.below(4000));
}
while (busy.size) await sleep(100);
quiet = true;
const settled = Date.now();
while (checker.waiting.size && Date.now() < settled + SETTLE_MS) await sleep(100);
over = true;
clearInterval(dropping);
finish();
const tally = checker.tally();
for (const { process: child } of [...world.daemons, ...world.workers, redis]) child.kill('SIGKILL');
await Promise.race([Promise.all(all), sleep(3000)]);
fs.rmSync(folder, { recursive: true });
if (logs) {
  fs.mkdirSync(logs, { recursive: true });
  for (const daemon of started) fs.writeFileSync(path.join(logs, `${daemon.port}.log`), daemon.log);
}
console.log(JSON.stringify({ happened, errors: codes, settled: `${((Date.now() - settled) / 1000).toFixed(1)} s`, ...tally }, null, 2));
for (const line of checker.examples) console.log(`! ${line}`);
process.exit(Object.values(tally.broken).some(Boolean) ? 1 : 0);
