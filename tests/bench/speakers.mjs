// SPDX-License-Identifier: GPL-3.0-or-later
// Maximum number of simultaneous speakers before media are late: separate streams with different, uncached Italian texts in real
// time, in the default encoding (Opus and FAPC). Doubles until more than 1 % of the chunks arrive after their play time, then
// bisects. The clients share the cores, so their CPU time is reported, too.
// Usage: node tests/bench/run.mjs speakers [--workers N] [--seconds S] [--query '&audio=none'] [N]... (N: only these; default: search from 50)
import { spawn } from 'node:child_process';
import os from 'node:os';
import { once } from 'node:events';
import readline from 'node:readline';
import { parseArgs } from 'node:util';
import { Daemon } from '../lib/daemon.mjs';
import { cpuOf, childrenOf, kilobytesOf } from './figures.mjs';
import { needProgram } from './need.mjs';
import { varied } from './text.mjs';

const program = needProgram('speakers');
const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: { query: { type: 'string', default: '' }, workers: { type: 'string', default: '1' }, seconds: { type: 'string', default: '12' } },
});
const [SPREAD, WARM, SECONDS] = [4, 3, Number(options.seconds)];
const LATE = 0.01;
const STEP = 25; // resolution of the bisection
// texts last longer than the measurement, so that the voice works until its end
const LENGTH = 13 * (SPREAD + WARM + SECONDS + 25);

/** Measures `count` speakers. */
async function speak(count) {
  const daemon = await Daemon.start(['--max-connections', String(count + 10), '--workers', options.workers]);
  const parts = { daemon: [daemon.process.pid], voices: childrenOf(daemon.process.pid) };
  const before = kilobytesOf(daemon.process.pid);
  const args = [daemon.port, count, SPREAD, WARM, SECONDS, `/v1/stream?lang=it${options.query}`].map(String);
  const child = spawn(program, args, { stdio: ['pipe', 'pipe', 'inherit'] });
  const ended = once(child, 'exit');
  parts.hearers = [child.pid];
  child.stdin.write(Array.from({ length: count }, (_, i) => `${varied(LENGTH, i + 1)}\n`).join(''));
  const used = () => Object.fromEntries(Object.entries(parts).map(([name, pids]) => [name, pids.reduce((sum, pid) => sum + cpuOf(pid), 0)]));
  let [from, heard, kilobytes] = [null, null, 0];
  for await (const line of readline.createInterface(child.stdout)) {
    if (line !== 'warm') {
      heard = JSON.parse(line);
      heard.cpu = used();
      for (const name in heard.cpu) heard.cpu[name] -= from[name];
      kilobytes = kilobytesOf(daemon.process.pid) - before;
      child.stdin.end();
      continue;
    }
    from = used();
  }
  await ended;
  await daemon.stop();
  if (!heard) throw new Error('the hearers ended');
  heard.inTime = heard.late <= LATE * heard.chunks;
  const each = (seconds) => ((1000 * seconds) / heard.media).toFixed(2).padStart(8);
  console.log([String(count).padStart(8), `${((100 * heard.late) / heard.chunks).toFixed(2)} %`.padStart(9), each(heard.cpu.daemon), each(heard.cpu.voices), each(heard.cpu.hearers),
    ...[heard.p50, heard.p99, heard.first50, heard.first99].map((ms) => ms.toFixed(1).padStart(9)), (kilobytes / count).toFixed(0).padStart(9)].join(' '));
  return heard;
}

console.log(`${os.cpus().length} cores (${os.cpus()[0].model}); speech of ${SECONDS} s measured, ${SPREAD} s for all to begin`);
console.log('ms of CPU for each second of speech: daemon, voices, hearers; ms from when a chunk may leave until it is there, and from the request to the first media; kB of the daemon for each');
console.log('speakers      late   daemon   voices  hearers  half        99 %  first     99 %       memory');
if (positionals.length) {
  for (const count of positionals.map(Number)) await speak(count);
} else {
  let [good, bad] = [0, 0];
  for (let count = 50; !bad; count *= 2)
    if ((await speak(count)).inTime) good = count;
    else bad = count;
  while (bad - good > Math.max(STEP, good / 16)) {
    const count = Math.round((good + bad) / 2 / 5) * 5;
    if ((await speak(count)).inTime) good = count;
    else bad = count;
  }
  console.log(`\n${good} speak at once with at most ${100 * LATE} % of their media late`);
}
