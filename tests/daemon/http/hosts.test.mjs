// SPDX-License-Identifier: GPL-3.0-or-later
// Allowed Host names and pages: DNS rebinding, and browser requests without an Origin.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';
import { request } from '../../lib/raw-http.mjs';
import { sign } from '../../lib/tokens.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const addresses = ['/', '/healthz', '/talking-head.js', '/v1/voices', '/v1/models/mara', '/v1/rooms', '/v1/openapi.json', '/metrics', '/v1/speech?text=Ciao', '/nowhere'];
const foreign = ['evil.example', 'evil.example:80', 'localhost.evil.example', '127.0.0.1.evil.example', '[::1].evil.example', '*'];

test('answers 421 to an unknown host name at every address', async () => {
  for (const host of foreign)
    for (const address of host === foreign[0] ? addresses : ['/', '/v1/voices']) {
      const { status, text, headers } = await request(daemon.port, { path: address, headers: { host } });
      assert.equal(status, 421, `${host} ${address}`);
      const error = JSON.parse(text);
      assert.equal(error.code, 'unknown-host');
      assert.match(error.message, /--host-name/);
      assert.equal(headers['access-control-allow-origin'], undefined);
    }
  for (const method of ['POST', 'OPTIONS', 'HEAD', 'PUT'])
    assert.equal((await request(daemon.port, { path: '/v1/speech', method, headers: { host: 'evil.example' } })).status, 421, method);
});

test('rejects a rebound page whose origin agrees with its host', async () => {
  const headers = { host: `evil.example:${daemon.port}`, origin: `http://evil.example:${daemon.port}` };
  const { status } = await request(daemon.port, { path: '/v1/speech', method: 'POST', headers, body: 'Sì.' });
  assert.equal(status, 421);
  await assert.rejects(daemon.stream('', { headers }), /421/);
  await assert.rejects(daemon.stream('', { headers: { host: 'evil.example' } }), /421/);
});

test('a local daemon accepts localhost and loopback addresses only', async () => {
  const names = ['localhost', `LocalHost:${daemon.port}`, 'localhost.', 'face.localhost', '127.0.0.1', '127.8.9.10:80', '[::1]', `[0:0:0:0:0:0:0:1]:${daemon.port}`];
  for (const host of names) {
    assert.equal((await request(daemon.port, { path: '/healthz', headers: { host } })).status, 200, host);
    await (await daemon.stream('', { headers: { host } })).close();
  }
  // hosts to which browsers send requests without Sec-Fetch headers
  const others = ['0.0.0.0', `[::ffff:7f00:1]:${daemon.port}`, '[::ffff:127.0.0.1]', '[::]', '192.0.2.7:8080', '[2001:db8::1]:80', os.hostname()];
  for (const host of others) {
    const { status, text } = await request(daemon.port, { path: '/v1/speech?text=Ciao', headers: { host } });
    assert.deepEqual([status, JSON.parse(text).code], [421, 'unknown-host'], host);
    await assert.rejects(daemon.stream('', { headers: { host } }), /421/, host);
  }
});

