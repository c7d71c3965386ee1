// SPDX-License-Identifier: GPL-3.0-or-later
// RFC 6455 in detail, with a client that sends any frame: the checks of Autobahn that need no echo.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';
import { badTexts, frames } from '../../lib/malformed.mjs';
import { ask, closeFrame, frame, handshake, RawSocket } from '../../lib/raw.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const [MORE, TEXT, BINARY, CLOSE, PING, PONG] = [0, 1, 2, 8, 9, 10];
const open = (fields, path) => RawSocket.open(daemon.port, fields, path);
const ping = (id, size = 0) => JSON.stringify({ type: 'ping', id, x: 'y'.repeat(size) });

/** Sends frames. Returns how the connection is closed. */
async function closedBy(...frames) {
  const socket = await open();
  await socket.message({ type: 'hello' });
  socket.write(Buffer.concat(frames));
  return socket.goodbye();
}

test('accepts messages of all lengths, in every form of the length', async () => {
  const socket = await open();
  const empty = ping('').length;
  for (const size of [empty, 125, 126, 127, 128, 65535, 65536, 200000]) {
    socket.write(frame(TEXT, ping('', size - empty)));
    await socket.message({ type: 'pong' });
  }
  for (const size of [0, 1, 125, 126, 65535, 65536]) {
    socket.write(frame(BINARY, Buffer.alloc(size, 0xff)));
    await socket.message({ type: 'error', code: 'binary-message' });
  }
  socket.write(frame(TEXT, ''));
  await socket.message({ type: 'error', code: 'empty-text' });
  await socket.close();
});

test('the answer arrives with the frame, byte for byte', async () => {
  const socket = await open();
  for (const byte of frame(TEXT, ping('slow'))) {
    socket.write(Buffer.from([byte]));
    await new Promise((resolve) => setImmediate(resolve));
  }
  await socket.message({ type: 'pong', id: 'slow' });
  socket.write(Buffer.concat([frame(TEXT, ping('a')), frame(PING, 'x'), frame(TEXT, ping('b')).subarray(0, 9)]));
  await socket.message({ type: 'pong', id: 'a' });
  assert.equal(String((await socket.next(PONG)).payload), 'x');
  socket.write(frame(TEXT, ping('b')).subarray(9));
  await socket.message({ type: 'pong', id: 'b' });
  await socket.close();
});

for (const [name, [bytes, reason]] of Object.entries(frames))
  test(`${name}: closes with 1002`, async () => assert.deepEqual(await closedBy(bytes), { code: 1002, reason }));

test('joins fragmented messages with control frames between them', async () => {
  const socket = await open();
  const text = ping('pieces');
  socket.write(Buffer.concat([
    frame(TEXT, text.slice(0, 5), { fin: false }), frame(PING, 'one'),
    frame(MORE, '', { fin: false }), frame(PONG, 'nobody asked'),
    frame(MORE, text.slice(5, 9), { fin: false }), frame(PING, 'two'), frame(MORE, text.slice(9)),
  ]));
  const heard = [];
  while (heard.length < 3) {
    const got = await socket.frame();
    if (got.opcode === PONG || JSON.parse(got.payload).type === 'pong') heard.push(got.opcode === PONG ? String(got.payload) : JSON.parse(got.payload).id);
  }
  assert.deepEqual(heard, ['one', 'two', 'pieces']);
  // one frame per byte
  socket.write(Buffer.concat([...ping('bytes')].map((c, i, all) => frame(i ? MORE : TEXT, c, { fin: i === all.length - 1 }))));
  await socket.message({ type: 'pong', id: 'bytes' });
  socket.write(Buffer.concat([frame(TEXT, '', { fin: false }), frame(MORE, '', { fin: false }), frame(MORE, '')]));
  await socket.message({ type: 'error', code: 'empty-text' });
  await socket.close();
});

test('pings: returns any payload; ignores unsolicited pongs', async () => {
  const socket = await open();
  for (const payload of ['', 'hello', Buffer.from([0, 255, 254, 253]), Buffer.alloc(125, 0xfe)]) {
    socket.write(frame(PING, payload));
    assert.deepEqual((await socket.next(PONG)).payload, Buffer.from(payload));
  }
  socket.write(Buffer.concat([frame(PONG, ''), frame(PONG, 'x'), frame(PING, 'y')]));
  assert.equal(String((await socket.next(PONG)).payload), 'y');
  await socket.close();
});

