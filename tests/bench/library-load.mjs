// SPDX-License-Identifier: GPL-3.0-or-later
// Effect of library searches on speech: speakers stream different texts in real time, without searches and beside 1,000 searches a second from
// eight clients, in turns; another client searches four times a second. Queries are the hardest ones: the three most frequent words. Clients and
// speakers share the processors with the daemon, so the same number of /healthz requests, which do nothing, shows the clients' part of the delay.
// node tests/bench/run.mjs library-load [SPEAKERS, 50] [SEARCHES A SECOND, 1000] [MEGABYTES, 10] [TURNS, 2]
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import readline from 'node:readline';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { sentencesOf } from '../lib/works.mjs';
import { cpuOf } from './figures.mjs';
import { needProgram } from './need.mjs';
import { varied } from './text.mjs';

const [speakers, rate, megabytes, turns] = [50, 1000, 10, 2].map((usual, i) => Number(process.argv[2 + i] ?? usual));
const [SPREAD, WARM, SECONDS, CLIENTS, TICK] = [4, 3, 10, 8, 10];
const program = needProgram('speakers');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const works = path.join(folder, 'works');

fs.mkdirSync(works);
const counts = new Map();
for (let i = 0; i < megabytes; i++) {
  const sentences = sentencesOf(i + 1, 60000);
  const text = [];
  for (let size = 0; size < 1 << 20; size += text.at(-1).length) text.push(Array.from({ length: 4 }, () => sentences.next().value).join(' '));
  if (!i) for (const word of text.join(' ').match(/\w+/g)) counts.set(word, (counts.get(word) ?? 0) + 1);
  fs.writeFileSync(path.join(works, `work-${i}.it.txt`), text.join('\n\n'));
}
const common = [...counts].sort(([, a], [, b]) => b - a).slice(0, 40).map(([word]) => word);
const query = (n) => [n, n * 7 + 3, n * 13 + 5].map((k) => common[k % common.length]).join(' ');
const at = (list, part) => (list.sort((a, b) => a - b)[Math.floor((list.length - 1) * part)] ?? 0).toFixed(0);

const daemon = await Daemon.start(['--library', works, '--library-index', path.join(folder, 'index'), '--max-connections', '3000']);
await eventually(async () => (await (await daemon.get('/v1/library?limit=1')).json()).state === 'ready', 'the index', 600000);

/** Searches until stopped. Returns the results. */
function search(perSecond, clients, first, bare) {
  const agents = Array.from({ length: clients }, () => new http.Agent({ keepAlive: true, maxSockets: 150 }));
  const heard = { 200: 0, 503: 0, other: 0, times: [], asked: 0, told: 0 };
  let open = 0;
  const ask = (n) => {
    const from = performance.now();
    open++;
    heard.asked++;
    const ended = () => open--;
    http.get({ agent: agents[n % clients], host: '127.0.0.1', port: daemon.port, localAddress: `127.0.0.${first + (n % clients)}`, path: bare ? '/healthz' : `/v1/library/search?q=${encodeURIComponent(query(n))}` }, (response) => {
      heard[[200, 503].includes(response.statusCode) ? response.statusCode : 'other']++;
      if (response.statusCode === 503 && response.headers['retry-after']) heard.told++;
      if (response.statusCode === 200) heard.times.push(performance.now() - from);
      response.resume().on('end', ended);
    }).on('error', () => { heard.other++; ended(); });
  };
  let [due, n] = [0, 0];
  const every = 1000 / perSecond > TICK ? 1000 / perSecond : TICK;
  const timer = setInterval(() => { for (due += (perSecond * every) / 1000; due >= 1; due--) ask(n++); }, every);
  return async () => {
    clearInterval(timer);
    await eventually(() => !open, 'the last answers', 120000);
    for (const agent of agents) agent.destroy();
    return heard;
  };
}

async function turn(searches, bare) {
  const child = spawn(program, [daemon.port, speakers, SPREAD, WARM, SECONDS, '/v1/stream?lang=it'].map(String), { stdio: ['pipe', 'pipe', 'inherit'] });
  const ended = once(child, 'exit');
  child.stdin.write(Array.from({ length: speakers }, () => `${varied(13 * (SPREAD + WARM + SECONDS + 25), Math.floor(Math.random() * 1e9))}\n`).join(''));
  let [stops, heard, from] = [[], null, 0];
  for await (const line of readline.createInterface(child.stdout)) {
    if (line === 'warm') {
      if (searches) stops = [search(searches, CLIENTS, 2, bare), search(4, 1, 100, bare)];
      from = cpuOf(daemon.process.pid);
      continue;
    }
    heard = JSON.parse(line);
    child.stdin.end();
  }
  const cpu = cpuOf(daemon.process.pid) - from;
  const [many, one] = await Promise.all(stops.map((stop) => stop()));
  await ended;
  const late = `${((100 * heard.late) / heard.chunks).toFixed(2)} % of ${heard.chunks} chunks late, ${heard.p50.toFixed(1)}, ${heard.p99.toFixed(1)} ms behind their time (half, 99 %), ${cpu.toFixed(1)} s of the daemon's processor`;
  console.log(searches ? `beside ${bare ? 'requests that do nothing' : 'searches'}: ${late}\n  the many: ${many.asked} asked, ${many[200]} answered (${at(many.times, 0.5)}, ${at(many.times, 0.99)} ms), ${many[503]} told to come later (${many.told} with Retry-After), ${many.other} otherwise\n  the one: ${one.asked} asked, ${one[200]} answered (${at(one.times, 0.5)}, ${at(one.times, 0.99)} ms)` : `without: ${late}`);
}

for (let i = 0; i < turns; i++) {
  await turn(0);
  await turn(rate, true);
  await turn(rate, false);
}
await daemon.stop();
fs.rmSync(folder, { recursive: true });
