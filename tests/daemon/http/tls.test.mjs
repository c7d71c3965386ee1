// SPDX-License-Identifier: GPL-3.0-or-later
// TLS: certificates of the operator and of the daemon, refusals, redirects, and all other features over TLS.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import http from 'node:http';
import http2 from 'node:http2';
import https from 'node:https';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import tls from 'node:tls';
import { build, Daemon, eventually, Stream } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-tls-'));
const own = path.join(folder, 'own');
const file = (name) => path.join(folder, name);
let daemon, ca;

/** Makes a certificate and its key with openssl. */
function certify(name, days = 30) {
  execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes', '-days', String(days), '-subj', `/CN=${name}`, '-addext', 'subjectAltName=DNS:localhost,IP:127.0.0.1',
    '-keyout', file(`${name}.key`), '-out', file(`${name}.pem`)], { stdio: 'ignore' });
  fs.chmodSync(file(`${name}.key`), 0o600);
  return ['--tls-cert', file(`${name}.pem`), '--tls-key', file(`${name}.key`)];
}
/** Sends a request over TLS. */
function ask(address, options = {}, body = null) {
  return new Promise((resolve, reject) => {
    const request = https.request({ host: '127.0.0.1', port: daemon.port, path: address, ca, agent: false, ...options }, async (response) => {
      const parts = [];
      for await (const part of response) parts.push(part);
      resolve({ status: response.statusCode, headers: response.headers, body: Buffer.concat(parts), protocol: response.socket.getProtocol?.() });
    });
    request.on('error', reject);
    request.end(body);
  });
}
/** Does a handshake. Returns the negotiated parameters and the certificate's name. */
async function shake(options = {}) {
  const socket = tls.connect({ host: '127.0.0.1', port: daemon.port, rejectUnauthorized: false, ...options });
  await once(socket, 'secureConnect');
  const seen = { protocol: socket.getProtocol(), alpn: socket.alpnProtocol, fingerprint: socket.getPeerX509Certificate().fingerprint256 };
  socket.destroy();
  return seen;
}

