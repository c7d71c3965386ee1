// SPDX-License-Identifier: GPL-3.0-or-later
// Choices, states and calibrations: recipients, permissions and errors.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import WebSocket from 'ws';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { bearer, sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-notices-'));
const secret = 'a secret that is long enough for the daemon';
const secrets = path.join(folder, 'secrets');
let daemon, guarded;
before(async () => {
  fs.writeFileSync(secrets, `${secret}\n`, { mode: 0o600 });
  [daemon, guarded] = await Promise.all([Daemon.start(), Daemon.start(['--secret-file', secrets])]);
});
after(async () => {
  for (const each of [daemon, guarded]) assert.deepEqual(await each.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const enter = async (room, { from = daemon, query = '', options = {} } = {}) => {
  const stream = await from.stream(`?room=${room}${query}`, options);
  await stream.wait({ type: 'joined', room });
  return stream;
};
const offer = { type: 'choices', id: 'q', question: 'Ha fame?', choices: ['Sì', 'No', 'Più tardi'] };
const post = (address, body, from = daemon, options = {}) => from.get(address, { method: 'POST', body, ...options });

test('asks everyone in the room, late joiners too, until someone has chosen', async () => {
  const operator = await enter('a'), packed = await enter('a', { query: '&events=packed' }), elsewhere = await enter('b');
  operator.send(offer);
  operator.send({ type: 'state', state: 'listening', text: 'mmh' });
  for (const stream of [operator, packed]) {
    const { arrived, ...told } = await stream.wait({ type: 'choices' });
    assert.deepEqual(told, { ...offer, stream: 'a' });
    await stream.wait({ type: 'state', state: 'listening', text: 'mmh', stream: 'a' });
  }
  const late = await enter('a');
  await late.wait({ type: 'choices', id: 'q' });
  await late.wait({ type: 'state', state: 'listening' });
  late.send({ type: 'choose', id: 'old', choice: 0 });
  await late.wait({ type: 'error', code: 'no-choices' });
  late.send({ type: 'choose', id: 'q', choice: 3 });
  await late.wait({ type: 'error', code: 'bad-field', field: 'choice' });
  late.send({ type: 'choose', id: 'q', choice: 2 });
  packed.send({ type: 'choose', id: 'q', choice: 0 }); // concurrently
  for (const stream of [operator, packed, late]) await stream.wait({ type: 'chosen', id: 'q', stream: 'a' });
  for (const stream of [operator, late]) assert.equal(stream.messages.filter((m) => m.type === 'chosen').length, 1, 'once');
  const last = await enter('a');
  last.send({ type: 'ping', id: 'p' });
  await last.wait({ type: 'pong' });
  assert.ok(!last.messages.some((m) => m.type === 'choices'), 'they are gone');
  assert.ok(!elsewhere.messages.some((m) => ['choices', 'chosen', 'state'].includes(m.type)));
  operator.send(offer);
  operator.send({ type: 'choices', choices: [] });
  await late.wait({ type: 'choices', choices: [] });
  operator.send({ type: 'choose', choice: 0 });
  await operator.wait({ type: 'error', code: 'no-choices' });
  for (const stream of [operator, packed, late, last, elsewhere]) await stream.close();
});

test('a state sets its mood, is announced during speech, and works on a private stream', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 's', lang: 'it', text: 'Una frase che dura un poco, perché qualcosa accada intanto.' });
  await stream.wait({ type: 'word', id: 's' });
  stream.send({ type: 'state', state: 'thinking', mix: [{ name: 'joy', intensity: 1 }], ease: 0 });
  await stream.wait({ type: 'state', state: 'thinking' });
  await stream.wait({ type: 'end', id: 's', reason: 'done' });
  stream.send({ type: 'state', state: 'idle', mix: [{ name: 'joyy' }] });
  await stream.wait({ type: 'error', code: 'unknown-expression', field: 'mix.0.name' });
  assert.equal(stream.messages.filter((m) => m.type === 'state').length, 1, 'what is wrong is not told');
  await stream.close();
});

