// SPDX-License-Identifier: GPL-3.0-or-later
// State shared by all daemons of a cluster over a real Redis: quotas of addresses and subjects, and revoked token secrets. Also after
// Redis is lost and comes back empty.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';
import { bearer, sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-shares-'));
const secret = 'a secret that is long enough for the daemon';
const second = 'another one that is long enough for the daemon';
const REQUESTS = 60;
const STREAMS = 8;
const file = (name, ...lines) => {
  fs.writeFileSync(path.join(folder, name), `${lines.join('\n')}\n`, { mode: 0o600 });
  return path.join(folder, name);
};
const as = (sub, by = secret) => bearer(sign({ secret: by, claims: { sub, rights: 'listen speak operate' } }));
let redis;
let a;
let b;
const daemons = new Set();
const start = async (name, ...more) => {
  const limits = ['--max-requests', String(REQUESTS), '--max-per-address', String(STREAMS)];
  const daemon = await Daemon.start(['--cluster', redis.url, '--secret-file', file(name, secret, second), ...limits, ...more]);
  daemons.add(daemon);
  await health(daemon, 'up');
  return daemon;
};
const health = (daemon, state) => eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === state, `the cluster to be ${state}`);
const stop = async (daemon, signal = 'SIGTERM') => {
  daemons.delete(daemon);
  daemon.process.kill(signal);
  await daemon.exited;
};
/** Returns the status of a request on a new connection. */
const status = async (daemon, who, address = '/v1/rooms', method = 'GET') => {
  const response = await daemon.get(address, { method, headers: { ...who.headers, connection: 'close' } });
  const text = await response.text();
  return response.status < 300 ? 'well' : JSON.parse(text).code;
};
let looks = 0;
const metric = async (daemon, name) => {
  const text = await (await daemon.get('/metrics', { headers: { ...as(`prometheus ${looks++}`).headers, connection: 'close' } })).text();
  return Number(new RegExp(`^${name} (.*)$`, 'm').exec(text)[1]);
};
/** Opens as many streams as allowed, one by one, because a connection counts for its address until its token is read. */
const streams = async (daemon, who) => {
  const open = [];
  while (open.length < STREAMS) open.push(await daemon.stream('', who));
  return open;
};

before(async () => {
  redis = await Redis.start();
  a = await start('a');
  b = await start('b');
});
after(async () => {
  for (const daemon of daemons) await stop(daemon);
  redis.stop();
  fs.rmSync(folder, { recursive: true });
});

