// SPDX-License-Identifier: GPL-3.0-or-later
// File descriptors: the daemon adapts the process's limit or its own, and when descriptors run out, the operator still gets answers.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, Daemon, root } from '../../lib/daemon.mjs';
import { ask, Raw } from '../../lib/raw.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-descriptors-'));
after(() => fs.rmSync(folder, { recursive: true }));

/** Starts a daemon with these descriptor limits. */
async function start(t, limits, ...options) {
  const program = path.join(folder, 'build', 'server/daemon/facciad');
  fs.mkdirSync(path.dirname(program), { recursive: true });
  fs.writeFileSync(program, `#!/bin/sh\nexec prlimit --nofile=${limits} "${path.join(build, 'server/daemon/facciad')}" "$@"\n`, { mode: 0o755 });
  const daemon = await Daemon.start(options, {}, { program });
  t.after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));
  return daemon;
}

const softLimit = (pid) => Number(fs.readFileSync(`/proc/${pid}/limits`, 'utf8').match(/^Max open files +(\d+)/m)[1]);
const used = (pid) => fs.readdirSync(`/proc/${pid}/fd`).length;
const request = (target) => `GET ${target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n`;
const speaks = async (stream, id) => {
  stream.send({ type: 'speak', id, lang: 'it', text: `Una frase, la ${id}.` });
  assert.equal((await stream.wait({ type: 'end', id })).reason, 'done');
};

test('raises the descriptor limit to fit the connections', async (t) => {
  const daemon = await start(t, '256:20000', '--max-connections', '5000');
  assert.ok(softLimit(daemon.process.pid) >= 5050, `${softLimit(daemon.process.pid)}`);
  assert.doesNotMatch(daemon.log, /too few/);
  assert.match(fs.readFileSync(path.join(root, 'server/daemon/facciad.service.in'), 'utf8'), /^LimitNOFILE=\d+$/m);
});

test('where it cannot be raised, allows fewer connections, logs it, and leaves room for a worker', async (t) => {
  const daemon = await start(t, '200:200');
  const [, said] = await daemon.logged(/200 file descriptors are too few for 1000 connections: the limit is now (\d+)/);
  const stream = await daemon.stream();
  assert.equal((await stream.wait({ type: 'hello' })).limits.connections, Number(said));
  const crowd = await Promise.all(Array.from({ length: 220 }, () => Raw.open(daemon.port)));
  t.after(() => crowd.forEach((raw) => raw.close()));
  assert.ok(used(daemon.process.pid) < 200, `${used(daemon.process.pid)} are used`);
  const workers = execFileSync('pgrep', ['-P', String(daemon.process.pid)], { encoding: 'utf8' }).trim().split('\n').map(Number);
  for (const worker of workers) process.kill(worker, 'SIGKILL');
  // waits until the daemon has noticed
  while (workers.some((worker) => fs.existsSync(`/proc/${worker}`))) await new Promise((resolve) => setTimeout(resolve, 10));
  await speaks(stream, 'dopo');
  assert.doesNotMatch(daemon.log, /no connection can be taken/, 'descriptors are never used up by connections');
});

test('above the connection limit still answers the operator, and refuses others', async (t) => {
  const daemon = await start(t, '4096:4096', '--max-connections', '20');
  const crowd = await Promise.all(Array.from({ length: 20 }, () => Raw.open(daemon.port)));
  t.after(() => crowd.forEach((raw) => raw.close()));
  for (const target of ['/healthz', '/metrics']) assert.equal((await ask(daemon.port, request(target))).status, 200);
  const other = await ask(daemon.port, request('/v1/voices'));
  assert.deepEqual([other.status, JSON.parse(other.body).code], [503, 'too-many-connections']);
  // an idle connection is closed for a new one
  crowd[0].write('GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n');
  await crowd[0].answer();
  const late = await daemon.stream();
  await late.wait({ type: 'hello' });
  await crowd[0].end();
});

test('without free descriptors pauses accepting, answers health checks, and resumes', async (t) => {
  const daemon = await start(t, '4096:4096');
  const { pid } = daemon.process;
  const stream = await daemon.stream();
  await speaks(stream, 'a');
  assert.equal(spawnSync('prlimit', ['--pid', String(pid), `--nofile=${used(pid) + 10}:4096`]).status, 0);
  const crowd = [];
  const cpu = () => fs.readFileSync(`/proc/${pid}/stat`, 'utf8').split(' ').slice(13, 15).map(Number).reduce((a, b) => a + b) / 100;
  // a started worker frees descriptors, and connections on reserve descriptors time out: adds connections until the
  // daemon has none left
  let status;
  do {
    for (let i = 0; i < 18; i++) crowd.push(await Raw.open(daemon.port));
    ({ status } = await ask(daemon.port, request('/v1/voices')));
  } while (crowd.length < 180 && status !== 503);
  assert.equal(status, 503);
  await daemon.logged(/no connection can be taken: Too many open files/);
  const said = () => daemon.log.match(/no connection can be taken/g).length;
  const [before, saidBefore, began] = [cpu(), said(), Date.now()];
  const [health, metrics] = await Promise.all([ask(daemon.port, request('/healthz')), ask(daemon.port, request('/metrics'))]);
  assert.deepEqual([health.status, metrics.status], [200, 200]);
  await speaks(stream, 'b');
  await new Promise((resolve) => setTimeout(resolve, Math.max(0, 2000 - (Date.now() - began)))); // measures processor time over at least 2 s
  const seconds = (Date.now() - began) / 1000;
  assert.ok(cpu() - before < seconds * 0.7, `${cpu() - before} s of processor time in ${seconds} s`);
  assert.ok(said() - saidBefore <= seconds + 2, daemon.log);
  await Promise.all(crowd.map((raw) => raw.close()));
  assert.equal(spawnSync('prlimit', ['--pid', String(pid), '--nofile=4096:4096']).status, 0);
  const late = await daemon.stream();
  await late.wait({ type: 'hello' });
  await speaks(late, 'c');
});