test('errors name their field, and change nothing', async () => {
  const stream = await enter('c');
  stream.send(offer);
  await stream.wait({ type: 'choices' });
  for (const [message, field] of [
    [{ ...offer, choices: Array(9).fill('x') }, 'choices'],
    [{ ...offer, choices: 'x' }, 'choices'],
    [{ ...offer, choices: ['a', ''] }, 'choices.1'],
    [{ ...offer, choices: ['a\u0000'] }, 'choices.0'],
    [{ ...offer, choices: ['x'.repeat(201)] }, 'choices.0'],
    [{ ...offer, id: 'x'.repeat(65) }, 'id'],
    [{ ...offer, question: 7 }, 'question'],
    [{ type: 'choose', choice: 1.5 }, 'choice'],
    [{ type: 'choose', choice: -1 }, 'choice'],
    [{ type: 'choose', choice: 0, id: ['q'] }, 'id'],
    [{ type: 'state', state: 'dreaming' }, 'state'],
    [{ type: 'state', state: 'idle', text: 'x'.repeat(1001) }, 'text'],
  ]) {
    const from = stream.messages.length;
    stream.send(message);
    await stream.wait({ type: 'error', code: 'bad-field', field }, { from });
  }
  stream.send({ type: 'choices' });
  await stream.wait({ type: 'error', code: 'missing-field', field: 'choices' });
  stream.send({ type: 'choose', id: 'q', choice: 1 });
  await stream.wait({ type: 'chosen', choice: 1, text: 'No' });
  await stream.close();
});

test('consent is requested by an operator, answered by listeners, and sent to late joiners', async () => {
  const claims = (rights, sub) => bearer(sign({ secret, claims: { sub, room: 'c', rights } }));
  const desk = await guarded.stream('', claims('listen speak', 'anna')), kiosk = await enter('c', { from: guarded, options: claims('listen', 'kitchen') });
  desk.send({ type: 'join', room: 'c', watch: true, as: 'somebody else' });
  await desk.wait({ type: 'joined' });
  for (const [from, message, expected] of [
    [kiosk, { consent: 'given' }, { code: 'no-choices' }],
    [kiosk, { consent: 'asked' }, { code: 'forbidden' }],
    [kiosk, { consent: 'none' }, { code: 'forbidden' }],
    [desk, { consent: 'given' }, { code: 'forbidden' }],
    [desk, { consent: 'perhaps' }, { code: 'bad-field', field: 'consent' }],
    [desk, {}, { code: 'missing-field', field: 'consent' }],
    [desk, { consent: 'asked', text: 7 }, { code: 'bad-field', field: 'text' }],
    [desk, { consent: 'asked', text: 'x'.repeat(1001) }, { code: 'bad-field', field: 'text' }],
  ]) {
    const since = from.messages.length;
    from.send({ type: 'consent', ...message });
    await from.wait({ type: 'error', ...expected }, { from: since });
  }
  desk.send({ type: 'consent', consent: 'asked', text: 'Per una tesi.' });
  await kiosk.wait({ type: 'consent', stream: 'c', consent: 'asked', text: 'Per una tesi.', by: 'anna' });
  kiosk.send({ type: 'consent', consent: 'given' });
  await desk.wait({ type: 'consent', consent: 'given', text: 'Per una tesi.', by: 'kitchen' });
  const since = desk.messages.length;
  desk.send({ type: 'consent', consent: 'asked', text: 'Per una tesi.' }); // as after a lost connection
  await desk.wait({ type: 'consent' }, { from: since });
  assert.equal(desk.messages.slice(since).find((m) => m.type === 'consent').consent, 'given');
  const late = await enter('c', { from: guarded, options: claims('listen', 'late') });
  await late.wait({ type: 'consent', consent: 'given', by: 'kitchen' });
  late.send({ type: 'consent', consent: 'declined' });
  await desk.wait({ type: 'consent', consent: 'declined', by: 'late' });
  desk.send({ type: 'consent', consent: 'asked', text: 'Per un’altra.' });
  await late.wait({ type: 'consent', consent: 'asked', text: 'Per un’altra.' });
  desk.send({ type: 'consent', consent: 'none' });
  await kiosk.wait({ type: 'consent', consent: 'none' });
  kiosk.send({ type: 'consent', consent: 'given' });
  const last = await enter('c', { from: guarded, options: claims('listen', 'last') });
  last.send({ type: 'ping', id: 'p' });
  await last.wait({ type: 'pong' });
  assert.ok(!last.messages.some((m) => m.type === 'consent'));
  for (const stream of [desk, kiosk, late, last]) await stream.close();
});

