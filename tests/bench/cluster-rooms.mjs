// SPDX-License-Identifier: GPL-3.0-or-later
// One speaker in a room to many listeners: all of them at one daemon, and as many at several that share the room by Redis. What
// the processors do for it in all (daemons and Redis, in making, sending and handing on), and how much later than the first listener of
// all a listener has a message. Daemons and Redis on core 0, the listeners on core 1; the two in turns.
// At rest: what daemons and Redis do while nothing is said, in the time that the speech takes; it is a part of the CPU time.
// Took: from the request until all had its end. Waited: for how much of that the one of daemons and Redis that waited longest had no processor.
// Usage: node tests/bench/run.mjs cluster-rooms [LISTENERS [DAEMONS [TURNS [SENTENCES]]]] (4000 4 3 3). A process may have `ulimit -n` descriptors:
// the listeners are as many processes as that wants; at one daemon there are no more of them than it allows, and CPU ratios are those of a message.
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