test('a remote daemon with tokens accepts the machine\'s name and any numeric address', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-hosts-'));
  fs.writeFileSync(path.join(folder, 'secrets'), 'a secret that is long enough for the daemon\n', { mode: 0o600 });
  const own = await Daemon.start(['--host', '0.0.0.0', '--remote', '--secret-file', path.join(folder, 'secrets')], {}, { voices: false });
  for (const host of ['localhost', '127.0.0.1', '192.0.2.7:8080', '[2001:db8::1]:80', os.hostname()])
    assert.notEqual((await request(own.port, { path: '/healthz', headers: { host } })).status, 421, host);
  assert.equal((await request(own.port, { path: '/healthz', headers: { host: 'evil.example' } })).status, 421);
  assert.equal((await own.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

test('accepts a request without a host, which no browser sends', async () => {
  const socket = net.connect(daemon.port, '127.0.0.1');
  socket.end('GET /healthz HTTP/1.0\r\n\r\n');
  let text = '';
  for await (const bytes of socket) text += bytes;
  assert.match(text, /^HTTP\/1\.[01] 200 /);
});

test('--host-name accepts other names, one or several, with tokens too', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-hosts-'));
  const secret = 'a secret that is long enough for the daemon';
  fs.writeFileSync(path.join(folder, 'secrets'), `${secret}\n`, { mode: 0o600 });
  const config = path.join(folder, 'config.json');
  fs.writeFileSync(config, JSON.stringify({ access: { host_names: ['face.example', 'head.example'] } }));
  const own = await Daemon.start(['--config', config, '--secret-file', path.join(folder, 'secrets')]);
  const status = async (host) =>
    (await request(own.port, { path: '/v1/rooms', headers: { host, authorization: `Bearer ${sign({ secret })}` } })).status;
  assert.equal(await status('FACE.example:443'), 200);
  assert.equal(await status('head.example'), 200);
  assert.equal(await status('evil.example'), 421);
  assert.equal(await status('x.face.example'), 421);
  fs.writeFileSync(config, JSON.stringify({ access: { host_names: ['*'] } }));
  own.process.kill('SIGHUP');
  await own.logged(/settings reloaded/);
  assert.equal(await status('evil.example'), 200);
  assert.equal((await own.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

test('rejects cross-site fetches without an origin, except followed links', async () => {
  const embedded = { 'sec-fetch-site': 'cross-site', 'sec-fetch-mode': 'no-cors', 'sec-fetch-dest': 'audio' };
  const get = (address, headers) => request(daemon.port, { path: address, headers });
  for (const address of ['/v1/speech?text=Ciao', '/v1/rooms', '/v1/events?room=x', '/metrics']) {
    const { status, text } = await get(address, embedded);
    assert.equal(status, 403, address);
    assert.equal(JSON.parse(text).code, 'forbidden-origin');
  }
  const speech = '/v1/speech?text=Ciao&lang=it&format=json';
  const allowed = [
    {}, // not a browser
    { 'sec-fetch-site': 'none', 'sec-fetch-mode': 'navigate', 'sec-fetch-user': '?1' }, // typed
    { 'sec-fetch-site': 'same-origin', 'sec-fetch-mode': 'no-cors' },
    { 'sec-fetch-site': 'cross-site', 'sec-fetch-mode': 'navigate', 'sec-fetch-user': '?1', 'sec-fetch-dest': 'document' }, // a link that was followed
    { 'sec-fetch-site': 'cross-site', 'sec-fetch-mode': 'cors', origin: 'http://localhost:5173' },
  ];
  for (const headers of allowed) assert.equal((await get(speech, headers)).status, 200, JSON.stringify(headers));
  // a frame that a page navigates without user action
  assert.equal((await get(speech, { 'sec-fetch-site': 'cross-site', 'sec-fetch-mode': 'navigate', 'sec-fetch-dest': 'document' })).status, 403);
  const frame = { 'sec-fetch-site': 'cross-site', 'sec-fetch-mode': 'navigate', 'sec-fetch-dest': 'iframe' };
  assert.equal((await get(speech, frame)).status, 403);
  assert.equal((await get(speech, { ...frame, 'sec-fetch-user': '?1' })).status, 403); // after a click anywhere on the page
  // any page may load scripts and heads
  for (const address of ['/talking-head.js', '/v1/models/mara']) assert.equal((await get(address, embedded)).status, 200);
});

test('rejects changes from a page of another origin whose body needs no preflight', async () => {
  const origins = ['http://evil.example', 'null', 'http://localhost.evil.example', 'https://127.0.0.1.evil.example'];
  const posts = ['/v1/speech?lang=it', '/v1/say?room=x', '/v1/stop?room=x', '/v1/rooms/x/commands',
    '/v1/play?room=x', '/v1/revoke'];
  for (const address of posts)
    for (const type of ['text/plain', 'application/x-www-form-urlencoded', 'multipart/form-data; boundary=x', undefined])
      for (const origin of origins) {
        const headers = { origin, ...(type && { 'content-type': type }) };
        const { status, text } = await request(daemon.port, { path: address, method: 'POST', headers, body: '{"text":"Ciao."}' });
        assert.deepEqual([status, JSON.parse(text).code], [403, 'forbidden-origin'], `${address} ${type} ${origin}`);
      }
  for (const method of ['PUT', 'DELETE'])
    assert.equal((await request(daemon.port, { path: '/v1/scenes/x', method, headers: { origin: origins[0] } })).status, 403, method);
  for (const origin of origins) await assert.rejects(daemon.stream('', { headers: { origin } }), /403/);
});

test('rejects a browser that sends no Sec-Fetch headers: an old one, or by an untrusted name', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-hosts-'));
  const secret = 'a secret that is long enough for the daemon';
  fs.writeFileSync(path.join(folder, 'secrets'), `${secret}\n`, { mode: 0o600 });
  const agent = { 'user-agent': 'Mozilla/5.0 (Macintosh; Intel Mac OS X 10_15_7) AppleWebKit/605.1.15 (KHTML, like Gecko) Version/15.6 Safari/605.1.15' };
  const speech = '/v1/speech?text=Ciao&lang=it&format=json';
  const { status, text } = await request(daemon.port, { path: speech, headers: agent });
  assert.deepEqual([status, JSON.parse(text).code], [403, 'forbidden-origin']);
  const curl = { 'user-agent': 'curl/8.5.0' }, shell = { 'user-agent': 'Mozilla/5.0 (Windows NT; it-IT) WindowsPowerShell/5.1.22621' };
  for (const headers of [curl, shell, { ...agent, origin: 'http://localhost' }])
    assert.equal((await request(daemon.port, { path: speech, headers })).status, 200, JSON.stringify(headers));
  assert.equal((await request(daemon.port, { path: '/', headers: agent })).status, 200); // typed into the address bar
  const own = await Daemon.start(['--secret-file', path.join(folder, 'secrets')]);
  assert.equal((await request(own.port, { path: `${speech}&token=${sign({ secret })}`, headers: agent })).status, 200);
  assert.equal((await own.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});
