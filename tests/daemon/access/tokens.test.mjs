// SPDX-License-Identifier: GPL-3.0-or-later
// Tokens: rooms, dates, headers, removed secrets, and the secrets file.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, root } from '../../lib/daemon.mjs';
import { bearer, now, sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-tokens-'));
const secret = 'a secret that is long enough for the daemon';
const second = 'another one that is long enough for the daemon';
const file = (name, lines, mode = 0o600) => {
  fs.writeFileSync(path.join(folder, name), `${lines.join('\n')}\n`, { mode });
  fs.chmodSync(path.join(folder, name), mode); // independent of the umask
  return path.join(folder, name);
};
const token = (claims, more) => sign({ secret, claims, ...more });
const hall = { room: 'hall', rights: 'listen speak operate' };

let daemon;
before(async () => (daemon = await Daemon.start(['--secret-file', file('secrets', [secret])])));
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const code = async (response) => {
  const text = await response.text();
  return response.status < 300 ? response.status : `${response.status} ${JSON.parse(text).code}`;
};

test("a room's token permits actions on that room only", async () => {
  const inside = await daemon.stream('?room=hall', bearer(token()));
  await inside.wait({ type: 'joined', room: 'hall' });
  const elsewhere = await daemon.stream('?room=secret-meeting', bearer(token()));
  await elsewhere.wait({ type: 'joined' });
  const ask = async (address, method = 'GET') =>
    code(await daemon.get(address, { method, body: method === 'POST' ? 'Sì.' : undefined, ...bearer(token(hall)) }));
  for (const query of ['', '?room=hall', '?room=hall&room=', '?lang=it&room=hall', '?room=']) {
    assert.equal(await ask(`/v1/media${query}`), '403 forbidden', query);
    assert.equal(await ask(`/v1/speech${query}`, 'POST'), '403 forbidden', query);
    assert.equal(await ask(`/v1/speech${query || '?'}&text=Ciao`), '403 forbidden', query);
    assert.equal(await ask(`/metrics${query}`), '403 forbidden', query);
  }
  assert.equal(await ask('/v1/say?room=hall', 'POST'), 202);
  assert.equal(await ask('/v1/stop?room=hall', 'POST'), 200);
  assert.equal(await ask('/v1/rooms/hall/commands', 'POST'), '400 bad-json');
  assert.equal(await ask('/v1/rooms/secret-meeting/commands', 'POST'), '403 forbidden');
  for (const act of ['say', 'stop', 'play']) assert.equal(await ask(`/v1/${act}?room=secret-meeting`, 'POST'), '403 forbidden');
  assert.equal(await ask('/v1/events?room=secret-meeting'), '403 forbidden');
  // lists only the token's rooms
  for (const query of ['', '?room=secret-meeting', '?room=hall']) {
    const { rooms } = await (await daemon.get(`/v1/rooms${query}`, bearer(token(hall)))).json();
    assert.deepEqual(rooms.map((r) => r.name), ['hall'], query);
  }
  const { rooms } = await (await daemon.get('/v1/rooms', bearer(token()))).json();
  assert.deepEqual(rooms.map((r) => r.name).sort(), ['hall', 'secret-meeting']);
  // a room in the stream's address does not grant more
  const stream = await daemon.stream('?room=hall', bearer(token(hall)));
  await stream.wait({ type: 'joined', may_speak: true });
  stream.send({ type: 'join', room: 'secret-meeting' });
  await stream.wait({ type: 'error', code: 'forbidden' });
  stream.send({ type: 'leave' });
  await stream.wait({ type: 'left' });
  stream.send({ type: 'speak', id: 'own', text: 'Sì.' });
  await stream.wait({ type: 'error', code: 'forbidden', id: 'own' });
  await Promise.all([stream, inside, elsewhere].map((s) => s.close()));
});

test('each message needs the right that protocol/messages.json declares', async () => {
  const { client: messages } = JSON.parse(fs.readFileSync(path.join(root, 'protocol/messages.json')));
  const members = { speak: { text: 'Sì.' }, ask: { text: 'Sì.' }, text: { text: 'Sì.' }, rate: { rate: 150 }, jump: { mark: 'm' }, play: { name: 'x' }, express: { mix: [] }, join: { room: 'hall' }, authorize: { token: 'x' },
    choices: { choices: [] }, choose: { choice: 0 }, state: { state: 'idle' }, calibrate: { reset: true }, consent: { consent: 'asked' }, voice: { rate: 16000 }, hear: { rate: 16000 } };
  const told = { listen: {}, speak: {} };
  for (const right of Object.keys(told)) {
    const stream = await daemon.stream('', bearer(token({ rights: right })));
    for (const type of Object.keys(messages).filter((one) => one !== 'authorize')) {
      const from = stream.messages.length;
      stream.send({ type, id: `id-${type}`, ...members[type] });
      stream.send({ type: 'ping', id: type });
      await stream.wait({ type: 'pong', id: type }, { from });
      told[right][type] = stream.messages.slice(from).some(({ code }) => code === 'forbidden');
    }
    await stream.close();
  }
  for (const [type, { right }] of Object.entries(messages).filter(([one]) => one !== 'authorize')) {
    assert.equal(told.listen[type], right === 'speak', `${type} of who may listen`);
    assert.equal(told.speak[type], right === 'listen', `${type} of who may speak`);
  }
});

const odd = [
  ['nbf to come', { nbf: now() + 3600 }, {}, 'early-token'],
  ['nbf of a moment ahead: clocks differ', { nbf: now() + 10 }, {}, null],
  ['nbf that is no date', { nbf: 'tomorrow' }, {}, 'bad-token'],
  ['iat to come', { iat: now() + 3600 }, {}, 'early-token'],
  ['iat of now', { iat: now() }, {}, null],
  ['exp missing', { exp: undefined }, {}, 'bad-token'],
  ['exp as a string', { exp: String(now() + 600) }, {}, 'bad-token'],
  ['exp over', { exp: now() - 1 }, {}, 'expired-token'],
  ['rights as a list', { rights: ['speak'] }, {}, 'bad-token'],
  ['a room that is no string', { room: 7 }, {}, 'bad-token'],
  ['crit', {}, { header: { crit: ['exp'] } }, 'bad-token'],
  ['crit of an extension', {}, { header: { crit: ['b64'], b64: false } }, 'bad-token'],
  ['crit, empty', {}, { header: { crit: [] } }, 'bad-token'],
  ['alg none', {}, { header: { alg: 'none' } }, 'bad-token'],
  ['alg HS512, rightly signed', {}, { header: { alg: 'HS512' }, hash: 'sha512' }, 'bad-token'],
  ['alg HS384, rightly signed', {}, { header: { alg: 'HS384' }, hash: 'sha384' }, 'bad-token'],
  ['alg RS256 with an HMAC', {}, { header: { alg: 'RS256' } }, 'bad-token'],
  ['a header field that nobody need know', {}, { header: { kid: '1' } }, null],
];
for (const [what, claims, more, wanted] of odd)
  test(`a token with ${what}: ${wanted ?? 'good'}`, async () => {
    const response = await daemon.get('/v1/rooms', bearer(token(claims, more)));
    assert.equal(await code(response), wanted ? `401 ${wanted}` : 200);
    const stream = await daemon.stream('', bearer(token(claims, more)));
    if (wanted) await stream.wait({ type: 'error', code: wanted });
    stream.send({ type: 'speak', id: 'x', lang: 'it', text: 'Sì.' });
    assert.equal((await stream.wait({ type: 'end', id: 'x' })).reason, wanted ? 'failed' : 'done');
    await stream.close();
  });

/** Collects server-sent events. */
async function events(daemon, room, token) {
  const response = await daemon.get(`/v1/events?room=${room}`, bearer(token));
  assert.equal(response.status, 200);
  const heard = { text: '', ended: false };
  heard.end = (async () => {
    const decoder = new TextDecoder();
    for await (const bytes of response.body) heard.text += decoder.decode(bytes, { stream: true });
    heard.ended = true;
  })();
  return heard;
}

test('SIGHUP: clients of a dropped secret lose all rights, others none', async () => {
  const where = file('changing', [secret, second]);
  const own = await Daemon.start(['--secret-file', where]);
  const [old, kept] = [sign({ secret }), sign({ secret: second, claims: { sub: 'bruno' } })];
  const [inRoom, alone, other] = await Promise.all([own.stream('?room=hall', bearer(old)), own.stream('', bearer(old)), own.stream('?room=hall', bearer(kept))]);
  const [lost, still] = [await events(own, 'hall', old), await events(own, 'hall', kept)];
  still.end.catch(() => {}); // stopping the daemon cuts it
  await Promise.all([inRoom.wait({ type: 'joined' }), other.wait({ type: 'joined' })]);
  const long = 'Una frase lunga, che non finisce mai. '.repeat(20);
  alone.send({ type: 'speak', id: 'cut', lang: 'it', text: long });
  await alone.wait({ type: 'word' });
  file('changing', [second]);
  own.process.kill('SIGHUP');
  await own.logged(/settings reloaded/);
  for (const stream of [inRoom, alone]) await stream.wait({ type: 'error', code: 'revoked-token' });
  await inRoom.wait({ type: 'left', room: 'hall' });
  await alone.wait({ type: 'end', id: 'cut', reason: 'stopped' });
  await lost.end;
  assert.match(lost.text, /event: error\ndata: .*"revoked-token"/);
  // members with the right to listen hear the room
  other.send({ type: 'speak', id: 'still', lang: 'it', text: 'Ci siamo ancora.' });
  await other.wait({ type: 'end', id: 'still', reason: 'done' });
  assert.ok(!inRoom.messages.some((m) => m.id === 'still'));
  assert.match(still.text, /"still"/);
  assert.equal(still.ended, false);
  for (const stream of [inRoom, alone]) {
    stream.send({ type: 'speak', id: 'late', lang: 'it', text: 'Sì.' });
    await stream.wait({ type: 'error', id: 'late', code: 'token-needed' });
    stream.send({ type: 'join', room: 'hall' });
    await stream.wait((m) => m.type === 'error' && !m.id && m.code === 'token-needed');
  }
  alone.send({ type: 'authorize', token: kept });
  await alone.wait({ type: 'authorized' });
  alone.send({ type: 'speak', id: 'again', lang: 'it', text: 'Sì.' });
  await alone.wait({ type: 'end', id: 'again', reason: 'done' });
  assert.equal((await own.stop()).code, 0);
});

test('SIGHUP: a daemon that starts to require tokens also asks connected clients', async () => {
  const config = path.join(folder, 'config.json');
  fs.writeFileSync(config, '{}');
  const own = await Daemon.start(['--config', config]);
  const stream = await own.stream('?room=hall');
  await stream.wait({ type: 'joined' });
  fs.writeFileSync(config, JSON.stringify({ access: { secret_file: file('new', [secret]) } }));
  own.process.kill('SIGHUP');
  await stream.wait({ type: 'error', code: 'revoked-token' });
  await stream.wait({ type: 'left' });
  assert.equal((await own.stop()).code, 0);
});

const start = (where) => spawnSync(path.join(build, 'server/daemon/facciad'), ['--port', '0', '--secret-file', where], { encoding: 'utf8', timeout: 20000 });

test('refuses a file of secrets that others may write or replace', () => {
  for (const mode of [0o620, 0o602, 0o666]) {
    const { status, stderr } = start(file('open', [secret], mode));
    assert.equal(status, 1);
    assert.match(stderr, new RegExp(`open: users other than its owner can write it \\(mode ${mode.toString(8)}\\)`));
  }
  const shared = path.join(folder, 'shared');
  fs.mkdirSync(shared);
  fs.writeFileSync(path.join(shared, 'secrets'), `${secret}\n`, { mode: 0o600 });
  fs.chmodSync(shared, 0o777);
  const { status, stderr } = start(path.join(shared, 'secrets'));
  assert.equal(status, 1);
  assert.match(stderr, /can replace it, because they can write its folder \(mode 777\)/);
  assert.match(start(shared).stderr, /is a folder, not a file of secrets/);
});

test('warns of a world-readable secret file; SIGHUP refuses one that others can write', async () => {
  const where = file('readable', [secret], 0o644);
  const own = await Daemon.start(['--secret-file', where]);
  assert.match(own.log, /warning: .*readable: every user of this machine can read the secrets/);
  fs.chmodSync(where, 0o646);
  own.process.kill('SIGHUP');
  await own.logged(/users other than its owner can write it[^]*keeping the current settings/);
  assert.equal((await own.get('/v1/rooms', bearer(sign({ secret })))).status, 200);
  assert.equal((await own.stop()).code, 0);
});