test('observers see other observers by name, but not listeners', async () => {
  const claims = (rights, sub) => bearer(sign({ secret, claims: { sub, room: 'n', rights } }));
  const listener = await enter('n', { from: guarded, options: claims('listen', 'kitchen') });
  const names = (stream, wanted, count = wanted.length) => stream.wait((m) => m.type === 'observers' && m.count === count && m.observers.map(({ name, speaks }) => `${name} ${speaks}`).join() === wanted.join(), { from: stream.seen ?? 0 });
  const watch = async (options, as) => {
    const stream = await guarded.stream('', options);
    stream.send({ type: 'join', room: 'n', watch: true, ...(as ? { as } : {}) });
    await stream.wait({ type: 'joined' });
    return stream;
  };
  const anna = await watch(claims('listen speak', 'anna'), 'bruno'), observer = await watch(claims('listen', 'prof'));
  for (const stream of [anna, observer]) await names(stream, ['anna true', 'prof false']);
  await observer.close();
  anna.seen = anna.messages.length - 1;
  await names(anna, ['anna true']);
  anna.send({ type: 'join', room: 'n' }); // to listen
  anna.send({ type: 'ping', id: 'p' });
  await anna.wait({ type: 'pong' });
  assert.ok(!listener.messages.some((m) => m.type === 'observers'));
  const sit = async (i) => {
    const stream = await daemon.stream();
    stream.send({ type: 'join', room: 'o', watch: true, as: `tavolo ${i}` });
    await stream.wait({ type: 'joined' });
    return stream;
  };
  const first = await sit(0); // the earliest are listed
  const rest = await Promise.all(Array.from({ length: 39 }, (_, i) => sit(i + 1)));
  const { observers } = await first.wait({ type: 'observers', count: 40 });
  assert.equal(observers.length, 32);
  for (const as of ['x'.repeat(65), 7, 'a\u0000b']) {
    const since = first.messages.length;
    first.send({ type: 'join', room: 'o', watch: true, as });
    await first.wait({ type: 'error', code: 'bad-field', field: 'as' }, { from: since });
  }
  first.send({ type: 'join', room: 'o', watch: true, as: 'Zoë' });
  await rest[0].wait((m) => m.type === 'observers' && m.observers.some(({ name }) => name === 'Zoë'));
  for (const stream of [listener, anna, first, ...rest]) await stream.close();
});

test('announces a mood with its author in its room, also to late joiners; not on a private stream', async () => {
  const desk = await daemon.stream(), listener = await enter('m');
  desk.send({ type: 'express', mix: [{ name: 'joy' }] });
  desk.send({ type: 'join', room: 'm', watch: true, as: 'Anna' });
  desk.send({ type: 'express', mix: [{ name: 'joy', intensity: 0.5 }, { name: 'hope' }] });
  const mix = [{ name: 'joy', intensity: 0.5 }, { name: 'hope', intensity: 1 }];
  await listener.wait({ type: 'expressed', stream: 'm', mix, by: 'Anna' });
  const late = await enter('m');
  await late.wait({ type: 'expressed', mix, by: 'Anna' });
  assert.equal((await post('/v1/rooms/m/commands', JSON.stringify({ type: 'state', state: 'thinking', mix: [{ name: 'hope', intensity: 0.25 }] }))).status, 202);
  await late.wait({ type: 'expressed', mix: [{ name: 'hope', intensity: 0.25 }] });
  desk.send({ type: 'express', mix: [{ name: 'joyy' }] });
  await desk.wait({ type: 'error', field: 'mix.0.name' });
  desk.send({ type: 'express', mix: [] });
  await listener.wait({ type: 'expressed', mix: [] });
  assert.equal(listener.messages.filter((m) => m.type === 'expressed').length, 3);
  const last = await enter('m');
  last.send({ type: 'ping', id: 'p' });
  await last.wait({ type: 'pong' });
  assert.ok(!last.messages.some((m) => m.type === 'expressed'), 'she is neutral');
  for (const stream of [desk, listener, late, last]) await stream.close();
});

