// SPDX-License-Identifier: GPL-3.0-or-later
// Delay of a driven face: the mouth of a performer opens or closes every half second, 60 frames a second; from the sending of the first
// frame with it until the media of a follower of the room show half of the way. By UDP through `faccia fap capture --room`, and by the
// WebSocket alone.
// Usage: node tests/bench/run.mjs drive [SECONDS]
import { spawn } from 'node:child_process';
import dgram from 'node:dgram';
import { once } from 'node:events';
import path from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import { build, Daemon } from '../lib/daemon.mjs';
import { median, quantile } from './figures.mjs';

const seconds = Number(process.argv[2] ?? 30);
const [JAW, OPEN, FPS, HELD] = [3, 600, 60, 30];
const daemon = await Daemon.start([], {}, { voices: false });

async function followerOf(room) {
  const stream = await daemon.stream(`?room=${room}`);
  await stream.wait({ type: 'joined' });
  stream.send({ type: 'idle', life: 0 });
  return stream;
}

/** Sends frames for that time. @returns when each step was sent, ms */
async function perform(send) {
  const begun = performance.now(), steps = [];
  for (let k = 0; k < seconds * FPS; k++) {
    await sleep(Math.max(0, begun + (1000 * k) / FPS - performance.now()));
    const open = Math.floor(k / HELD) % 2 === 1;
    if (k && k % HELD === 0) steps.push({ at: performance.now(), open });
    send(k, open);
  }
  await sleep(500);
  return steps;
}

/** The delays of the steps, ms. */
function delays(stream, steps) {
  return steps.slice(1).flatMap(({ at, open }) => {
    const chunk = stream.chunks.find(({ arrived, frames }) => arrived > at && frames.some((frame) => frame[JAW] > OPEN / 2 === open));
    return chunk && chunk.arrived - at < 1000 ? chunk.arrived - at : [];
  });
}
const say = (name, list) => console.log(`${name.padEnd(10)} ${list.length} steps, median ${median(list).toFixed(0)} ms, 95 % within ${quantile(list, 0.95).toFixed(0)} ms`);

const int = (value) => Buffer.from(Int32Array.of(value).buffer).reverse();
const float = (value) => Buffer.from(Float32Array.of(value).buffer).reverse();
const packet = (k, open) => Buffer.concat([Buffer.from([6]), int(2), Buffer.from('id'), int(4), Buffer.from('face'), int(k), float(0), int(FPS), int(1), Buffer.from([61]),
  ...Array.from({ length: 61 }, (_, i) => float(i === 17 && open ? OPEN / 1000 : 0))]);

const stage = await followerOf('udp');
const capture = spawn(path.join(build, 'server/cli/faccia'), ['fap', 'capture', '--room', 'udp', '--udp', '0', '--url', daemon.url], { stdio: ['ignore', 'ignore', 'pipe'] });
let said = '';
capture.stderr.setEncoding('utf8').on('data', (text) => (said += text));
while (!/port \d+/.test(said)) await sleep(10);
const port = Number(/port (\d+)/.exec(said)[1]);
const socket = dgram.createSocket('udp4');
const byUdp = delays(stage, await perform((k, open) => socket.send(packet(k, open), port, '127.0.0.1')));
socket.close();
capture.kill('SIGINT');
await once(capture, 'close');
await stage.close();

const [screen, driver] = [await followerOf('socket'), await daemon.stream('?room=socket&watch=1')];
const bySocket = delays(screen, await perform((k, open) => driver.send({ type: 'drive', frames: [{ time: k / FPS, faps: { [JAW]: open ? OPEN : 0 } }] })));
await Promise.all([screen.close(), driver.close()]);
await daemon.stop();
say('UDP', byUdp);
say('WebSocket', bySocket);