test('thousands of pings whose answers are not read cost no memory; the last one is answered', async () => {
  const socket = await open();
  await socket.message({ type: 'hello' });
  const kilobytes = () => Number(fs.readFileSync(`/proc/${daemon.process.pid}/statm`, 'utf8').split(' ')[1]) * 4;
  const before = kilobytes();
  socket.socket.pause();
  const many = Buffer.concat(Array.from({ length: 5000 }, () => frame(PING, 'z'.repeat(125))));
  for (let i = 0; i < 60; i++) socket.write(many); // 40 MB
  socket.write(frame(PING, 'the last'));
  const other = await open();
  other.write(frame(TEXT, ping('meanwhile')));
  await other.message({ type: 'pong', id: 'meanwhile' });
  await other.close();
  assert.ok(kilobytes() - before < 25000, `${kilobytes() - before} kB more`);
  socket.socket.resume();
  for (let got; String(got?.payload) !== 'the last'; ) assert.ok((got = await socket.next(PONG)));
  await socket.close();
});

const utf8 = (text) => Buffer.from(text, 'hex');
for (const text of badTexts)
  test(`UTF-8 ${text}: closes with 1007`, async () => {
    assert.equal((await closedBy(frame(TEXT, utf8(text)))).code, 1007);
    const bytes = utf8(text);
    assert.equal((await closedBy(...[...bytes].map((byte, i) => frame(i ? MORE : TEXT, Buffer.from([byte]), { fin: i === bytes.length - 1 })))).code, 1007);
  });

test('reports UTF-8 that cannot become valid at once, with its position', async () => {
  const socket = await open();
  socket.write(Buffer.concat([frame(TEXT, 'né ', { fin: false }), frame(MORE, utf8('f490'), { fin: false })])); // without a final frame
  const { byte } = await socket.message({ type: 'error', code: 'bad-utf8' });
  assert.equal(byte, 4);
  assert.equal((await socket.goodbye()).code, 1007);
  // within a frame that is incomplete
  const second = await open();
  second.write(frame(TEXT, 'a'.repeat(1000)).subarray(0, 500));
  second.write(Buffer.alloc(8, 0xff));
  assert.equal((await second.goodbye()).code, 1007);
  // a character truncated by the end of the message
  assert.equal((await closedBy(frame(TEXT, utf8('cebae1bd')))).code, 1007);
});

test('accepts valid UTF-8 cut anywhere', async () => {
  const socket = await open();
  const bytes = Buffer.from('{"type":"ping","id":"κόσμε \u{10ffff}\u{1d11e}\ufffd\ue000\ud7ff\u07ff"}');
  for (let i = 1; i < bytes.length; i++) {
    socket.write(Buffer.concat([frame(TEXT, bytes.subarray(0, i), { fin: false }), frame(MORE, bytes.subarray(i))]));
    await socket.message({ type: 'pong' });
  }
  await socket.close();
});

for (const code of [1000, 1001, 1002, 1003, 1007, 1008, 1009, 1010, 1011, 1012, 1013, 1014, 3000, 3999, 4000, 4999])
  test(`answers close ${code} with the same code`, async () => assert.equal((await closedBy(closeFrame(code, 'tschüß'))).code, code));
for (const code of [0, 1, 999, 1004, 1005, 1006, 1015, 1016, 1100, 2000, 2999, 5000, 65535])
  test(`answers the invalid close ${code} with 1002`, async () => assert.deepEqual(await closedBy(closeFrame(code)), { code: 1002, reason: 'bad-close' }));

test('closing: empty, one byte, long and broken reasons, and data afterwards', async () => {
  assert.deepEqual(await closedBy(closeFrame()), { code: undefined, reason: '' });
  assert.deepEqual(await closedBy(frame(CLOSE, 'x')), { code: 1002, reason: 'bad-close' });
  assert.equal((await closedBy(closeFrame(1000, 'r'.repeat(123)))).code, 1000);
  assert.equal((await closedBy(frame(CLOSE, Buffer.from([3, 232, 0xce, 0xba, 0xed, 0xa0, 0x80])))).code, 1007);
  assert.equal((await closedBy(closeFrame(1000), frame(PING, 'late'), frame(TEXT, '{broken'), closeFrame(1001))).code, 1000);
  const socket = await open();
  await socket.message({ type: 'hello' });
  socket.write(Buffer.concat([closeFrame(1000), frame(PING, 'late'), frame(TEXT, ping('late'))]));
  assert.equal((await socket.frame()).opcode, CLOSE);
  assert.equal(await socket.frame(), false, 'nothing after it');
});

