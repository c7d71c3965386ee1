// SPDX-License-Identifier: GPL-3.0-or-later
// Bad input gets an error with its place; the connection and all others stay usable.
import assert from 'node:assert/strict';
import net from 'node:net';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

/** Sends the message, expects the error, then speaks on the same connection. */
async function refuses(message, expected) {
  const stream = await daemon.stream();
  stream.socket.send(message);
  const error = await stream.wait({ type: 'error', ...expected });
  assert.ok(error.message.length > 5, error.message);
  const from = stream.messages.length;
  stream.send({ type: 'ping', id: 'still here' });
  await stream.wait({ type: 'pong', id: 'still here' }, { from });
  await stream.close();
  return error;
}

const speak = (members) => JSON.stringify({ type: 'speak', lang: 'it', ...members });

const cases = [
  ['malformed JSON', '{"type":"speak",,}', { code: 'bad-json', byte: 16 }],
  ['JSON without a type', '{"text":"ciao"}', { code: 'bad-message', field: 'type' }],
  ['a type that is no string', '{"type":5}', { code: 'bad-message', field: 'type' }],
  ['an unknown type', '{"type":"sing"}', { code: 'unknown-type', field: 'type' }],
  ['no text', speak({}), { code: 'missing-field', field: 'text', utterance: 1 }],
  ['a text that is no string', speak({ text: 5 }), { code: 'bad-field', field: 'text' }],
  ['an empty text', speak({ text: ' \n' }), { code: 'empty-text' }],
  ['a text over the limit', speak({ text: 'a'.repeat(100001) }), { code: 'text-too-long' }],
  ['a NUL', speak({ text: 'ab\0c' }), { code: 'nul', byte: 2 }],
  ['an unknown language', speak({ text: 'a', lang: 'xx' }), { code: 'unknown-language', field: 'lang' }],
  ['an unknown voice', speak({ text: 'a', voice: 'nobody' }), { code: 'unknown-voice', field: 'voice' }],
  ['an unknown engine', speak({ text: 'a', engine: 'steam' }), { code: 'unknown-engine', field: 'engine' }],
  ['an engine without a table for the language', speak({ text: 'a', lang: 'it', engine: 'context' }), { code: 'unknown-engine', field: 'engine' }],
  ['an unknown markup', speak({ text: 'a', markup: 'rtf' }), { code: 'unknown-markup', field: 'markup' }],
  ['a rate out of range', speak({ text: 'a', rate: 5000 }), { code: 'bad-field', field: 'rate' }],
  ['a rate that is a string', speak({ text: 'a', rate: 'fast' }), { code: 'bad-field', field: 'rate' }],
  ['a frame rate of nothing', speak({ text: 'a', fps: 0 }), { code: 'bad-field', field: 'fps' }],
  ['an array for a scalar', speak({ text: 'a', rate: [1] }), { code: 'bad-field', field: 'rate' }],
  ['a long id', speak({ text: 'a', id: 'i'.repeat(65) }), { code: 'bad-field', field: 'id' }],
  ['a flag that is no flag', speak({ text: 'a', still: 'perhaps' }), { code: 'bad-field', field: 'still' }],
  ['an unknown model', '{"type":"model","name":"nobody"}', { code: 'unknown-model', field: 'name' }],
  ['a binary message', Buffer.from([1, 2, 3]), { code: 'binary-message' }],
  ['a message over the limit', 'a'.repeat(300000), { code: 'message-too-long' }],
  ['a plain text that is empty', '   ', { code: 'empty-text' }],
];
for (const [name, message, expected] of cases) test(name, () => refuses(message, expected));

test('reports invalid UTF-8 in a text frame and closes the connection (RFC 6455, 8.1)', async () => {
  for (const [bytes, byte] of [[[0x63, 0x69, 0xc3, 0x28], 2], [Buffer.from('{"type":"speak","text":"\xff"}', 'latin1'), 24]]) {
    const stream = await daemon.stream();
    stream.socket.send(Buffer.from(bytes), { binary: false });
    await stream.wait({ type: 'error', code: 'bad-utf8', byte });
    assert.deepEqual(await stream.closed, { code: 1007, reason: 'bad-utf8' });
  }
});

test('every refused speak has exactly one end', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'x', text: 'a', lang: 'xx' });
  const end = await stream.wait({ type: 'end', id: 'x' });
  assert.equal(end.reason, 'failed');
  assert.equal(end.utterance, 1);
  await stream.close();
});

test('reports a full queue', async () => {
  const stream = await daemon.stream();
  for (let i = 0; i < 34; i++) stream.send({ type: 'speak', lang: 'it', text: 'Una frase che dura un poco.' });
  const error = await stream.wait({ type: 'error', code: 'queue-full' });
  assert.equal(error.utterance, 34);
  stream.send({ type: 'stop' });
  await stream.until(() => stream.messages.filter((m) => m.type === 'end').length === 34);
  await stream.close();
});

test('reports an invalid default in the address', async () => {
  const stream = await daemon.stream('?rate=fast');
  await stream.wait({ type: 'error', code: 'bad-field', field: 'rate' });
  await stream.close();
});