test('works over HTTP and the text protocol', async () => {
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?room=d`, ['faccia.text.v1']), lines = [];
  socket.on('message', (line) => lines.push(String(line)));
  const line = (pattern) => eventually(() => lines.some((each) => pattern.test(each)), String(pattern));
  await line(/^joined d/);
  const answer = await post('/v1/rooms/d/commands', JSON.stringify(offer));
  assert.equal(answer.status, 202);
  assert.deepEqual(await answer.json(), { type: 'accepted', room: 'd', listeners: 1 });
  await line(/^choices q Ha fame\?/);
  assert.equal((await post('/v1/rooms/d/commands', '{"type":"state","state":"muted"}')).status, 202);
  await line(/^state muted/);
  for (const [address, body, status, code] of [
    ['/v1/rooms/nobody/commands', JSON.stringify(offer), 404, 'unknown-room'],
    ['/v1/rooms/d/commands', '{"type":"choices"}', 400, 'missing-field'],
    ['/v1/rooms/d/commands', '', 400, 'bad-json'],
    ['/v1/rooms/d/commands', '[1]', 400, 'bad-message'],
    ['/v1/choices?room=d', JSON.stringify(offer), 404, 'not-found'],
    ['/v1/rooms/d/commands', '{"type":"state","state":', 400, 'bad-json'],
    ['/v1/rooms/d/commands', `{"type":"state","state":"idle","text":"${'x'.repeat(300000)}"}`, 413, 'message-too-long'],
  ]) {
    const refused = await post(address, body);
    assert.deepEqual([refused.status, (await refused.json()).code], [status, code], `${address} ${body.slice(0, 20)}`);
  }
  socket.close();
});

test('listeners may choose; speakers may offer', async () => {
  const right = (rights, sub) => ({ from: guarded, options: bearer(sign({ secret, claims: { sub, room: 'e', rights } })) });
  const operator = await enter('e', right('listen speak', 'operator')), listener = await enter('e', right('listen', 'nonna'));
  listener.send(offer);
  await listener.wait({ type: 'error', code: 'forbidden' });
  listener.send({ type: 'state', state: 'muted' });
  await listener.wait({ type: 'error', code: 'forbidden' }, { from: listener.messages.length });
  assert.equal((await post('/v1/rooms/e/commands', '{"type":"state","state":"muted"}', guarded, right('listen', 'x').options)).status, 403);
  operator.send(offer);
  await listener.wait({ type: 'choices' });
  listener.send({ type: 'choose', choice: 0 });
  await operator.wait({ type: 'chosen', by: 'nonna', text: 'Sì' });
  for (const stream of [operator, listener]) await stream.close();
});

const points = { '8.3': [26.1, -62, 18], '8.4': [-26.3, -61.8, 18] };
/** Header of a PNG of that size, the only part that is examined. */
function headOfPng(width, height) {
  const bytes = Buffer.alloc(64);
  bytes.set([0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10, 0, 0, 0, 13, 0x49, 0x48, 0x44, 0x52]);
  bytes.writeUInt32BE(width, 16);
  bytes.writeUInt32BE(height, 20);
  bytes.set([8, 2], 24);
  return bytes.toString('base64');
}

function headOfJpeg(width, height) {
  const bytes = Buffer.alloc(64);
  bytes.set([0xff, 0xd8, 0xff, 0xe0, 0, 16, 0x4a, 0x46, 0x49, 0x46], 0);
  bytes.set([0xff, 0xc2, 0, 17, 8, height >> 8, height & 255, width >> 8, width & 255], 20);
  return bytes.toString('base64');
}

function headOfWebp(width, height) {
  const bytes = Buffer.alloc(64);
  bytes.write('RIFF', 0);
  bytes.write('WEBPVP8X', 8);
  bytes.writeUIntLE(width - 1, 24, 3);
  bytes.writeUIntLE(height - 1, 27, 3);
  return bytes.toString('base64');
}

const texture = { type: 'image/png', data: headOfPng(2048, 2048) };

test('sends feature points to everyone in the room, and to late joiners, until replaced', async () => {
  const operator = await enter('f'), elsewhere = await enter('g'), own = await daemon.stream();
  operator.send({ type: 'calibrate', featurePointsCoord: points, textureCoord: { '8.3': [0, 1] }, texture, more: 1 });
  const told = { type: 'calibrated', stream: 'f', featurePointsCoord: points, textureCoord: { '8.3': [0, 1] }, texture };
  const late = await enter('f');
  for (const stream of [operator, late]) {
    const { arrived, ...is } = await stream.wait({ type: 'calibrated' });
    assert.deepEqual(is, told);
  }
  const answer = await post('/v1/rooms/f/commands', JSON.stringify({ type: 'calibrate', featurePointsCoord: { 2.1: [0, -90, 70] } }));
  assert.deepEqual([answer.status, await answer.json()], [202, { type: 'accepted', room: 'f', listeners: 2 }]);
  await late.wait(({ type, featurePointsCoord }) => type === 'calibrated' && featurePointsCoord['2.1']);
  const later = await enter('f');
  assert.deepEqual((await later.wait({ type: 'calibrated' })).featurePointsCoord, { 2.1: [0, -90, 70] });
  later.send({ type: 'calibrate', reset: true });
  await operator.wait({ type: 'calibrated', reset: true, stream: 'f' });
  const last = await enter('f');
  own.send({ type: 'calibrate', featurePointsCoord: points });
  await own.wait({ type: 'calibrated', featurePointsCoord: points });
  for (const stream of [last, elsewhere]) {
    stream.send({ type: 'ping', id: 'p' });
    await stream.wait({ type: 'pong' });
    assert.ok(!stream.messages.some(({ type }) => type === 'calibrated'), 'its own points, and nothing of others');
  }
  for (const stream of [operator, elsewhere, own, late, later, last]) await stream.close();
});

test('reports invalid points with their field, and does not forward them', async () => {
  const stream = await enter('h');
  const good = { featurePointsCoord: points };
  const cases = [
    [{}, 'featurePointsCoord', 'missing-field'],
    [{ featurePointsCoord: {} }, 'featurePointsCoord'],
    [{ featurePointsCoord: [1] }, 'featurePointsCoord'],
    ...['1.1', '2.15', '12.1', '8', '8.', '8.03', '08.3', '8.3 ', '2.1x', '', '99999999999.1', 'x'.repeat(5000)].map((name) =>
      [{ featurePointsCoord: { ...points, [name]: [0, 0, 0] } }, `featurePointsCoord.${name.slice(0, 32)}`]),
    ...[[0, 0], [0, 0, 0, 0], [0, 0, 1001], [0, 0, '0'], [0, null, 0], '0 0 0', { x: 0 }].map((value) => [{ featurePointsCoord: { 8.3: value } }, 'featurePointsCoord.8.3']),
    [{ ...good, textureCoord: { 8.3: [0, 0] } }, 'texture', 'missing-field'],
    [{ ...good, textureCoord: { 8.3: [0, 1.1] }, texture }, 'textureCoord.8.3'],
    [{ ...good, textureCoord: { 8.33: [0, 1] }, texture }, 'textureCoord.8.33'],
    [{ ...good, textureCoord: 7, texture }, 'textureCoord'],
    [{ ...good, texture: 'x' }, 'texture'],
    [{ ...good, texture: { ...texture, type: 'image/svg+xml' } }, 'texture.type'],
    ...['', 'abc', 'a===', '=abc', 'ab!d', 'AAAA'.repeat(50000), 7, 'iVBORw0KGgo=', headOfPng(16000, 16000), headOfPng(8193, 1), headOfPng(0, 5), headOfPng(0xffffffff, 0xffffffff), headOfJpeg(64, 64), headOfWebp(64, 64)].map((data) => [{ ...good, texture: { ...texture, data } }, 'texture.data']),
    [{ ...good, texture: { type: 'image/jpeg', data: headOfJpeg(65535, 65535) } }, 'texture.data'],
    [{ ...good, texture: { type: 'image/webp', data: headOfWebp(16383, 16383) } }, 'texture.data'],
    [{ reset: 'yes' }, 'reset'],
  ];
  for (const [message, field, code = 'bad-field'] of cases) {
    const from = stream.messages.length;
    stream.send({ type: 'calibrate', ...message });
    await stream.wait({ type: 'error', code, field }, { from });
  }
  const refused = await post('/v1/rooms/h/commands', JSON.stringify({ type: 'calibrate', featurePointsCoord: { 8.4: [1] } }));
  assert.deepEqual([refused.status, (await refused.json()).field], [400, 'featurePointsCoord.8.4']);
  assert.ok(!stream.messages.some(({ type }) => type === 'calibrated'));
  for (const [type, data] of [['image/jpeg', headOfJpeg(2048, 2048)], ['image/webp', headOfWebp(2048, 2048)]]) {
    const from = stream.messages.length;
    stream.send({ type: 'calibrate', ...good, texture: { type, data } });
    assert.equal((await stream.wait({ type: 'calibrated' }, { from })).texture.data, data);
  }
  await stream.close();
});

test('refuses most of a flood of calibrations without sending them on, and accepts a later one', async () => {
  const sender = await enter('flood'), listener = await enter('flood');
  for (let i = 0; i < 500; i++) sender.send({ type: 'calibrate', featurePointsCoord: points });
  sender.send({ type: 'ping', id: 'all' });
  await sender.wait({ type: 'pong', id: 'all' });
  const refused = sender.messages.filter(({ type, code }) => type === 'error' && code === 'too-many-requests').length;
  listener.send({ type: 'ping', id: 'told' });
  await listener.wait({ type: 'pong', id: 'told' });
  const told = listener.messages.filter(({ type }) => type === 'calibrated').length;
  assert.equal(refused + told, 500, 'each is told or refused');
  assert.ok(told >= 12 && told < 250, `${told} of 500 were handed on`);
  const late = { 2.1: [0, -91, 70] };
  for (let taken = false; !taken; ) {
    const answer = await post('/v1/rooms/flood/commands', JSON.stringify({ type: 'calibrate', featurePointsCoord: late }));
    assert.ok([202, 429].includes(answer.status), `${answer.status}`);
    taken = answer.status === 202;
    if (!taken) await new Promise((resolve) => setTimeout(resolve, 100));
  }
  await listener.wait(({ type, featurePointsCoord }) => type === 'calibrated' && featurePointsCoord['2.1']);
  for (const stream of [sender, listener]) await stream.close();
});

test('limits the rate of room commands; a flood delays no one else', async () => {
  const sender = await enter('told'), other = await enter('told'), watcher = await daemon.stream('?audio=none&fap=none');
  watcher.send({ type: 'join', room: 'told', watch: true, as: 'watcher' });
  await watcher.wait({ type: 'joined' });
  const floods = {
    stated: [{ type: 'state', state: 'thinking' }, 'state'],
    expressed: [{ type: 'express', mix: [{ name: 'joy', intensity: 0.5 }] }, 'expressed'],
    asked: [{ type: 'choices', choices: ['a', 'b'] }, 'choices'],
    rejoined: [{ type: 'join', room: 'told', watch: true, as: 'x' }, 'observers'],
  };
  for (const [name, [message, type]] of Object.entries(floods)) {
    const from = sender.messages.length, before = watcher.messages.length;
    for (let i = 0; i < 3000; i++) sender.send(message);
    sender.send({ type: 'ping', id: name });
    await sender.wait({ type: 'pong', id: name });
    const refused = sender.messages.slice(from).filter(({ code }) => code === 'too-many-requests').length;
    assert.ok(refused > 0, `${name}: all 3000 were taken`);
    other.send({ type: 'state', state: 'listening', text: name });
    await watcher.wait({ type: 'state', text: name });
    const told = watcher.messages.slice(before).filter((each) => each.type === type).length;
    assert.ok(told >= 400 && told <= 3001 - refused, `${name}: ${told} of 3000 reached the others, ${refused} were refused`);
    await new Promise((resolve) => setTimeout(resolve, 3500)); // until the rate limit has recovered
  }
  for (const stream of [sender, other, watcher]) await stream.close();
});

test('listeners cannot change the face of others', async () => {
  const right = (rights) => ({ from: guarded, options: bearer(sign({ secret, claims: { sub: 'x', room: 'i', rights } })) });
  const listener = await enter('i', right('listen'));
  listener.send({ type: 'calibrate', featurePointsCoord: points });
  await listener.wait({ type: 'error', code: 'forbidden' });
  assert.equal((await post('/v1/rooms/i/commands', JSON.stringify({ type: 'calibrate', featurePointsCoord: points }), guarded, right('listen').options)).status, 403);
  assert.equal((await post('/v1/rooms/i/commands', JSON.stringify({ type: 'calibrate', featurePointsCoord: points }), guarded, right('speak').options)).status, 202);
  await listener.wait({ type: 'calibrated' });
  await listener.close();
});