test('counts the requests of a subject per minute across all daemons', async () => {
  for (const who of [as('anna'), as('anna again')]) { // the second subject, in case the minute ends during the first
    const minute = Math.floor(redis.cli('time').split('\n')[0] / 60);
    const asked = async (daemon) => (await status(daemon, who, '/v1/stop?room=empty', 'POST')) !== 'too-many-requests';
    let here = 0;
    let there = 0;
    while (here <= REQUESTS && (await asked(a))) here++;
    while (there <= REQUESTS && (await asked(b))) {
      there++;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    if (Math.floor(redis.cli('time').split('\n')[0] / 60) !== minute) continue;
    assert.equal(here, REQUESTS);
    assert.ok(there < REQUESTS / 2, `${there} more at another daemon`);
    assert.equal(await status(b, as('bert'), '/v1/stop?room=empty', 'POST'), 'unknown-room');
    return;
  }
  assert.fail('two minutes ended');
});

test('counts the connections of a subject across all daemons, until they close or their daemon dies', async () => {
  const carla = as('carla');
  const open = await streams(a, carla);
  await eventually(async () => (await status(b, carla)) === 'too-many-per-address', 'the others to know');
  assert.equal(await status(b, as('dora')), 'well');
  open.forEach((stream) => stream.socket.terminate());
  await eventually(async () => (await status(b, carla)) === 'well', 'the others to know that they are closed');
  const c = await start('c');
  await streams(c, carla);
  for (const daemon of [a, b]) await eventually(async () => (await status(daemon, carla)) === 'too-many-per-address', 'the others to know');
  await stop(c, 'SIGKILL');
  for (const daemon of [a, b]) await eventually(async () => (await status(daemon, carla)) === 'well', 'the dead to be forgotten');
});

test('a new daemon counts the open connections; without Redis each counts its own, afterwards all count together again', async () => {
  const elio = as('elio');
  await streams(a, elio);
  const c = await start('c');
  await eventually(async () => (await status(c, elio)) === 'too-many-per-address', 'the new one to know');
  redis.stop();
  for (const daemon of [a, b, c]) await health(daemon, 'away');
  await c.logged(/cluster: .*\(counts\): .*; continuing without the cluster/); // each connection to Redis reports separately
  await eventually(async () => (await metric(c, 'faccia_presence_up')) === 0, 'the metric');
  assert.equal(await status(c, elio), 'well');
  assert.equal(await status(a, elio), 'too-many-per-address');
  redis.again();
  for (const daemon of [a, b, c]) await health(daemon, 'up');
  for (const daemon of [b, c]) await eventually(async () => (await status(daemon, elio)) === 'too-many-per-address', 'all to know again');
  assert.equal(await metric(c, 'faccia_presence_up'), 1);
  await stop(c);
});

test('a secret dropped by one daemon is revoked on every daemon, including later ones', async () => {
  const old = as('fabio', second);
  const stream = await b.stream('?room=hall', old);
  assert.equal(await status(b, old), 'well');
  file('a', secret);
  a.process.kill('SIGHUP');
  await stream.wait({ type: 'error', code: 'revoked-token' });
  assert.equal(await status(b, old), 'bad-token');
  assert.equal(await status(a, old), 'bad-token');
  assert.match(b.log, /1 of the 2 secrets in the secret file are revoked/);
  const late = async (name) => {
    const daemon = await start(name);
    await eventually(async () => (await status(daemon, old)) === 'bad-token', 'the new one to know');
    assert.equal(await status(daemon, as('fabio')), 'well');
    await stop(daemon);
  };
  await late('later');
  redis.cli('flushall');
  await late('after it was emptied');
  redis.stop();
  await health(a, 'away');
  assert.equal(await status(b, old), 'bad-token');
  redis.again();
  await health(a, 'up');
  await late('after it was away');
  // not even after its settings are reloaded
  b.process.kill('SIGHUP');
  await b.logged(/settings reloaded/);
  assert.equal(await status(b, old), 'bad-token');
});

test('reports a daemon with different limits', async () => {
  const c = await start('c', '--max-requests', '7');
  for (const [daemon, count] of [[a, 1], [c, 2]]) await eventually(async () => (await metric(daemon, 'faccia_cluster_mismatched')) === count, 'it to be seen');
  assert.match(a.log, /a daemon has different settings: .*max-requests 7; this daemon: .*max-requests 60/);
  await stop(c);
  await eventually(async () => (await metric(a, 'faccia_cluster_mismatched')) === 0, 'it to be forgotten');
});

test('ignores invalid presence data, and one daemon cannot harm another with it', async () => {
  const ghost = 'f'.repeat(32);
  const PUT = `redis.call('HSET', KEYS[1] .. ':notes:' .. ARGV[1], ARGV[2], ARGV[3])
    redis.call('ZADD', KEYS[1] .. ':changes', redis.call('INCR', KEYS[1] .. ':count'), ARGV[1] .. ' ' .. ARGV[2])`;
  const put = (who, name, text) => redis.cli('eval', PUT, '1', 'faccia:presence', who, name, text);
  redis.cli('zadd', 'faccia:presence', String(Date.now() + 60000), ghost);
  const notes = { limits: 'x'.repeat(500), 'use s gina': '9 9', 'use s': '-1 -1 -1', 'use s hugo': '99999999999 0 0', ['n'.repeat(500)]: 'x', '': '' };
  for (const [name, text] of Object.entries(notes)) put(ghost, name, text);
  put('*', 'secret nobody has it', '');
  put('who has never looked', 'use s gina', `${STREAMS} 0 0`);
  put(ghost, 'use s ivo', `${STREAMS} 0 0`);
  await eventually(async () => (await status(b, as('ivo'))) === 'too-many-per-address', 'what came after it to be seen');
  assert.equal(await status(b, as('gina')), 'well');
  await health(b, 'up');
  redis.cli('zadd', 'faccia:presence', '1', ghost);
  await eventually(async () => (await status(b, as('ivo'))) === 'well', 'the ghost to go');
});

test('limits the number of daemons that follow a room', async () => {
  await b.stream('?room=many', as('ada'));
  const lease = await eventually(() => redis.cli('get', 'faccia:lease:room:many'), 'somebody to have the room');
  const CROWD = `for i = 1, 600 do redis.call('PUBLISH', ARGV[1], string.format('{"v":5,"kind":"here","room":"many","from":"ghost%d","visit":1}\\n', i)) end`;
  redis.cli('eval', CROWD, '0', `faccia:to:${lease.split(' ')[0]}`);
  await eventually(() => b.log.includes('room many: 256 daemons follow; ignoring the rest'), 'the limit');
  await health(b, 'up');
  assert.equal(b.log.match(/room many: the daemon ghost\S* follows$/gm).length, 256);
});
