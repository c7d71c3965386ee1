// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP requests that RFC 9110 and 9112 allow and forbid; pipelining; persistent connections.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';
import { get, heads } from '../../lib/malformed.mjs';
import { ask, handshake, Raw, RawSocket } from '../../lib/raw.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-strict-'));
let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const post = (body, fields = '', target = '/v1/speech?lang=it&format=json') =>
  `POST ${target} HTTP/1.1\r\nHost: localhost\r\nContent-Type: text/plain\r\nContent-Length: ${Buffer.byteLength(body)}\r\n${fields}\r\n${body}`;

test('answers requests in one segment in order', async () => {
  const raw = await Raw.open(daemon.port);
  raw.write(get('/v1/voices') + post('Uno.') + get('/v1/models') + get('/nowhere') + post('Due.') + get('/healthz'));
  const kinds = [];
  for (let i = 0; i < 6; i++) {
    const { status, body } = await raw.answer();
    kinds.push(`${status} ${Object.keys(JSON.parse(body))[0]}`);
  }
  assert.deepEqual(kinds, ['200 voices', '200 lang', '200 models', '404 type', '200 lang', '200 status'].map((kind, i) => (i === 1 || i === 4 ? kinds[i] : kind)));
  assert.match(kinds[1], /^200 (?!type)/);
  // regression: POST before GET in one segment made the loop hang
  raw.write(post('Tre.') + get());
  assert.equal((await raw.answer()).status, 200);
  assert.equal(JSON.parse((await raw.answer()).body).status, 'ok');
  await raw.close();
  assert.equal((await daemon.get('/healthz')).status, 200);
});

test('SIGTERM ends a daemon in the middle of such requests', async () => {
  const other = await Daemon.start();
  const raw = await Raw.open(other.port);
  raw.write((post('Una frase.') + get()).repeat(20));
  await raw.answer();
  assert.deepEqual(await other.stop(), { code: 0, signal: null });
  await raw.close();
});

test('answers a client that has closed its sending side', async () => {
  const raw = await Raw.open(daemon.port);
  raw.socket.end(post('Sì.') + get());
  assert.equal((await raw.answer()).status, 200);
  assert.equal((await raw.answer()).status, 200);
  await raw.end();
});

test('HTTP/2: ignores an upgrade offer and refuses prior knowledge', async () => {
  const curl = (...options) => spawnSync('curl', ['-s', '-o', '/dev/null', '-w', '%{http_code} %{http_version}', ...options, `${daemon.url}/healthz`], { encoding: 'utf8' });
  assert.equal(curl('--http2').stdout, '200 1.1');
  assert.notEqual(curl('--http2-prior-knowledge', '-m', '5').status, 28, 'no time-out');
  const preface = await ask(daemon.port, 'PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n');
  assert.deepEqual([preface.status, JSON.parse(preface.body).code, preface.headers.connection], [505, 'unknown-version', 'close']);
});

test('keeps serving and counting correctly after 2000 offers of HTTP/2', async () => {
  const offer = get('/healthz', 'Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABkAAQAAP__\r\n');
  for (let round = 0; round < 20; round++) {
    const answers = await Promise.all(Array.from({ length: 100 }, () => ask(daemon.port, offer)));
    assert.ok(answers.every(({ status, version }) => status === 200 && version === 'HTTP/1.1'));
  }
  let connections = 99;
  for (let i = 0; i < 200 && connections > 5; i++) ({ connections } = await (await daemon.get('/healthz')).json());
  assert.ok(connections >= 1 && connections <= 5, `${connections} connections`);
  const stream = await daemon.stream();
  await stream.wait({ type: 'hello' });
  await stream.close();
});

test('answers 400 to TLS and to anything else that is not HTTP', async () => {
  const hello = Buffer.from('16030100c8010000c40303', 'hex');
  for (const bytes of [Buffer.concat([hello, Buffer.alloc(200, 7)]), Buffer.alloc(5000, 0xff), Buffer.from('\0'), Buffer.from('SSH-2.0-x\r\n\r\n'), Buffer.from('get / http/1.1\r\n\r\n')]) {
    const answer = await ask(daemon.port, bytes);
    assert.deepEqual([answer.status, JSON.parse(answer.body).code, answer.headers.connection], [400, 'bad-request', 'close']);
  }
});

for (const [name, bytes, status, code] of heads)
  test(`${name}: answers ${status} ${code}`, async () => {
    const answer = await ask(daemon.port, bytes);
    assert.deepEqual([answer.status, JSON.parse(answer.body).code], [status, code]);
  });

test('reports a broken escape with its position', async () => {
  for (const [target, byte] of [['/healthz?room=a%zz', 15], ['/healthz?a=1&b=%2', 15], ['/%', 1], ['/healthz?a%00=1', 10]]) {
    const { status, body } = await ask(daemon.port, get(target));
    const error = JSON.parse(body);
    assert.deepEqual([status, error.code, error.byte], [400, 'bad-escape', byte], target);
  }
});

