// SPDX-License-Identifier: GPL-3.0-or-later
// The table of commands: every command of a stream also works over HTTP with the same JSON, effect and permissions. The list comes from
// the table, so new commands are tested automatically.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, root } from '../../lib/daemon.mjs';
import { bearer, sign } from '../../lib/tokens.mjs';

const table = fs.readFileSync(path.join(root, 'server/api/commands.c'), 'utf8').match(/commands\[\] = \{([^;]+)\};/)[1];
const declared = JSON.parse(fs.readFileSync(path.join(root, 'protocol/messages.json'), 'utf8')).client;
const rows = [...table.matchAll(/\{"(\w+)",([^}]*)\}/g)].map(([, name, rest]) => ({ name, right: declared[name]?.right, own: rest.includes('.act') }));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-commands-'));
const secret = 'a secret that is long enough for the daemon';
let daemon, guarded;
before(async () => {
  fs.writeFileSync(path.join(folder, 'secrets'), `${secret}\n`, { mode: 0o600 });
  fs.mkdirSync(path.join(folder, 'media'));
  fs.writeFileSync(path.join(folder, 'media', 'nod.fap'), `2.1 x 25 1\n0 ${'0 '.repeat(67)}\n0\n`);
  [daemon, guarded] = await Promise.all([Daemon.start(['--lang', 'it', '--media', path.join(folder, 'media'), '--hold', '60']), Daemon.start(['--secret-file', path.join(folder, 'secrets')])]);
});
after(async () => {
  for (const each of [daemon, guarded]) assert.deepEqual(await each.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const give = async (room, message, { from = daemon, ...options } = {}) => {
  const body = typeof message === 'string' ? message : JSON.stringify(message);
  const answer = await from.get(`/v1/rooms/${room}/commands`, { method: 'POST', body, ...options });
  return { status: answer.status, ...(await answer.json()) };
};
const enter = async (room, from = daemon, options = {}) => {
  const stream = await from.stream(`?room=${room}`, options);
  await stream.wait({ type: 'joined', room });
  return stream;
};

// each command, and the message that the room gets for it
const LONG = '<speak>Uno, due, tre, quattro. <mark name="m"/> Cinque, sei, sette, otto, nove. Dieci, undici, dodici.</speak>';
const cases = {
  speak: [{ id: 's', text: LONG, markup: 'ssml' }, { type: 'begin', id: 's' }],
  pause: [{}, { type: 'paused' }],
  resume: [{}, { type: 'resumed' }],
  rate: [{ rate: 240 }, null],
  jump: [{ mark: 'm' }, { type: 'jumped', mark: 'm' }],
  cancel: [{ id: 's' }, { type: 'end', id: 's', reason: 'stopped' }],
  play: [{ id: 'p', name: 'nod' }, { type: 'begin', id: 'p' }],
  stop: [{}, null],
  ask: [{ id: 'a', text: 'Sì?', choices: ['Sì'], wait: false }, { type: 'asked', id: 'a' }],
  express: [{ mix: [{ name: 'joy' }] }, { type: 'expressed', mix: [{ name: 'joy', intensity: 1 }] }],
  choices: [{ id: 'q', choices: ['Sì', 'No'] }, { type: 'choices', id: 'q' }],
  choose: [{ id: 'q', choice: 1 }, { type: 'chosen', text: 'No' }],
  state: [{ state: 'thinking' }, { type: 'state', state: 'thinking' }],
  calibrate: [{ reset: true }, { type: 'calibrated', reset: true }],
  head: [{ head: 'mara' }, { type: 'head', head: 'mara' }],
  lexicon: [{ lexicon: '' }, { type: 'lexicon', lexicon: '' }],
  backdrop: [{ source: 'x.png' }, { type: 'backdrop', source: 'x.png' }],
  manner: [{ speed: 0.8 }, null],
  said: [{ id: 'w', text: 'Sì' }, null],
  consent: [{ consent: 'asked', text: 'Va bene?' }, { type: 'consent', consent: 'asked' }],
};
const DONE = { stop: 'stopped', pause: 'paused', resume: 'resumed' };

test('each command of the table is declared, and covered here', () => {
  assert.ok(rows.length > 20);
  assert.deepEqual(rows.map(({ name }) => name).sort(), Object.keys(declared).sort());
  assert.deepEqual(Object.keys(cases).sort(), rows.filter(({ own }) => !own).map(({ name }) => name).sort());
});

test('every command works over HTTP and over a stream', async () => {
  for (const way of ['http', 'stream']) {
    const listener = await enter(way), other = await enter(way);
    for (const [type, [members, told]] of Object.entries(cases)) {
      const from = listener.messages.length;
      if (way === 'stream') other.send({ type, ...members });
      else assert.deepEqual(await give(way, { type, ...members }), DONE[type] ? { status: 200, type: DONE[type], room: way } : { status: 202, type: 'accepted', room: way, listeners: 2 }, type);
      if (told) await listener.wait(told, { from });
    }
    for (const stream of [listener, other]) await stream.close();
  }
});

test('holds speech for an empty room, as /v1/say does; other commands need a listener', async () => {
  assert.deepEqual(await give('empty', { type: 'speak', id: 'kept', text: 'Chi c’è?' }), { status: 202, type: 'accepted', room: 'empty', listeners: 0, held: 60 });
  for (const type of Object.keys(cases).filter((each) => each !== 'speak'))
    assert.deepEqual((({ status, code, field }) => [status, code, field])(await give('empty', { type, ...cases[type][0] })), [404, 'unknown-room', 'room'], type);
  const late = await enter('empty');
  await late.wait({ type: 'begin', id: 'kept' });
  await late.close();
});

test('refusals state the reason', async () => {
  const there = await enter('here');
  for (const { name } of rows.filter(({ own }) => own)) assert.deepEqual((({ status, code }) => [status, code])(await give('here', { type: name })), [400, 'unknown-type'], name);
  const near = await give('here', { type: 'sepak', text: 'Ciao.' });
  assert.deepEqual([near.status, near.code, near.field], [400, 'unknown-type', 'type']);
  assert.match(near.message, /speak/);
  for (const [message, status, code, field] of [
    ['{"type":', 400, 'bad-json'],
    ['', 400, 'bad-json'],
    ['[1]', 400, 'bad-message', 'type'],
    ['{"text":"Ciao."}', 400, 'bad-message', 'type'],
    [{ type: 'speak' }, 400, 'missing-field', 'text'],
    [{ type: 'speak', text: 'Ciao.', rate: 'fast' }, 400, 'bad-field', 'rate'],
    [{ type: 'speak', text: 'Ciao.', open: true, id: 'o' }, 400, 'bad-field', 'open'],
    [{ type: 'jump' }, 400, 'missing-field', 'mark'],
    [{ type: 'rate', rate: '2' }, 400, 'bad-field', 'rate'],
    [{ type: 'play' }, 400, 'missing-field', 'name'],
    [{ type: 'cancel', id: 'nobody' }, 404, 'unknown-utterance', 'id'],
  ]) {
    const refused = await give('here', message);
    assert.deepEqual([refused.status, refused.code, refused.field], [status, code, field], JSON.stringify(message));
  }
  const warned = await give('here', { type: 'speak', text: 'Ciao.', txet: 'x' });
  assert.equal(warned.warnings[0].field, 'txet');
  for (const [address, status] of [['/v1/rooms/here', 404], ['/v1/rooms/here/commands/x', 404], [`/v1/rooms/${'r'.repeat(65)}/commands`, 404], ['/v1/rooms/a%20b/commands', 404]])
    assert.equal((await daemon.get(address, { method: 'POST', body: '{"type":"stop"}' })).status, status, address);
  const get = await daemon.get('/v1/rooms/here/commands');
  assert.equal(get.status, 405);
  assert.equal((await daemon.get('/v1/rooms/here/commands', { method: 'OPTIONS' })).headers.get('allow'), 'POST, OPTIONS');
  await there.close();
});

test('each command requires its right, in its room', async () => {
  const right = (rights, room = 'e') => bearer(sign({ secret, claims: { sub: 'nonna', room, rights } }));
  const there = await enter('e', guarded, right('listen speak'));
  const heard = async (message, options) => (await give('e', message, { from: guarded, ...options })).code;
  for (const { name, right: needed } of rows.filter(({ own }) => !own)) {
    const message = { type: name, ...cases[name][0] };
    assert.equal(await heard(message), 'token-needed', name);
    assert.equal(await heard(message, right('speak', 'other')), 'forbidden', name);
    const asListener = await heard(message, right('listen'));
    if (needed !== 'speak') assert.notEqual(asListener, 'forbidden', name);
    else assert.equal(asListener, 'forbidden', name);
  }
  assert.equal((await give('e', cases.choices[0].id && { type: 'choices', ...cases.choices[0] }, { from: guarded, ...right('speak') })).status, 202);
  assert.equal((await give('e', { type: 'choose', choice: 0 }, { from: guarded, ...right('listen') })).status, 202);
  await there.wait({ type: 'chosen', by: 'nonna' });
  await there.close();
});
