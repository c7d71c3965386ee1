// SPDX-License-Identifier: GPL-3.0-or-later
// One speaker in a room with many listeners: all on one daemon, or spread over several that share the room over Redis. Measures the total
// CPU time of daemons and Redis, and the delay of each listener after the first listener of all. Daemons and Redis run on core 0, the
// listeners on core 1; both cases take turns.
// At rest: CPU time of idle daemons and Redis in the same period, included in the total. Took: time from the request until all listeners
// had its end. Waited: longest time in it that a daemon or Redis waited for a processor.
// Usage: node tests/bench/run.mjs cluster-rooms [LISTENERS [DAEMONS [TURNS [SENTENCES]]]] (4000 4 3 3). `ulimit -n` limits descriptors per process:
// listeners use as many processes as needed, but a single daemon has fewer of them if necessary; CPU ratios are per message.
import { execFileSync } from 'node:child_process';
import { roomTurn } from './room-turn.mjs';
import { sentence } from './text.mjs';

const [count = 4000, several = 4, turns = 3, sentences = 3] = process.argv.slice(2).map(Number);
const [REST, OTHER_FILES] = [4, 200];
const descriptors = Number(execFileSync('sh', ['-c', 'ulimit -n']));
const text = `${sentence} `.repeat(sentences);

console.log(`${count} listeners, the same speech to all; ms after the first listener of all had a message`);
console.log('daemons listeners   messages   CPU s  of it Redis  at rest  listeners\'   took  waited   half   99 %   last   sent on the bus');
let split = 0;
for (let i = 0; i < turns; i++) {
  const alone = Math.min(count, descriptors - OTHER_FILES);
  const [one, more] = [await roomTurn(1, alone, text, REST), await roomTurn(several, count, text, REST)];
  for (const [daemons, listeners, r] of [[1, alone, one], [several, count, more]])
    console.log([String(daemons).padStart(7), String(listeners).padStart(9), String(r.messages).padStart(10), r.all.toFixed(3).padStart(7), r.redis.toFixed(4).padStart(12), r.rest.toFixed(3).padStart(8), r.clients.toFixed(2).padStart(11), ...[r.took, r.waited].map((s) => s.toFixed(2).padStart(7)), ...[r.p50, r.p99, r.max].map((ms) => ms.toFixed(1).padStart(6)), String(r.sent).padStart(10)].join(' '));
  const each = one.all / one.messages;
  console.log(`        CPU ratio ${(more.all / more.messages / each).toFixed(3)}, Redis ${((100 * more.redis) / more.messages / each).toFixed(2)} % of the one daemon's, 99 % later by ${(more.p99 - one.p99).toFixed(1)} ms`);
  if (more.homes === 1 && more.messages / count === one.messages / alone) continue;
  split++;
  console.log(`        the room split: ${more.homes} times a daemon came to speak in it, ${((100 * more.messages * alone) / count / one.messages).toFixed(1)} % of the messages came`);
}
process.exit(split ? 1 : 0);
