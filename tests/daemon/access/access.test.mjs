// SPDX-License-Identifier: GPL-3.0-or-later
// Access control: tokens, origins, and limits per address and per subject.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, Stream } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-access-'));
const secretFile = path.join(folder, 'secrets');
const otherFile = path.join(folder, 'others');
fs.writeFileSync(secretFile, 'a secret that is long enough for the daemon\n');
fs.writeFileSync(otherFile, 'another secret, which the daemon does not know\n');

const token = (options = [], file = secretFile) => {
  const args = ['token', '--secret-file', file, '--subject', 'anna', ...options];
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), args, { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return stdout.trim();
};
const bearer = (text) => ({ headers: { authorization: `Bearer ${text}` } });

/** Sends a request with any headers; fetch does not allow setting Origin. */
const request = (port, { path: address = '/', method = 'GET', headers = {}, body } = {}) =>
  new Promise((resolve, reject) => {
    const request = http.request({ host: '127.0.0.1', port, path: address, method, headers }, (response) => {
      let text = '';
      response.setEncoding('utf8').on('data', (piece) => (text += piece));
      response.on('end', () => resolve({ status: response.statusCode, headers: response.headers, text }));
    });
    request.on('error', reject).end(body);
  });

let daemon;
before(async () => (daemon = await Daemon.start(['--secret-file', secretFile, '--origin', 'https://portal.example'])));
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const speaks = async (stream, id = 'x') => {
  stream.send({ type: 'speak', id, lang: 'it', text: 'Sì.' });
  const end = await stream.wait({ type: 'end', id });
  return end.reason === 'done' || (await stream.wait({ type: 'error', id })).code;
};

test('without a token, clients may look but not speak', async () => {
  const stream = await daemon.stream();
  assert.equal(await speaks(stream), 'token-needed');
  stream.send({ type: 'ping', id: 1 });
  await stream.wait({ type: 'pong' });
  await stream.close();
  const response = await daemon.get('/v1/speech', { method: 'POST', body: 'Sì.' });
  assert.equal(response.status, 401);
  assert.equal((await response.json()).code, 'token-needed');
  for (const address of ['/', '/healthz', '/v1/voices', '/v1/models']) assert.equal((await daemon.get(address)).status, 200);
});

test('accepts the token in a header, the address, or the first message', async () => {
  const good = token();
  for (const stream of [await daemon.stream('', bearer(good)), await daemon.stream(`?token=${good}`)])
    assert.equal(await speaks(stream), true);
  const late = await daemon.stream();
  assert.equal(await speaks(late, 'before'), 'token-needed');
  late.send({ type: 'authorize', token: good });
  await late.wait({ type: 'authorized', subject: 'anna' });
  assert.equal(await speaks(late, 'after'), true);
  const response = await daemon.get('/v1/speech?lang=it', { method: 'POST', body: 'Sì.', ...bearer(good) });
  assert.equal(response.status, 200);
});

test('accepts a token among the sub-protocols, as a browser can send it', async () => {
  const hall = token(['--room', 'hall']);
  const url = `ws://127.0.0.1:${daemon.port}/v1/stream?room=hall&audio=pcm&fap=plain`;
  const stream = await Stream.open(url, {}, ['faccia.v1', `token.${hall}`]);
  assert.equal(stream.socket.protocol, 'faccia.v1');
  await stream.wait({ type: 'joined', room: 'hall', may_speak: true });
  assert.equal(await speaks(stream), true);
  await stream.close();
  const forged = await Stream.open(url, {}, ['faccia.v1', `token.${token(['--room', 'hall'], otherFile)}`]);
  await forged.wait({ type: 'error', code: 'bad-token' });
  await forged.wait({ type: 'error', code: 'token-needed' });
  await forged.close();
  // other routes accept the same token
  assert.equal((await daemon.get('/v1/speech?lang=it', { method: 'POST', body: 'Sì.', ...bearer(token()) })).status, 200);
});

test('rejects forged, damaged, expired and insufficient tokens', async () => {
  const cases = [
    [token([], otherFile), 'bad-token'],
    [token().slice(0, -3), 'bad-token'],
    ['nonsense', 'bad-token'],
    [token(['--rights', 'listen']), 'forbidden'],
    [token(['--room', 'hall']), 'forbidden'],
  ];
  for (const [text, code] of cases) {
    const response = await daemon.get('/v1/speech?lang=it', { method: 'POST', body: 'Sì.', ...bearer(text) });
    assert.equal((await response.json()).code, code, text);
    const stream = await daemon.stream('', bearer(text));
    if (code === 'bad-token') await stream.wait({ type: 'error', code });
    assert.equal(await speaks(stream), code === 'bad-token' ? 'token-needed' : code);
    await stream.close();
  }
  const short = token(['--expires', '4s']);
  const stream = await daemon.stream('', bearer(short));
  const said = new Set();
  for (const until = Date.now() + 60000; !said.has('expired-token') && Date.now() < until; ) said.add(await speaks(stream, `x${Date.now()}`));
  assert.deepEqual([...said].filter((one) => one !== true), ['expired-token']);
  await stream.close();
});

