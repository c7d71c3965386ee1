// SPDX-License-Identifier: GPL-3.0-or-later
// Starting and stopping the daemon as an operator does: options, refusals, signals.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { build, Daemon } from '../lib/daemon.mjs';

const facciad = (args) => {
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/app/facciad'), args, { timeout: 20000 });
  return { status, stdout: String(stdout), stderr: String(stderr) };
};

test('help and version', () => {
  const { status, stdout } = facciad(['--help']);
  assert.equal(status, 0);
  assert.match(stdout, /--remote/);
  assert.match(facciad(['--version']).stdout, /^facciad \d/);
});

const refusals = [
  [['--host', '0.0.0.0', '--port', '0'], 1, /--remote/],
  [['--host', 'nowhere.invalid', '--port', '0'], 1, /loopback/],
  [['--port', '70000'], 2, /--port: '70000' is not a number from 0 to 65535/],
  [['--port', 'x'], 2, /--port/],
  [['--workers', '0'], 2, /--workers/],
  [['--lang', 'xx', '--port', '0'], 1, /no language 'xx'/],
  [['--models', '/nowhere', '--port', '0'], 1, /\/nowhere/],
  [['--plugins', '/nowhere', '--port', '0'], 1, /\/nowhere/],
  [['--nonsense'], 2, /facciad --help/],
  [['extra'], 2, /unexpected 'extra'/],
];
for (const [args, code, message] of refusals)
  test(`facciad ${args.join(' ')}: exit ${code}`, () => {
    const { status, stderr } = facciad(args);
    assert.match(stderr, message);
    assert.equal(status, code);
  });

test('a port that is taken is told', async () => {
  const daemon = await Daemon.start();
  const { status, stderr } = facciad(['--port', String(daemon.port)]);
  assert.equal(status, 1);
  assert.match(stderr, new RegExp(`cannot listen on 127.0.0.1 port ${daemon.port}`));
  assert.equal((await daemon.stop()).code, 0);
});

test('other machines are let in when it is said', async () => {
  const daemon = await Daemon.start(['--host', '0.0.0.0', '--remote']);
  assert.equal((await daemon.get('/healthz')).status, 200);
  assert.equal((await daemon.stop()).code, 0);
});

test('SIGTERM ends it while it speaks, and leaves no process behind', async () => {
  const daemon = await Daemon.start();
  const stream = await daemon.stream();
  stream.send({ type: 'speak', lang: 'it', text: 'Una frase lunga, che non finisce mai. '.repeat(50) });
  await stream.until(() => stream.chunks.length > 0);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  await stream.closed;
  if (os.platform() === 'linux') {
    const left = spawnSync('pgrep', ['-P', String(daemon.process.pid)]);
    assert.equal(String(left.stdout), '');
  }
});

test('connections beyond the limit are refused, those within it live on', async () => {
  const daemon = await Daemon.start(['--max-connections', '5']);
  const streams = [];
  for (let i = 0; i < 5; i++) streams.push(await daemon.stream());
  await assert.rejects(daemon.stream());
  streams[0].send({ type: 'ping', id: 1 });
  await streams[0].wait({ type: 'pong', id: 1 });
  await streams[1].close();
  await new Promise((resolve) => setTimeout(resolve, 100));
  const late = await daemon.stream();
  await late.wait({ type: 'hello' });
  assert.equal((await daemon.stop()).code, 0);
});

test('a thousand connections that come and go leave nothing', async () => {
  const daemon = await Daemon.start();
  for (let i = 0; i < 50; i++) {
    const streams = await Promise.all(Array.from({ length: 20 }, () => daemon.stream()));
    streams.forEach((stream, k) => (k % 2 ? stream.socket.terminate() : stream.close()));
  }
  await new Promise((resolve) => setTimeout(resolve, 300));
  const { connections } = await (await daemon.get('/healthz')).json();
  assert.ok(connections <= 3, `${connections} connections`);
  assert.equal((await daemon.stop()).code, 0);
});

test('a reader that stands still holds nobody up, and is let go', async () => {
  const daemon = await Daemon.start();
  const [stuck, other] = await Promise.all([daemon.stream(), daemon.stream()]);
  stuck.socket._socket.pause();
  stuck.send({ type: 'speak', lang: 'it', text: 'Una frase lunga, che non finisce mai. '.repeat(100) });
  for (let i = 0; i < 2000; i++) stuck.send({ type: 'ping', id: 'x'.repeat(2000) });
  other.send({ type: 'speak', lang: 'it', text: 'Io sento bene.' });
  assert.equal((await other.wait({ type: 'end' })).reason, 'done');
  await daemon.logged(/listening/);
  const deadline = Date.now() + 25000;
  let connections = 3;
  while (connections > 2 && Date.now() < deadline) {
    await new Promise((resolve) => setTimeout(resolve, 500));
    ({ connections } = await (await daemon.get('/healthz')).json());
  }
  stuck.socket.terminate();
  await other.close();
  assert.ok(connections <= 2, 'the one that stands still was let go');
  assert.equal((await daemon.stop()).code, 0);
});
