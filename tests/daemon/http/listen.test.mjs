// SPDX-License-Identifier: GPL-3.0-or-later
// Listening addresses: as the kernel lists them, as another machine reaches them, and as the log reports them.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build } from '../../lib/daemon.mjs';

const facciad = path.join(build, 'server/daemon/facciad');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-listen-'));
const secrets = path.join(folder, 'secrets');
fs.writeFileSync(secrets, `${'a secret'.repeat(5)}\n`);
const remote = ['--remote', '--secret-file', secrets];

// two network namespaces as two machines with a cable between them; the daemon runs on the first
const [here, there] = [`faccia-${process.pid}-a`, `faccia-${process.pid}-b`];
const run = (...command) => spawnSync(command[0], command.slice(1), { encoding: 'utf8', timeout: 30000 });
const within = (place, ...command) => run('ip', 'netns', 'exec', place, ...command);
const refused = run('ip', 'netns', 'add', here).status !== 0 && 'this kernel lets nobody have a network of its own';

before(() => {
  if (refused) return;
  for (const line of [
    `netns add ${there}`, `link add face0 netns ${here} type veth peer name face1 netns ${there}`,
    `-n ${here} addr add 10.77.0.1/24 dev face0`, `-n ${there} addr add 10.77.0.2/24 dev face1`,
    `-n ${here} addr add fd77::1/64 dev face0 nodad`, `-n ${there} addr add fd77::2/64 dev face1 nodad`,
    `-n ${here} link set lo up`, `-n ${here} link set face0 up`, `-n ${there} link set lo up`, `-n ${there} link set face1 up`,
  ]) assert.equal(run('ip', ...line.split(' ')).status, 0, line);
});
after(() => {
  if (!refused) for (const place of [here, there]) run('ip', 'netns', 'del', place);
  fs.rmSync(folder, { recursive: true });
});