before(async () => {
  daemon = await Daemon.start(['--tls-self-signed', own, '--hsts', '3600']);
  ca = fs.readFileSync(path.join(own, 'ca.pem')); // as installed on a device
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

test('a self-signed certificate: created once, its fingerprint logged, its key private', async () => {
  const [, told] = await daemon.logged(/fingerprint: ((?:[0-9A-F]{2}:){31}[0-9A-F]{2})/);
  assert.match(execFileSync('openssl', ['x509', '-in', path.join(own, 'cert.pem'), '-noout', '-fingerprint', '-sha256'], { encoding: 'utf8' }), new RegExp(`=${told}`));
  assert.equal((await shake()).fingerprint, told);
  assert.equal(fs.statSync(path.join(own, 'key.pem')).mode & 0o777, 0o600);
  const said = execFileSync('openssl', ['x509', '-in', path.join(own, 'cert.pem'), '-noout', '-text'], { encoding: 'utf8' });
  assert.match(execFileSync('openssl', ['x509', '-in', path.join(own, 'ca.pem'), '-noout', '-text'], { encoding: 'utf8' }), /CA:TRUE, pathlen:0/);
  assert.deepEqual(fs.readdirSync(own).sort(), ['ca.pem', 'cert.pem', 'key.pem'], 'the authority’s key is not kept');
  for (const part of ['DNS:localhost', 'IP Address:127.0.0.1', 'TLS Web Server Authentication', 'CA:FALSE']) assert.ok(said.includes(part), part);
  const again = await Daemon.start(['--tls-self-signed', own], {}, { voices: false });
  assert.ok(again.log.includes(told), 'the same one');
  assert.equal((await again.stop()).code, 0);
  assert.match(daemon.log, /listening on https:/);
});

test('replaces an expired one', async () => {
  const old = file('old');
  fs.mkdirSync(old);
  certify('ended', 2); // expires before the next check
  fs.renameSync(file('ended.pem'), path.join(old, 'cert.pem'));
  fs.renameSync(file('ended.key'), path.join(old, 'key.pem'));
  const before = fs.readFileSync(path.join(old, 'cert.pem'), 'utf8');
  const other = await Daemon.start(['--tls-self-signed', old], {}, { voices: false });
  assert.equal((await other.stop()).code, 0);
  assert.notEqual(fs.readFileSync(path.join(old, 'cert.pem'), 'utf8'), before);
});

test('requests, long answers, long bodies and speech work over TLS', async () => {
  const health = await ask('/healthz');
  assert.deepEqual([health.status, health.headers['strict-transport-security']], [200, 'max-age=3600']);
  const [{ name }] = JSON.parse((await ask('/v1/models')).body).models;
  const address = `/v1/models/${name}`;
  const [plain, secure] = [Buffer.from(await (await daemon.get(address)).arrayBuffer()), (await ask(address)).body];
  assert.ok(plain.equals(secure) && plain.length > 500000, `${plain.length} ${secure.length}`);
  const sound = await ask('/v1/speech?lang=it', { method: 'POST', headers: { 'content-type': 'text/plain' } }, 'Ciao a tutti. '.repeat(40));
  assert.equal(sound.body.subarray(0, 4).toString(), 'RIFF');
  assert.ok(sound.body.length > 500000);
  assert.equal((await ask('/v1/speech', { method: 'POST' }, 'x'.repeat(2 << 20))).status, 413);
  const stream = await Stream.open(`wss://127.0.0.1:${daemon.port}/v1/stream?lang=it&audio=pcm&fap=plain`, { ca });
  stream.send({ type: 'speak', id: 'a', text: 'La mamma canta.' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'done');
  assert.ok(stream.chunks.length > 3);
  await stream.close();
});

test('serves several requests on one connection, pipelined too', async () => {
  const socket = tls.connect({ host: '127.0.0.1', port: daemon.port, ca });
  await once(socket, 'secureConnect');
  let heard = '';
  socket.setEncoding('utf8').on('data', (text) => (heard += text));
  socket.write('GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n'.repeat(3));
  await eventually(() => heard.split('HTTP/1.1 200').length === 4, 'three answers');
  socket.write('GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n');
  await once(socket, 'close');
  assert.equal(heard.split('HTTP/1.1 200').length, 5);
});

test('TLS 1.2 and later, HTTP/1.1 only: by ALPN, by prior knowledge, by an upgrade', async () => {
  assert.equal((await shake()).protocol, 'TLSv1.3');
  assert.equal((await shake({ maxVersion: 'TLSv1.2' })).protocol, 'TLSv1.2');
  await assert.rejects(shake({ minVersion: 'TLSv1', maxVersion: 'TLSv1.1', ciphers: 'DEFAULT@SECLEVEL=0' }), /alert|version|protocol/i);
  assert.equal((await shake({ ALPNProtocols: ['h2', 'http/1.1'] })).alpn, 'http/1.1');
  const preface = 'PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0';
  for (const open of [() => tls.connect({ host: '127.0.0.1', port: daemon.port, ca }), () => net.connect(daemon.port, '127.0.0.1')])
    for (const first of [preface, `GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n${preface}`, 'GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABkAAQAoAAAAAIAAAAA\r\n\r\n',
      `GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\nGET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABkAAQAoAAAAAIAAAAA\r\n\r\n${preface}`]) {
      const socket = open();
      let heard = '';
      socket.setEncoding('latin1').on('data', (text) => (heard += text)).on('error', () => {});
      socket.write(first);
      setTimeout(() => socket.end(), 1000);
      await once(socket, 'close');
      assert.doesNotMatch(heard, /101 Switching|h2c/i, first.slice(0, 60));
      assert.ok(heard.startsWith('HTTP/1.1 '), JSON.stringify(heard.slice(0, 80)));
    }
  const client = http2.connect(`https://127.0.0.1:${daemon.port}`, { ca });
  client.on('error', () => {});
  await new Promise((resolve) => client.on('close', resolve));
  assert.equal((await ask('/healthz')).status, 200);
});

test('local programs may connect without TLS; anything else is disconnected, without affecting others', async () => {
  assert.equal((await daemon.get('/healthz')).status, 200);
  const stream = await daemon.stream('?lang=it');
  stream.send({ type: 'speak', id: 'a', text: 'Ciao.' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'done');
  await stream.close();
  const crowd = Array.from({ length: 60 }, (_, i) => net.connect(daemon.port, '127.0.0.1', function () {
    this.write(i % 3 === 0 ? '\x16\x03\x01\x02\x00\x01' : i % 3 === 1 ? '\x16\x03\x01\x00\x05hallo' : '\x80\x2e\x01\x03\x01');
  }).on('error', () => {}));
  assert.equal((await ask('/healthz')).status, 200);
  crowd.forEach((socket) => socket.destroy());
  await daemon.left(1);
});

test('cleans up after clients that disconnect during a handshake, a long answer or speech', async () => {
  for (let i = 0; i < 20; i++) {
    const socket = tls.connect({ host: '127.0.0.1', port: daemon.port, ca }).on('error', () => {});
    if (i % 2) await once(socket, 'secureConnect');
    socket.write('POST /v1/speech?lang=it HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4000\r\n\r\n');
    socket.write('Ciao. '.repeat(600 + 100 * (i % 3)));
    socket.destroy();
  }
  await daemon.left(1);
});

test('redirects plain HTTP from another machine to https:', async (t) => {
  const address = Object.values(os.networkInterfaces()).flat().find((one) => one.family === 'IPv4' && !one.internal)?.address;
  if (!address) return t.skip('this machine has no other address');
  const secret = file('secret');
  fs.writeFileSync(secret, 'a secret that is long enough for tokens\n', { mode: 0o600 });
  const open = await Daemon.start(['--host', '0.0.0.0', '--remote', '--secret-file', secret, '--tls-self-signed', own, '--host-name', '*'], {}, { voices: false });
  t.after(() => open.stop());
  for (const [method, target] of [['GET', '/library.html?at=a:1'], ['GET', '/healthz'], ['POST', '/v1/say?room=hall'], ['HEAD', '/']]) {
    const response = await new Promise((resolve, reject) => http.request({ host: address, port: open.port, method, path: target, agent: false }, (answer) => (answer.resume(), resolve(answer))).on('error', reject).end());
    assert.deepEqual([response.statusCode, response.headers.location, response.headers['strict-transport-security']], [308, `https://${address}:${open.port}${target}`, undefined], method);
  }
  const refused = await Stream.open(`ws://${address}:${open.port}/v1/stream`, { followRedirects: false }).then(() => 'opened', (error) => error.message);
  assert.match(refused, /308/);
  const answer = await new Promise((resolve, reject) => https.get({ host: address, port: open.port, path: '/healthz', ca, agent: false }, (got) => (got.resume(), resolve(got))).on('error', reject));
  assert.ok([200, 503].includes(answer.statusCode), 'its certificate names this address');
  assert.match(execFileSync('curl', ['-sS', '-L', '--cacert', path.join(own, 'ca.pem'), '-o', '/dev/null', '-w', '%{scheme} %{http_version} %{num_redirects}', `http://${address}:${open.port}/`], { encoding: 'utf8' }), /^HTTPS 1\.1 1$/i);
});

test('SIGHUP loads a new certificate; an invalid one keeps the old one; connections continue', async (t) => {
  const first = certify('first');
  certify('second');
  const other = await Daemon.start(first, {}, { voices: false });
  t.after(async () => assert.equal((await other.stop()).code, 0));
  const seen = async () => {
    const socket = tls.connect({ host: '127.0.0.1', port: other.port, rejectUnauthorized: false });
    await once(socket, 'secureConnect');
    const { subject } = socket.getPeerX509Certificate();
    socket.destroy();
    return subject;
  };
  const reload = async (pattern) => {
    const from = other.log.length;
    other.process.kill('SIGHUP');
    await eventually(() => pattern.test(other.log.slice(from)), `${pattern} in ${other.log}`);
  };
  const kept = await Stream.open(`wss://127.0.0.1:${other.port}/v1/stream`, { rejectUnauthorized: false });
  await kept.wait({ type: 'hello' });
  assert.equal(await seen(), 'CN=first');
  for (const part of ['pem', 'key']) fs.copyFileSync(file(`second.${part}`), file(`first.${part}`));
  await reload(/settings reloaded/);
  assert.equal(await seen(), 'CN=second');
  fs.writeFileSync(file('first.pem'), 'no certificate\n');
  await reload(/error: .*first\.pem.*keeping the current certificate/);
  assert.equal(await seen(), 'CN=second');
  certify('third');
  fs.copyFileSync(file('third.pem'), file('first.pem')); // does not match the key
  await reload(/error: .*(key|mismatch).*keeping the current certificate/);
  assert.equal(await seen(), 'CN=second');
  kept.send({ type: 'ping', id: 'p' });
  await kept.wait({ type: 'pong', id: 'p' });
  await kept.close();
});

test('refuses to start with an invalid certificate or key, a mismatched key, or a world-readable key, and names it', () => {
  certify('good');
  certify('wide');
  certify('else');
  fs.chmodSync(file('wide.key'), 0o644);
  fs.writeFileSync(file('none.pem'), '-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n');
  for (const [options, pattern] of [
    [['--tls-cert', file('good.pem')], /--tls-cert: .*--tls-key/],
    [['--tls-key', file('good.key')], /--tls-key: .*--tls-cert/],
    [['--tls-cert', file('nowhere.pem'), '--tls-key', file('good.key')], /--tls-cert: .*nowhere\.pem/],
    [['--tls-cert', file('good.pem'), '--tls-key', file('nowhere.key')], /--tls-key: .*nowhere\.key.*No such file/],
    [['--tls-cert', file('none.pem'), '--tls-key', file('good.key')], /--tls-cert: .*none\.pem/],
    [['--tls-cert', file('good.pem'), '--tls-key', file('else.key')], /--tls-key: .*mismatch/],
    [['--tls-cert', file('wide.pem'), '--tls-key', file('wide.key')], /--tls-key: .*can be read by everybody/],
    [['--tls-self-signed', file('a/b/c')], /--tls-self-signed: .*No such file/],
    [['--tls-self-signed', own, '--tls-cert', file('good.pem'), '--tls-key', file('good.key')], /--tls-self-signed: .*combined/],
  ]) {
    const { status, stderr } = spawnSync(path.join(build, 'server/daemon/facciad'), ['--port', '0', ...options], { encoding: 'utf8', timeout: 60000 });
    assert.notEqual(status, 0, options.join(' '));
    assert.match(stderr, pattern);
    assert.doesNotMatch(stderr, /Sanitizer/);
  }
});
