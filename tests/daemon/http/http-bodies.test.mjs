// SPDX-License-Identifier: GPL-3.0-or-later
// Request bodies: chunked, false lengths, 100-continue, forms.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';
import { bodies, head } from '../../lib/malformed.mjs';
import { ask, Raw } from '../../lib/raw.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const chunked = (...chunks) => head('Transfer-Encoding: chunked\r\n') + chunks.map((chunk) => `${Buffer.byteLength(chunk).toString(16)}\r\n${chunk}\r\n`).join('') + '0\r\n\r\n';
const healthy = 'GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n';

test('reads a chunked body, however it is cut', async () => {
  const words = async (bytes) => JSON.parse((await ask(daemon.port, bytes)).body).words.map((w) => w.text);
  assert.deepEqual(await words(chunked('Buon', 'giorno ', 'a tutti.')), ['Buongiorno', 'a', 'tutti']);
  const odd = head('Transfer-Encoding: Chunked\r\n') + '004;name="va;lue"\r\nBuon\r\n6 \r\ngiorno\r\nD\r\n a tutti, sì\r\n0\r\nX-Trailer: nothing\r\n\r\n';
  assert.deepEqual(await words(odd), ['Buongiorno', 'a', 'tutti', 'sì']);
  const raw = await Raw.open(daemon.port);
  for (const byte of Buffer.from(chunked('Uno ', 'due.'))) {
    raw.write(Buffer.from([byte]));
    await new Promise((resolve) => setImmediate(resolve));
  }
  assert.deepEqual(JSON.parse((await raw.answer()).body).words.map((w) => w.text), ['Uno', 'due']);
  raw.write(healthy); // the next request begins in the right place
  assert.equal((await raw.answer()).status, 200);
  await raw.close();
});

for (const [name, bytes, status, code] of bodies)
  test(`${name}: answers ${status} ${code} and closes`, async () => {
    const raw = await Raw.open(daemon.port);
    raw.write(bytes + healthy);
    const answer = await raw.answer();
    assert.deepEqual([answer.status, JSON.parse(answer.body).code, answer.headers.connection], [status, code, 'close']);
    assert.equal(await raw.answer(), false, 'nothing after it is taken for a request');
    await raw.close();
  });

test('answers 413 to a body over the limit, chunked or not', async (t) => {
  const long = 'a'.repeat(100001);
  for (const bytes of [head(`Content-Length: ${long.length}\r\n`) + long, chunked(...Array(11).fill('a'.repeat(10000)))]) {
    const answer = await ask(daemon.port, bytes);
    assert.deepEqual([answer.status, JSON.parse(answer.body).code], [413, 'text-too-long']);
  }
  // an endless body is not read to its end
  const raw = await Raw.open(daemon.port);
  t.after(() => clearInterval(flood));
  raw.write(head('Transfer-Encoding: chunked\r\n'));
  const flood = setInterval(() => raw.socket.writable && raw.write(`10000\r\n${'a'.repeat(65536)}\r\n`), 1);
  assert.equal((await raw.answer()).status, 413);
  await raw.end();
  clearInterval(flood);
});

test('sends 100-continue only when the body is wanted', async () => {
  const fields = 'Content-Length: 3\r\nExpect: 100-continue\r\n';
  const raw = await Raw.open(daemon.port);
  raw.write(head(fields));
  assert.equal((await raw.answer()).status, 100);
  raw.write('Sì'.normalize());
  assert.equal((await raw.answer()).status, 200);
  raw.write(head(fields, '/v1/speech').replace('text/plain', 'image/png'));
  const refused = await raw.answer();
  assert.deepEqual([refused.status, refused.headers.connection], [415, 'close']);
  await raw.end();
  const long = 'Una frase. '.repeat(8000);
  const curl = spawnSync('curl', ['-s', '-m', '60', '-o', '/dev/null', '-w', '%{http_code}', '-H', 'Expect: 100-continue', '-H', 'Transfer-Encoding: chunked', '-H', 'Content-Type: text/plain', '--data-binary', '@-', `${daemon.url}/v1/speech?lang=it&format=fapc&rate=500`], { encoding: 'utf8', input: long.slice(0, 2000) });
  assert.equal(curl.stdout, '200');
});

test('skips an unwanted body when it is short', async () => {
  const raw = await Raw.open(daemon.port);
  raw.write(head('Content-Length: 1000\r\n', '/v1/voices') + 'x'.repeat(1000) + healthy);
  assert.equal((await raw.answer()).status, 405);
  assert.equal((await raw.answer()).status, 200);
  raw.write(head('Content-Length: 1000000\r\n', '/v1/voices'));
  assert.equal((await raw.answer()).headers.connection, 'close');
  await raw.end();
});

test('limits each address: counts idle connections, and requests made on other connections', async () => {
  const tight = await Daemon.start(['--max-per-address', '4', '--max-requests', '5']);
  const idle = [];
  for (let i = 0; i < 4; i++) {
    idle.push(await Raw.open(tight.port));
    idle[i].write(healthy);
    assert.equal((await idle[i].answer()).status, 200);
  }
  const fifth = await ask(tight.port, healthy);
  assert.deepEqual([fifth.status, JSON.parse(fifth.body).code, fifth.headers.connection], [429, 'too-many-per-address', 'close']);
  assert.ok(Number(fifth.headers['retry-after']) > 0);
  await Promise.all(idle.map((raw) => raw.close()));
  // the minute may end once in between, never twice
  const statuses = [];
  for (let i = 0; i < 12; i++) {
    let answer;
    do answer = await ask(tight.port, head('Content-Length: 1\r\n', '/v1/stop?room=nowhere') + 'x');
    while (JSON.parse(answer.body).code === 'too-many-per-address');
    statuses.push(answer.status);
  }
  assert.ok(statuses.filter((status) => status === 429).length >= 2, statuses.join());
  assert.ok(statuses.slice(0, 5).every((status) => status === 404) || statuses.includes(404), statuses.join());
  assert.equal((await tight.stop()).code, 0);
});