test('reports a message that is too long, and disconnects on one that is far too long', async () => {
  const socket = await open();
  socket.write(frame(TEXT, 'a'.repeat(300000)));
  await socket.message({ type: 'error', code: 'message-too-long' });
  socket.write(Buffer.concat(Array.from({ length: 30 }, (_, i) => frame(i ? MORE : TEXT, 'a'.repeat(10000), { fin: i === 29 }))));
  await socket.message({ type: 'error', code: 'message-too-long' });
  socket.write(frame(TEXT, ping('still here')));
  await socket.message({ type: 'pong', id: 'still here' });
  socket.write(frame(TEXT, 'a', { length: 16 * 262144 + 1, form: 8 }));
  await socket.message({ type: 'error', code: 'message-too-long' });
  assert.deepEqual(await socket.goodbye(), { code: 1009, reason: 'message-too-long' });
});

test('performs the handshake', async () => {
  const socket = await open({ 'Sec-WebSocket-Extensions': 'permessage-deflate; client_max_window_bits' });
  assert.match(socket.accepted, /^HTTP\/1\.1 101 /);
  assert.match(socket.accepted, /sec-websocket-accept: s3pPLMBiTxaQ9kYGzzhZRbK\+xOo=/i);
  assert.doesNotMatch(socket.accepted, /extensions|protocol:/i);
  await socket.message({ type: 'hello' });
  await socket.close();
  const chosen = await open({ 'Sec-WebSocket-Protocol': 'something, faccia.text.v1' });
  assert.match(chosen.accepted, /sec-websocket-protocol: faccia\.text\.v1/i);
  assert.match(String((await chosen.frame()).payload), /^hello /);
  await chosen.close();
  const odd = await open({ Connection: 'keep-alive, UPGRADE', Upgrade: 'h2c, WebSocket' });
  assert.match(odd.accepted, /^HTTP\/1\.1 101 /);
  await odd.close();
});

const handshakes = [
  ['version 12', { 'Sec-WebSocket-Version': '12' }, 426, 'upgrade-required'],
  ['no version', { 'Sec-WebSocket-Version': null }, 426, 'upgrade-required'],
  ['no key', { 'Sec-WebSocket-Key': null }, 400, 'bad-handshake'],
  ['a short key', { 'Sec-WebSocket-Key': 'c2hvcnQ=' }, 400, 'bad-handshake'],
  ['a key that is not base64', { 'Sec-WebSocket-Key': '!!!!!!!!!!!!!!!!!!!!!!==' }, 400, 'bad-handshake'],
  ['an unknown sub-protocol', { 'Sec-WebSocket-Protocol': 'chat' }, 400, 'unknown-protocol'],
  ['a foreign page', { Origin: 'https://evil.example' }, 403, 'forbidden-origin'],
];
for (const [name, fields, status, code] of handshakes)
  test(`handshake with ${name}: answers ${status} ${code}`, async () => {
    const answer = await ask(daemon.port, handshake(fields));
    assert.equal(answer.version, 'HTTP/1.1');
    assert.equal(answer.status, status);
    assert.equal(JSON.parse(answer.body).code, code);
    if (status === 426) assert.equal(answer.headers['sec-websocket-version'], '13');
  });

test('rejects a handshake at another address, by POST, and over HTTP/1.0', async () => {
  const elsewhere = await ask(daemon.port, handshake({}, '/elsewhere'));
  assert.deepEqual([elsewhere.status, JSON.parse(elsewhere.body).code], [404, 'not-found']);
  assert.equal((await ask(daemon.port, handshake({ 'Content-Length': 0 }, '/v1/stream', 'POST'))).status, 400);
  assert.equal((await ask(daemon.port, handshake().replace('HTTP/1.1', 'HTTP/1.0'))).status, 400);
});

test('answers 503 without a free connection', async () => {
  const small = await Daemon.start(['--max-connections', '2']);
  const sockets = [await RawSocket.open(small.port), await RawSocket.open(small.port)];
  const answer = await ask(small.port, handshake());
  assert.deepEqual([answer.status, JSON.parse(answer.body).code], [503, 'too-many-connections']);
  assert.ok(Number(answer.headers['retry-after']) > 0);
  await Promise.all(sockets.map((socket) => socket.close()));
  assert.equal((await small.stop()).code, 0);
});

test('a client that vanishes inside a frame affects no one', async () => {
  const other = await open();
  for (let i = 0; i < 30; i++) {
    const socket = await open();
    socket.write(frame(TEXT, 'a'.repeat(70000)).subarray(0, 1 + i * 300));
    if (i % 2) socket.socket.resetAndDestroy();
    else socket.socket.end();
  }
  other.write(frame(TEXT, ping('here')));
  await other.message({ type: 'pong', id: 'here' });
  await other.close();
});
