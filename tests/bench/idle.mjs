// SPDX-License-Identifier: GPL-3.0-or-later
// CPU cost of idle faces in the daemon: node tests/bench/run.mjs idle [STREAMS]
import WebSocket from 'ws';
import { Daemon } from '../lib/daemon.mjs';
import { cpuSeconds, kilobytesOf } from './figures.mjs';

const SECONDS = 10;
const streams = Number(process.argv[2] ?? 1000);
const daemon = await Daemon.start(['--max-connections', String(streams + 10)]);
const sleep = (seconds) => new Promise((resolve) => setTimeout(resolve, 1000 * seconds));

const before = kilobytesOf(daemon.process.pid);
const sockets = [];
let [chunks, bytes] = [0, 0];
for (let i = 0; i < streams; i++) {
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream`, { perMessageDeflate: false });
  socket.on('message', (data, binary) => {
    if (!binary) return;
    chunks++;
    bytes += data.length;
  });
  await new Promise((resolve) => socket.on('open', resolve));
  socket.send('{"type":"idle"}');
  sockets.push(socket);
}
await sleep(2);
const [cpu, sent, size, started] = [cpuSeconds(daemon.process.pid), chunks, bytes, performance.now()];
await sleep(SECONDS);
const took = (performance.now() - started) / 1000;
const share = (cpuSeconds(daemon.process.pid) - cpu) / took;
console.log(`${streams} idle streams: ${(100 * share).toFixed(1)} % of a core, ${((1e6 * share) / streams).toFixed(0)} us a second each`);
console.log(`${((chunks - sent) / took / streams).toFixed(2)} chunks a second each, ${((bytes - size) / (chunks - sent)).toFixed(0)} bytes a chunk`);
console.log(`${((kilobytesOf(daemon.process.pid) - before) / streams).toFixed(1)} kB of memory each`);
for (const socket of sockets) socket.terminate();
await daemon.stop();