/** Starts the daemon on the first machine, calls `look`, and stops it. */
async function listens(options, look) {
  const child = spawn('ip', ['netns', 'exec', here, facciad, '--port', '0', ...options], { stdio: ['ignore', 'ignore', 'pipe'], env: { ...process.env, FACCIA_STOP_SECONDS: '0' } });
  const ended = once(child, 'exit');
  let log = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (log += text));
  while (!/listening on [^]*\n.*(voice|ready)/.test(log) && child.exitCode === null) await new Promise((resolve) => setTimeout(resolve, 20));
  const said = [...log.matchAll(/listening on http:\/\/(.*):(\d+)\//g)];
  assert.ok(said.length, log);
  try {
    await look({ said: said.map((match) => match[1]), port: said[0][2], log });
    assert.ok(said.every((match) => match[2] === said[0][2]), 'one port in all addresses');
  } finally {
    child.kill('SIGTERM');
    assert.deepEqual(await ended, [0, null], log);
  }
}

const listed = (port) => within(here, 'ss', '-Hltn', `sport = :${port}`).stdout.trim().split('\n').map((line) => line.split(/\s+/)[3].replace(/:\d+$/, ''));
const reaches = (place, host, port) => within(place, 'curl', '-g', '-s', '-m', '3', '-o', '/dev/null', '-w', '%{http_code}', `http://${host}:${port}/healthz`).stdout !== '000';

const cases = [
  ['nothing', [], ['127.0.0.1'], { here: ['127.0.0.1'], there: [] }],
  ['127.0.0.1', ['--host', '127.0.0.1'], ['127.0.0.1'], { here: ['127.0.0.1'], there: [] }],
  ['::1', ['--host', '::1'], ['[::1]'], { here: ['[::1]'], there: [] }],
  ['[::1]', ['--host', '[::1]'], ['[::1]'], { here: ['[::1]'], there: [] }],
  ['localhost', ['--host', 'localhost'], ['127.0.0.1', '[::1]'], { here: ['127.0.0.1', '[::1]'], there: [] }],
  ['one address', ['--host', '10.77.0.1', ...remote], ['10.77.0.1'], { here: ['10.77.0.1'], there: ['10.77.0.1'] }],
  ['one address of IPv6', ['--host', 'fd77::1', ...remote], ['[fd77::1]'], { here: ['[fd77::1]'], there: ['[fd77::1]'] }],
  ['an interface', ['--host', 'face0', ...remote], ['10.77.0.1', '[fd77::1]', 'link'], { here: ['10.77.0.1', '[fd77::1]'], there: ['10.77.0.1', '[fd77::1]'] }],
  ['the interface lo, without --remote', ['--host', 'lo'], ['127.0.0.1', '[::1]'], { here: ['127.0.0.1', '[::1]'], there: [] }],
  ['0.0.0.0', ['--host', '0.0.0.0', ...remote], ['0.0.0.0'], { here: ['127.0.0.1', '10.77.0.1'], there: ['10.77.0.1'] }],
  ['::', ['--host', '::', ...remote], ['[::]'], { here: ['[::1]', '[fd77::1]'], there: ['[fd77::1]'] }],
  ['*', ['--host', '*', ...remote], ['0.0.0.0', '[::]'], { here: ['127.0.0.1', '10.77.0.1', '[::1]', '[fd77::1]'], there: ['10.77.0.1', '[fd77::1]'] }],
];
const all = ['127.0.0.1', '10.77.0.1', '[::1]', '[fd77::1]'];
// link-local addresses vary
const plain = (addresses) => addresses.map((address) => (/fe80/.test(address) ? 'link' : address)).sort();
for (const [name, options, bound, reached] of cases)
  test(`--host ${name}: listens on exactly these addresses`, { skip: refused }, () =>
    listens(options, ({ said, port }) => {
      assert.deepEqual(plain(listed(port)), [...bound].sort(), 'what the kernel lists');
      assert.deepEqual(plain(said), [...bound].sort(), 'what is said');
      assert.deepEqual(all.filter((host) => reaches(here, host, port)), all.filter((host) => reached.here.includes(host)), 'from this machine');
      assert.deepEqual(all.slice(1).filter((host) => host !== '[::1]' && reaches(there, host, port)), reached.there, 'from another one');
    }));

test('remote clients need --remote and tokens', { skip: refused }, () => {
  for (const host of ['10.77.0.1', 'fd77::1', 'face0', '0.0.0.0', '::', '*', 'nowhere.invalid']) {
    const { status, stderr } = within(here, facciad, '--port', '0', '--host', host);
    assert.deepEqual([status, /--remote/.test(stderr)], [1, true], stderr);
    if (host === 'nowhere.invalid') continue;
    const open = within(here, facciad, '--port', '0', '--host', host, '--remote');
    assert.deepEqual([open.status, /--secret-file/.test(open.stderr)], [1, true], open.stderr);
  }
});

// like systemd: listens, and passes the socket as descriptor 3
const passing = `
import os, socket, sys
kind, address, program = sys.argv[1], sys.argv[2], sys.argv[3:]
s = socket.socket(getattr(socket, kind))
s.bind(address if kind == 'AF_UNIX' else (address, 0))
if os.environ.get('NO_LISTEN') is None:
    s.listen()
os.dup2(s.fileno(), 3)
os.set_inheritable(3, True)
os.environ.update(LISTEN_FDS='1', LISTEN_PID=str(os.getpid()))
os.execv(program[0], program)
`;
const passed = async (kind, address, options = [], env = {}) => {
  const child = spawn('python3', ['-c', passing, kind, address, facciad, ...options], { stdio: ['ignore', 'ignore', 'pipe'], env: { ...process.env, FACCIA_STOP_SECONDS: '0', ...env } });
  let log = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (log += text));
  const ended = once(child, 'exit');
  while (!/listening on .*\n[^]*\n/.test(log) && child.exitCode === null) await new Promise((resolve) => setTimeout(resolve, 20));
  return { child, ended, log: () => log };
};

test('a passed socket obeys the same rule', async () => {
  for (const [kind, address] of [['AF_INET', '0.0.0.0'], ['AF_INET6', '::']]) {
    const shut = await passed(kind, address);
    assert.deepEqual(await shut.ended, [1, null]);
    assert.match(shut.log(), /is not a loopback address.*--remote/);
    const naked = await passed(kind, address, ['--remote']);
    assert.deepEqual(await naked.ended, [1, null]);
    assert.match(naked.log(), /--secret-file/);
  }
  const open = await passed('AF_INET', '0.0.0.0', remote);
  assert.match(open.log(), /listening on http:\/\/0\.0\.0\.0:\d+\//);
  open.child.kill('SIGTERM');
  assert.deepEqual(await open.ended, [0, null]);
  const silent = await passed('AF_INET', '127.0.0.1', [], { NO_LISTEN: '1' });
  assert.deepEqual(await silent.ended, [1, null]);
  assert.match(silent.log(), /no socket that listens/);
});

test('treats a passed unix socket as local', async () => {
  const where = path.join(folder, 'socket');
  const { child, ended, log } = await passed('AF_UNIX', where);
  assert.match(log(), /listening on unix:.*socket/);
  assert.match(run('curl', '-s', '--unix-socket', where, 'http://localhost/v1/models').stdout, /"mara"/);
  child.kill('SIGTERM');
  assert.deepEqual(await ended, [0, null]);
});