test('reserves metrics for operators', async () => {
  assert.equal((await daemon.get('/metrics')).status, 401);
  assert.equal((await daemon.get('/metrics', bearer(token()))).status, 403);
  const response = await daemon.get('/metrics', bearer(token(['--rights', 'operate'])));
  assert.match(response.headers.get('content-type'), /^text\/plain; version=0.0.4/);
  const text = await response.text();
  const value = (name) => Number(text.match(new RegExp(`^${name} (.*)$`, 'm'))[1]);
  assert.ok(value('faccia_refused_total\\{why="token"\\}') >= 5);
  assert.ok(value('faccia_utterances_total\\{end="done"\\}') >= 3);
  assert.ok(value('faccia_first_media_seconds_count') >= 3);
  assert.ok(value('faccia_speech_seconds_total') > 0.2);
  for (const line of text.trim().split('\n')) assert.match(line, /^(# (HELP|TYPE) faccia_\w+ .+|faccia_\w+(\{\w+="[^"]+"\})? [\d.e+-]+)$/);
  assert.equal(new Set(text.match(/^# TYPE \w+/gm)).size, text.match(/^# TYPE/gm).length, 'each type is told once');
});

test('accepts API requests from pages of listed origins only', async () => {
  const foreign = { origin: 'https://evil.example' };
  const listed = { origin: 'https://portal.example' };
  await assert.rejects(daemon.stream('', { headers: foreign }), /403/);
  await (await daemon.stream('', { headers: listed })).close();
  const refused = await request(daemon.port, { path: '/v1/speech', method: 'POST', headers: foreign, body: 'Sì.' });
  assert.equal(refused.status, 403);
  assert.equal(JSON.parse(refused.text).code, 'forbidden-origin');
  assert.equal(refused.headers['access-control-allow-origin'], undefined);
  const preflight = await request(daemon.port, { path: '/v1/speech', method: 'OPTIONS', headers: { ...listed, 'access-control-request-method': 'POST' } });
  assert.equal(preflight.headers['access-control-allow-origin'], 'https://portal.example');
  assert.match(preflight.headers['access-control-allow-methods'], /POST/);
  assert.match(preflight.headers['access-control-allow-headers'], /authorization/);
  const voices = await request(daemon.port, { path: '/v1/voices', headers: listed });
  assert.equal(voices.headers['access-control-allow-origin'], 'https://portal.example');
  assert.match(voices.headers.vary, /origin/);
  const script = await request(daemon.port, { path: '/', headers: foreign });
  assert.equal(script.headers['access-control-allow-origin'], '*', 'what all may have');
});

test('without a list, accepts pages of this machine only', async () => {
  const open = await Daemon.start();
  for (const [origin, allowed] of [['http://localhost:5173', true], ['http://127.0.0.1', true], ['https://evil.example', false], ['null', false]]) {
    const opened = open.stream('', { headers: { origin } });
    if (allowed) await (await opened).close();
    else await assert.rejects(opened, /403/);
  }
  // DNS rebinding: a name that an attacker points to this machine; Origin and Host agree
  const rebound = await request(open.port, { path: '/v1/speech', method: 'POST', headers: { origin: 'http://evil.example', host: 'evil.example' }, body: 'Sì.' });
  assert.equal(rebound.status, 421);
  assert.equal((await open.stop()).code, 0);
});

test('limits each address and each subject', async () => {
  const tight = await Daemon.start(['--max-per-address', '2', '--max-requests', '3', '--secret-file', secretFile]);
  const first = await tight.stream('', bearer(token()));
  const second = await tight.stream('', bearer(token()));
  const third = await tight.stream('', bearer(token(['--subject', 'anna'])));
  await third.wait({ type: 'error', code: 'too-many-per-address' });
  // same address, another subject
  const other = await tight.stream('', bearer(token(['--subject', 'bruno'])));
  assert.equal(await speaks(other), true);
  const asked = [];
  for (let i = 0; i < 4; i++) asked.push(await speaks(i % 2 ? first : second, `n${i}`));
  // the minute may end once in between, never twice
  assert.ok(asked.filter((a) => a === 'too-many-requests').length <= 1);
  for (let i = 4; i < 8; i++) asked.push(await speaks(first, `n${i}`));
  assert.ok(asked.includes('too-many-requests'));
  assert.ok(asked.slice(0, 3).every((a) => a === true));
  assert.equal((await tight.stop()).code, 0);
});