test('decodes every parameter at any position', async () => {
  const secrets = path.join(folder, 'secrets');
  fs.writeFileSync(secrets, `${'a secret'.repeat(5)}\n`);
  const guarded = await Daemon.start(['--secret-file', secrets]);
  const token = execFileSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secrets, '--subject', 'anna', '--room', 'hall'], { encoding: 'utf8' }).trim();
  // a JSON Web Token may hold claims of others: this one has none, so an unknown parameter makes up its length
  const long = await RawSocket.open(guarded.port, {}, `/v1/stream?x-note=${'n'.repeat(2000)}&token=${token}&r%6Fom=h%61ll&lang=it`);
  await long.message({ type: 'joined', room: 'hall', may_speak: true });
  await long.close();
  // as a sub-protocol longer than 126 bytes
  const protocol = await RawSocket.open(guarded.port, { 'Sec-WebSocket-Protocol': `faccia.v1, token.${token}` }, '/v1/stream?room=hall');
  assert.match(protocol.accepted, /sec-websocket-protocol: faccia\.v1/i);
  await protocol.message({ type: 'joined', room: 'hall', may_speak: true });
  await protocol.close();
  assert.equal((await guarded.stop()).code, 0);
  const { body } = await ask(daemon.port, get('/v1/stop?room=a+b%26c', '').replace('GET', 'POST').replace('\r\n\r\n', '\r\nContent-Length: 0\r\n\r\n'));
  assert.match(JSON.parse(body).message, /'a b&c'/);
});

test('HEAD is GET without the body, on every route', async () => {
  for (const target of ['/', '/healthz', '/v1/voices', '/v1/models', '/v1/models/mara', '/v1/expressions', '/v1/rooms', '/v1/media', '/metrics', '/nowhere', '/v1/events?room=h']) {
    const raw = await Raw.open(daemon.port);
    raw.write(get(target).replace('GET', 'HEAD') + get('/v1/voices'));
    const head = await raw.answer({ head: true });
    if (!target.startsWith('/v1/events')) assert.ok(Number(head.headers['content-length']) > 0, target);
    assert.equal(Object.keys(JSON.parse((await raw.answer()).body))[0], 'voices', `${target}: the next answer comes right after the head`);
    await raw.close();
  }
});

test('HTTP/1.0: closes after the answer unless keep-alive is requested; sends no chunks', async () => {
  const raw = await Raw.open(daemon.port);
  raw.write('GET /healthz HTTP/1.0\r\n\r\n');
  const answer = await raw.answer();
  assert.deepEqual([answer.status, answer.headers.connection], [200, 'close']);
  await raw.end();
  const stays = await Raw.open(daemon.port);
  stays.write('GET /healthz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n');
  assert.equal((await stays.answer()).headers.connection, 'keep-alive');
  stays.write(post('Sì.', '', '/v1/speech?lang=it&format=wav').replace('HTTP/1.1', 'HTTP/1.0'));
  const wav = await stays.answer();
  assert.equal(wav.headers['transfer-encoding'], undefined);
  assert.equal(wav.body.slice(0, 4), 'RIFF');
  await stays.end();
});

test('accepts an absolute address', async () => {
  const answer = await ask(daemon.port, 'GET http://localhost/healthz?x=1 HTTP/1.1\r\nHost: elsewhere\r\n\r\n');
  assert.equal(answer.status, 200);
  assert.equal((await ask(daemon.port, 'GET HTTP://localhost HTTP/1.1\r\nHost: localhost\r\n\r\n')).status, 200);
});

test('keeps a connection open, and announces when it will not', async () => {
  const raw = await Raw.open(daemon.port);
  raw.write('\r\n' + get());
  assert.equal((await raw.answer()).headers.connection, undefined);
  raw.write(get('/healthz', 'Connection: close\r\n') + get());
  assert.equal((await raw.answer()).headers.connection, 'close');
  assert.equal(await raw.answer(), false, 'what comes after is not answered');
  await raw.end();
});

test('ends slow requests at a deadline, and idle connections later', { timeout: 90000 }, async (t) => {
  const [silent, slowHead, slowBody, steady, idle] = await Promise.all(Array.from({ length: 5 }, () => Raw.open(daemon.port)));
  idle.write(get());
  await idle.answer();
  const began = Date.now();
  slowHead.write('GET /healthz HTTP/1.1\r\nHost: localhost\r\n');
  slowBody.write('POST /v1/speech?lang=it&format=json HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5000\r\n\r\n');
  // 20 kB at 1000 bytes a second
  steady.write('POST /v1/speech?lang=it&format=json&markup=plain HTTP/1.1\r\nHost: localhost\r\nContent-Type: text/plain\r\nContent-Length: 20003\r\n\r\n');
  let sent = 0;
  const wait = { milliseconds: 60000 };
  const drip = setInterval(() => {
    slowHead.write('X-A: b\r\n');
    slowBody.write('a');
    if (sent++ < 20) steady.write(' '.repeat(1000));
    if (sent === 21) steady.write('Si.');
  }, 1000);
  t.after(() => clearInterval(drip));
  const answers = await Promise.all([silent.end(), slowHead.answer(wait), slowBody.answer(wait), steady.answer(wait)]);
  clearInterval(drip);
  assert.deepEqual(answers.slice(1, 3).map(({ status, body }) => [status, JSON.parse(body).code]), [[408, 'request-timeout'], [408, 'request-timeout']]);
  assert.equal(answers[3].status, 200, answers[3].body);
  await idle.end();
  assert.ok(Date.now() - began > 25000, 'one that has asked before may wait for longer');
  await Promise.all([silent, slowHead, slowBody, steady].map((raw) => raw.close()));
});

test('clients that reset, half-close, or stop midway affect no others', async () => {
  const texts = [get(), post('Una frase. '.repeat(50)), 'GET / HT', 'POST /v1/speech HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nab', handshake()];
  for (let i = 0; i < 60; i++) {
    const raw = await Raw.open(daemon.port);
    raw.write(texts[i % texts.length]);
    if (i % 3 === 0) raw.socket.resetAndDestroy();
    else if (i % 3 === 1) raw.socket.end();
    else raw.socket.destroy();
  }
  await daemon.left(3);
});
