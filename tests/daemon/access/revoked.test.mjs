// SPDX-License-Identifier: GPL-3.0-or-later
// Revoked tokens: by file, over HTTP and by subject; and on all daemons of a cluster with a real Redis.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';
import { bearer, now, sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-revoked-'));
const secret = 'a secret that is long enough for the daemon';
const file = (name, ...lines) => {
  fs.writeFileSync(path.join(folder, name), `${lines.join('\n')}\n`, { mode: 0o600 });
  return path.join(folder, name);
};
const secrets = file('secrets', secret);
let tokens = 0;
/** Makes a unique token. */
const make = (claims = {}) => {
  const jti = `token ${tokens++}`;
  return { jti, text: sign({ secret, claims: { jti, iat: now() - 60, rights: 'listen speak operate', ...claims } }) };
};
const master = make({ sub: 'the operator' });
const code = async (daemon, { text }) => {
  const response = await daemon.get('/v1/rooms', { headers: { ...bearer(text).headers, connection: 'close' } });
  const answer = await response.json();
  return response.status < 300 ? 'well' : answer.code;
};
const revoke = async (daemon, body, by = master) => {
  const response = await daemon.get('/v1/revoke', { method: 'POST', body: typeof body === 'string' ? body : JSON.stringify(body), headers: { ...bearer(by.text).headers, connection: 'close' } });
  const answer = await response.json();
  return response.status < 300 ? answer : `${response.status} ${answer.code} ${answer.field ?? ''}`.trim();
};
const faccia = (...words) => spawnSync(path.join(build, 'server/cli/faccia'), ['token', ...words], { encoding: 'utf8' });
const hup = async (daemon) => {
  const before = daemon.log.split('settings reloaded').length;
  daemon.process.kill('SIGHUP');
  await eventually(() => daemon.log.split('settings reloaded').length > before, 'the settings to be read');
};

let daemon;
before(async () => (daemon = await Daemon.start(['--secret-file', secrets, '--revoked-file', file('revoked', '# none yet')])));
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

test('the revocation printed for a token revokes that token only', async () => {
  const [one, other] = ['one', 'other'].map(() => ({ text: faccia('--secret-file', secrets, '--subject', 'anna').stdout.trim() }));
  const { jti, iat, exp } = JSON.parse(Buffer.from(one.text.split('.')[1], 'base64url'));
  assert.match(jti, /^[0-9a-f]{32}$/);
  assert.equal(exp - iat, 15 * 60);
  const line = faccia('--secret-file', secrets, '--revoke', one.text);
  assert.equal(line.stdout, `token ${exp} ${jti}\n`);
  const stream = await daemon.stream('?room=hall', bearer(one.text));
  const still = await daemon.stream('?room=hall', bearer(other.text));
  for (const s of [stream, still]) await s.wait({ type: 'joined' });
  const events = (await daemon.get('/v1/events?room=hall', bearer(one.text))).text();
  file('revoked', line.stdout);
  await hup(daemon);
  await stream.wait({ type: 'error', code: 'revoked-token' });
  await stream.wait({ type: 'left', room: 'hall' });
  assert.match(await events, /event: error\ndata: .*"revoked-token"/);
  assert.equal(await code(daemon, one), 'revoked-token');
  assert.equal(await code(daemon, other), 'well');
  stream.send({ type: 'authorize', token: one.text });
  await stream.wait((m) => m.type === 'error' && m.code === 'revoked-token' && m !== stream.messages.find((x) => x.code === 'revoked-token'));
  stream.send({ type: 'authorize', token: other.text });
  await stream.wait({ type: 'authorized' });
  still.send({ type: 'speak', id: 'still', lang: 'it', text: 'Sì.' });
  await still.wait({ type: 'end', id: 'still', reason: 'done' });
  // the token stays revoked after its line is removed
  file('revoked', '');
  await hup(daemon);
  assert.equal(await code(daemon, one), 'revoked-token');
});

test('revokes all tokens of a subject issued up to a time', async () => {
  const [old, dateless, young] = [{ iat: now() - 60 }, { iat: undefined }, { iat: now() + 20 }].map((more) => make({ sub: 'Bruno B.', ...more }));
  const line = faccia('--revoke-subject', 'Bruno B.', '--expires', '1d').stdout;
  assert.match(line, /^subject \d+ \d+ Bruno B\.\n$/);
  file('revoked', line);
  await hup(daemon);
  assert.deepEqual([await code(daemon, old), await code(daemon, dateless), await code(daemon, young)], ['revoked-token', 'revoked-token', 'well']);
  assert.equal(await code(daemon, make({ sub: 'Bruno' })), 'well');
});

test('over HTTP: revokes a token, an id, a subject; the requesting token may be one of them', async () => {
  const [one, two, three, self] = [make(), make(), make({ sub: 'carla' }), make({ sub: 'dora' })];
  assert.deepEqual(await revoke(daemon, { token: one.text }), { type: 'revoked', exp: JSON.parse(Buffer.from(one.text.split('.')[1], 'base64url')).exp });
  assert.equal((await revoke(daemon, { jti: two.jti, exp: now() + 600 })).type, 'revoked');
  assert.equal((await revoke(daemon, { sub: 'carla', exp: now() + 600 })).type, 'revoked');
  assert.equal((await revoke(daemon, { token: self.text }, self)).type, 'revoked');
  for (const token of [one, two, three, self]) assert.equal(await code(daemon, token), 'revoked-token');
  assert.equal(await code(daemon, make()), 'well');
  assert.equal(await revoke(daemon, { token: one.text }, make({ rights: 'listen speak' })), '403 forbidden');
  assert.equal(await revoke(daemon, { token: make().text }, make({ room: 'hall' })), '403 forbidden');
});

test('reports what cannot be revoked', async () => {
  const cases = [
    ['{', '400 bad-json'], ['[]', '400 missing-field token'], ['{}', '400 missing-field token'], ['{"token":7}', '400 missing-field token'],
    [{ token: 'x' }, '400 bad-field token'], [{ token: sign({ secret: `${secret}.`, claims: { jti: 'x' } }) }, '400 bad-field token'], [{ token: sign({ secret }) }, '400 bad-field token'],
    [{ jti: 'x' }, '400 missing-field exp'], [{ jti: 'x', exp: 'soon' }, '400 bad-field exp'], [{ jti: 'x', exp: now() - 1 }, '400 bad-field exp'],
    [{ jti: 'x', exp: 4e18 }, '400 bad-field exp'], [{ jti: '', exp: now() + 9 }, '400 bad-field jti'], [{ jti: 'x'.repeat(2000), exp: now() + 9 }, '400 bad-field jti'],
    [{ sub: 'x', iat: now() + 600, exp: now() + 900 }, '400 bad-field iat'], [{ sub: 'x', iat: -1, exp: now() + 9 }, '400 bad-field iat'],
    [{ sub: 'x', jti: 'x', exp: now() + 9 }, '400 missing-field token'], ['x'.repeat(2 << 20), '413 message-too-long'],
  ];
  for (const [body, wanted] of cases) assert.equal(await revoke(daemon, body), wanted, JSON.stringify(body).slice(0, 100));
  for (const line of ['token', 'token x y', 'token 5', 'token 5 ', 'tokens 5 x', 'subject 5 x', `subject ${now() + 99} ${now() + 999} x`, 'token 99999999999999 x', 'token -5 x']) {
    file('revoked', '# fine', line);
    const log = daemon.log.length;
    daemon.process.kill('SIGHUP');
    await eventually(() => /revoked:2:1|must be 'token UNTIL JTI'[^]*keeping the current settings/.test(daemon.log.slice(log)), line);
  }
  fs.chmodSync(path.join(folder, 'revoked'), 0o666);
  const { status, stderr } = spawnSync(path.join(build, 'server/daemon/facciad'), ['--port', '0', '--revoked-file', path.join(folder, 'revoked')], { encoding: 'utf8', timeout: 20000 });
  assert.equal(status, 1);
  assert.match(stderr, /revoked: users other than its owner can write it/);
  fs.chmodSync(path.join(folder, 'revoked'), 0o600);
  file('revoked', '');
  for (const words of [['--revoke', 'x'], ['--secret-file', secrets], ['--revoke-subject', 'x', '--subject', 'y']]) assert.equal(faccia(...words).status, 2);
  assert.match(faccia('--secret-file', secrets, '--revoke', sign({ secret })).stderr, /has no 'jti'/);
});

test('a full list drops the revocations that expire first', async () => {
  const lines = Array.from({ length: 4000 }, (_, i) => `token ${now() + 10000 + i} many ${i}`);
  file('revoked', ...lines, `token ${now() + 99999} the last`);
  await hup(daemon);
  assert.match(daemon.log, /more than 4000 tokens are revoked/);
  const last = make({ jti: 'the last', exp: now() + 99999 });
  assert.equal(await code(daemon, last), 'revoked-token');
  assert.equal(await code(daemon, make({ jti: 'many 3999' })), 'revoked-token');
  file('revoked', '');
});

test('across a cluster: revokes at all daemons, including later ones, until the token expires', async () => {
  const redis = await Redis.start();
  const daemons = new Set();
  const start = async (...more) => {
    const one = await Daemon.start(['--cluster', redis.url, '--secret-file', secrets, ...more]);
    daemons.add(one);
    await eventually(async () => (await (await one.get('/healthz')).json()).cluster === 'up', 'the cluster');
    return one;
  };
  const stop = async (one) => {
    daemons.delete(one);
    assert.equal((await one.stop()).code, 0);
  };
  try {
    const filed = make();
    const a = await start('--revoked-file', file('of-a', `token ${now() + 600} ${filed.jti}`));
    const b = await start();
    const refused = (one, token) => eventually(async () => (await code(one, token)) === 'revoked-token', 'it to be known');
    await refused(b, filed);
    const [one, other] = [make(), make()];
    const stream = await b.stream('?room=hall', bearer(one.text));
    await stream.wait({ type: 'joined' });
    await revoke(a, { token: one.text });
    await stream.wait({ type: 'error', code: 'revoked-token' });
    await refused(b, one);
    assert.equal(await code(b, other), 'well');
    await revoke(b, { sub: 'anna', iat: now() - 30, exp: now() + 600 });
    await refused(a, other);
    assert.equal(await code(a, make({ iat: now() })), 'well');
    const late = async () => {
      const c = await start();
      for (const token of [filed, one, other]) await refused(c, token);
      await stop(c);
    };
    await late();
    redis.cli('flushall');
    await late();
    // Redis drops expired entries, too; malformed entries do no harm
    const kept = Number(redis.cli('zcard', 'faccia:presence:marks'));
    await revoke(a, { jti: 'short', exp: now() + 3 });
    await eventually(() => Number(redis.cli('zcard', 'faccia:presence:marks')) === kept + 1, 'it to be written up');
    await eventually(() => Number(redis.cli('zcard', 'faccia:presence:marks')) === kept, 'it to be forgotten');
    assert.equal(redis.cli('zscore', 'faccia:presence:ends', 'short').trim(), '');
    const PUT = `redis.call('ZADD', 'faccia:presence:marks', 1, ARGV[1]) redis.call('ZADD', 'faccia:presence:ends', ARGV[2], ARGV[1])
      redis.call('ZADD', 'faccia:presence:changes', redis.call('INCR', 'faccia:presence:count'), '* ' .. ARGV[1])`;
    for (const [name, until] of [['token', '1e300'], ['token x', '9e15'], [`token t${'0'.repeat(32)} -5 9`, '9e15'], [`token s${'0'.repeat(32)} 5 5 5`, '1e300'], [`token ${'t'.repeat(90)} 5 5`, '9e15']])
      redis.cli('eval', PUT, '0', name, until);
    const last = make();
    await revoke(a, { token: last.text });
    await refused(b, last);
    assert.equal(await code(b, make({ sub: 'gina' })), 'well');
  } finally {
    for (const one of daemons) await one.stop();
    redis.stop();
  }
});
