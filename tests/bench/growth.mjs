// SPDX-License-Identifier: GPL-3.0-or-later
// What a listener and a speaker cost as daemons become more (1, 2, 4, 8, which share a Redis): processor time of daemons, voices and
// Redis, not of the listeners, and not the time that passes, so that the machine may be busy with other things; as a ratio to one daemon in
// the same turn. Listeners: one speaks in a room to all of them, at any daemon. Speakers: streams of their own, spread over the daemons,
// with a text of its own each, so that none is in a cache. At rest: what daemons and Redis do while nothing is said, in the time that the
// speech takes, which does not grow with the listeners.
// Usage: node tests/bench/run.mjs growth [LISTENERS [SPEAKERS [TURNS [SECONDS]]]] (2000 24 3 8; no speakers: 0; ulimit -n must allow the listeners)
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import readline from 'node:readline';
import { childrenOf, cpuOf, median } from './figures.mjs';
import { needProgram } from './need.mjs';
import { roomTurn, startDaemons } from './room-turn.mjs';
import { sentence, varied } from './text.mjs';

const [listeners = 2000, speakers = 24, turns = 3, seconds = 8] = process.argv.slice(2).map(Number);
const DAEMONS = [1, 2, 4, 8];
const [SPREAD, WARM, REST] = [3, 2, 8];
const program = needProgram('speakers');
const text = `${sentence} `.repeat(3);
const sum = (list) => list.reduce((a, b) => a + b, 0);

/** Processor time in ms for a second of speech. */
async function speakTurn(count) {
  const { redis, daemons } = await startDaemons(count, ['--workers', '1']);
  const pids = [...daemons.flatMap((daemon) => [daemon.process.pid, ...childrenOf(daemon.process.pid)]), ...(redis ? [redis.process.pid] : [])];
  const each = speakers / count;
  const length = 13 * (SPREAD + WARM + seconds + 25);
  const children = daemons.map((daemon, i) => {
    const child = spawn(program, [daemon.port, each, SPREAD, WARM, seconds, '/v1/stream?lang=it'].map(String), { stdio: ['pipe', 'pipe', 'inherit'] });
    child.stdin.write(Array.from({ length: each }, (_, j) => `${varied(length, i * each + j + 1)}\n`).join(''));
    return { child, ended: once(child, 'exit'), lines: readline.createInterface(child.stdout)[Symbol.asyncIterator]() };
  });
  for (const { lines } of children) await lines.next(); // warm
  const before = pids.map(cpuOf);
  const heard = [];
  for (const { lines } of children) heard.push(JSON.parse((await lines.next()).value));
  const used = sum(pids.map((pid, i) => cpuOf(pid) - before[i]));
  for (const { child, ended } of children) {
    child.stdin.end();
    await ended;
  }
  for (const daemon of daemons) await daemon.stop();
  redis?.stop();
  return (1000 * used) / sum(heard.map(({ media }) => media));
}

const all = DAEMONS.map(() => ({ listener: [], redis: [], rest: [], speaker: [] }));
console.log(`${listeners} listeners of one room, ${speakers} speakers; processor time of daemons, voices and Redis`);
console.log('turn daemons   us a message   of it Redis   of it at rest   ms a second of speech');
for (let turn = 1; turn <= turns; turn++)
  for (const [i, count] of DAEMONS.entries()) {
    const room = await roomTurn(count, listeners, text, REST);
    const speaker = speakers ? await speakTurn(count) : 0;
    all[i].listener.push((1e6 * room.all) / room.messages);
    all[i].redis.push(room.redis / room.all);
    all[i].rest.push((1e6 * room.rest) / room.messages);
    all[i].speaker.push(speaker);
    console.log([String(turn).padStart(4), String(count).padStart(7), all[i].listener.at(-1).toFixed(2).padStart(14), `${(100 * all[i].redis.at(-1)).toFixed(1)} %`.padStart(13), all[i].rest.at(-1).toFixed(2).padStart(16), speaker.toFixed(2).padStart(23)].join(' '));
  }
/** The middle of the turns' ratios to one daemon. */
const ratio = (i, what) => median(all[i][what].map((value, turn) => value / all[0][what][turn])).toFixed(2);
console.log('\n| daemons | a listener | of it Redis | of it what they do at rest | a speaker |\n|---|---|---|---|---|');
for (const [i, count] of DAEMONS.entries()) console.log(`| ${count} | ${ratio(i, 'listener')} | ${(100 * median(all[i].redis)).toFixed(1)} % | ${median(all[i].rest.map((value, turn) => value / all[0].listener[turn])).toFixed(2)} | ${speakers ? ratio(i, 'speaker') : ''} |`);
process.exit(0);
