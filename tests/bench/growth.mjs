// SPDX-License-Identifier: GPL-3.0-or-later
// Cost per listener and per speaker with 1, 2, 4 and 8 daemons that share a Redis: CPU time of daemons, voices and Redis (without the listeners),
// which is independent of other load, relative to one daemon in the same turn. Listeners: one speaker in a room of listeners on all daemons.
// Speakers: separate streams spread over the daemons, each with a different, uncached text. At rest: CPU time of idle daemons and Redis in the same
// period, which does not depend on the listeners.
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

/** CPU ms per second of speech. */
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
/** Median over the turns of the ratio to one daemon. */
const ratio = (i, what) => median(all[i][what].map((value, turn) => value / all[0][what][turn])).toFixed(2);
console.log('\n| daemons | a listener | of it Redis | of it what they do at rest | a speaker |\n|---|---|---|---|---|');
for (const [i, count] of DAEMONS.entries()) console.log(`| ${count} | ${ratio(i, 'listener')} | ${(100 * median(all[i].redis)).toFixed(1)} % | ${median(all[i].rest.map((value, turn) => value / all[0].listener[turn])).toFixed(2)} | ${speakers ? ratio(i, 'speaker') : ''} |`);
process.exit(0);
