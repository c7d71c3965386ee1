// SPDX-License-Identifier: GPL-3.0-or-later
// Latency of live voices: time from a sample's moment of speaking to the arrival of its frame, at each lookahead. Sends sound in real time every 10 ms at
// 16 kHz. The daemon's share beyond the lookahead is shown beside the latency of pings on the same connection, which is the machine's share.
// node tests/bench/run.mjs live [SECONDS, 20]
import { setTimeout as sleep } from 'node:timers/promises';
import { Daemon } from '../lib/daemon.mjs';

const seconds = Number(process.argv[2] ?? 20), rate = 16000, fps = 50;
const daemon = await Daemon.start();
const part = (list, share) => [...list].sort((a, b) => a - b)[Math.floor(share * (list.length - 1))];
const ms = (list) => `${part(list, 0.1).toFixed(0)}, ${part(list, 0.5).toFixed(0)}, ${part(list, 0.9).toFixed(0)}`;

console.log('| lookahead | frame after its moment: 10, 50, 90 %, ms | answer to a ping, ms |\n|---|---|---|');
for (const lookahead of [0, 40, 80, 120]) {
  const stream = await daemon.stream();
  stream.send({ type: 'voice', id: 'v', rate, lookahead, fps, lang: 'it' });
  const begin = performance.now(), asked = new Map();
  for (let at = 0; at < seconds * rate;) {
    const due = Math.floor(((performance.now() - begin) / 1000) * rate);
    if (due > at) stream.socket.send(Int16Array.from({ length: due - at }, (_, i) => 6000 * Math.sin((at + i) / 9) * Math.max(0, Math.sin((at + i) / 1300))));
    if (Math.floor(due / rate) > asked.size) {
      asked.set(`${asked.size}`, performance.now());
      stream.send({ type: 'ping', id: `${asked.size - 1}` });
    }
    at = Math.max(at, due);
    await sleep(10);
  }
  const delays = stream.chunks.flatMap((c) => c.frames.map((_, i) => c.arrived - begin - (1000 * (c.firstFrame + i)) / c.fps));
  const pongs = stream.messages.filter((m) => m.type === 'pong').map((m) => m.arrived - asked.get(m.id));
  console.log(`| ${lookahead} ms | ${ms(delays)} | ${ms(pongs)} |`);
  await stream.close();
}
await daemon.stop();
