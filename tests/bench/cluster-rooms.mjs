// SPDX-License-Identifier: GPL-3.0-or-later
// One speaker in a room to many listeners: all of them at one daemon, and as many at several that share the room by Redis. What
// the processors do for it in all (daemons and Redis, in making, sending and handing on), and how much later than the first listener of
// all a listener has a message. Daemons and Redis on core 0, the listeners on core 1; the two in turns.
// At rest: what daemons and Redis do while nothing is said, in the time that the speech takes; it is a part of the CPU time.
// Usage: node tests/bench/cluster-rooms.mjs [LISTENERS [DAEMONS [TURNS [SENTENCES]]]] (4000 4 3 3; ulimit -n must allow them)
import { roomTurn } from './room-turn.mjs';
import { sentence } from './text.mjs';

const [count = 4000, several = 4, turns = 3, sentences = 3] = process.argv.slice(2).map(Number);
const REST = 4;
const text = `${sentence} `.repeat(sentences);

console.log(`${count} listeners, the same speech to all; ms after the first listener of all had a message`);
console.log('daemons   messages   CPU s  of it Redis  at rest   half   99 %   last   sent on the bus');
const ratios = [];
for (let i = 0; i < turns; i++) {
  const [one, more] = [await roomTurn(1, count, text, REST), await roomTurn(several, count, text, REST)];
  for (const [daemons, r] of [[1, one], [several, more]])
    console.log([String(daemons).padStart(7), String(r.messages).padStart(10), r.all.toFixed(3).padStart(7), r.redis.toFixed(4).padStart(12), r.rest.toFixed(3).padStart(8), ...[r.p50, r.p99, r.max].map((ms) => ms.toFixed(1).padStart(6)), String(r.sent).padStart(10)].join(' '));
  ratios.push(more.all / one.all);
  console.log(`        CPU ratio ${ratios.at(-1).toFixed(3)}, Redis ${((100 * more.redis) / one.all).toFixed(2)} % of the one daemon's, 99 % later by ${(more.p99 - one.p99).toFixed(1)} ms`);
}
process.exit(0);