test('HTTP: reports unknown addresses, methods, types and formats', async () => {
  const check = async (address, options, status, code) => {
    const response = await daemon.get(address, options);
    assert.equal(response.status, status, address);
    assert.equal((await response.json()).code, code);
  };
  await check('/v1/nothing', {}, 404, 'not-found');
  await check('/../../etc/passwd', {}, 404, 'not-found');
  await check('/%2e%2e/%2e%2e/etc/passwd', {}, 404, 'not-found');
  await check('/v1/voices', { method: 'POST', body: 'x' }, 405, 'method-not-allowed');
  await check('/v1/say', {}, 405, 'method-not-allowed');
  await check('/v1/speech', {}, 400, 'missing-field');
  await check('/', { method: 'POST', body: 'x' }, 405, 'method-not-allowed');
  await check('/v1/voices', { method: 'DELETE' }, 405, 'method-not-allowed');
  await check('/v1/stream', {}, 426, 'upgrade-required');
  const post = (body, type = 'text/plain') => ({ method: 'POST', body, headers: { 'content-type': type } });
  await check('/v1/speech', post('ciao', 'image/png'), 415, 'unsupported-media-type');
  await check('/v1/speech?format=gif', post('ciao'), 400, 'unknown-format');
  await check('/v1/speech?rate=-1', post('ciao'), 400, 'bad-field');
  await check('/v1/speech', post(' '), 400, 'empty-text');
  await check('/v1/speech', post(''), 400, 'empty-text');
  await check('/v1/speech', post(Buffer.from([0x61, 0xff])), 400, 'bad-utf8');
  await check('/v1/speech', post('a'.repeat(100001)), 413, 'text-too-long');
});

test('OPTIONS lists the methods', async () => {
  const response = await daemon.get('/v1/speech', { method: 'OPTIONS' });
  assert.equal(response.status, 204);
  assert.equal(response.headers.get('allow'), 'GET, HEAD, POST, OPTIONS');
  assert.equal((await daemon.get('/v1/say', { method: 'OPTIONS' })).headers.get('allow'), 'POST, OPTIONS');
});

test('rejects a WebSocket at another address', async () => {
  await assert.rejects(daemon.stream('').then(() => import('ws')).then(({ default: WebSocket }) => new Promise((resolve, reject) => {
    new WebSocket(`ws://127.0.0.1:${daemon.port}/elsewhere`).on('open', resolve).on('error', reject);
  })));
});

/** Sends raw bytes. Resolves when the daemon closes the connection. */
function raw(bytes) {
  return new Promise((resolve) => {
    const socket = net.connect(daemon.port, '127.0.0.1');
    let heard = '';
    socket.on('data', (data) => (heard += data.toString('latin1')));
    socket.on('close', () => resolve(heard)).on('error', () => resolve(heard));
    socket.write(bytes);
  });
}

test('survives garbage on the port', async () => {
  const other = await daemon.stream();
  const upgrade = 'GET /v1/stream HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n';
  const hostile = [
    Buffer.alloc(5000, 0xff),
    Buffer.from('GET / HTTP/9.9\r\n\r\n'),
    Buffer.from('GET /' + 'a'.repeat(20000) + ' HTTP/1.1\r\n\r\n'),
    Buffer.from('POST /v1/speech HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n\r\nabc'),
    Buffer.from('POST /v1/speech HTTP/1.1\r\nHost: localhost\r\nContent-Length: -5\r\n\r\nabc'),
    Buffer.concat([Buffer.from(upgrade), Buffer.from([0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff])]), // reserved bits
    Buffer.concat([Buffer.from(upgrade), Buffer.from([0x81, 0x05, 0x41, 0x41, 0x41, 0x41, 0x41])]), // not masked
    Buffer.concat([Buffer.from(upgrade), Buffer.from([0x80, 0x85, 1, 2, 3, 4, 5, 5, 5, 5, 5])]), // continues nothing
    Buffer.concat([Buffer.from(upgrade), Buffer.from([0x81, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1, 2, 3, 4])]), // 2^64
    Buffer.concat([Buffer.from(upgrade), Buffer.from([0x89, 0xfe, 0x01, 0x00, 1, 2, 3, 4])]), // a ping too long
  ];
  await Promise.all(hostile.map(raw));
  other.send({ type: 'speak', lang: 'it', text: 'Ci sono.' });
  assert.equal((await other.wait({ type: 'end' })).reason, 'done');
  await other.close();
});

test('a client that vanishes while it is spoken to leaks nothing', async () => {
  for (let i = 0; i < 30; i++) {
    const stream = await daemon.stream();
    stream.send({ type: 'speak', lang: 'it', text: 'Una frase dopo l’altra. '.repeat(20) });
    if (i % 3) await stream.until(() => stream.chunks.length > 0);
    stream.socket.terminate();
  }
  await daemon.left(2);
  assert.equal((await (await daemon.get('/healthz')).json()).status, 'ok');
});
