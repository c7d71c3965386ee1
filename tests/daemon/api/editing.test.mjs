// SPDX-License-Identifier: GPL-3.0-or-later
// Editing over HTTP: works of the library and gestures; permissions, and errors with their places.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, eventually, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-editing-'));
const [works, gestures] = ['works', 'gestures'].map((name) => path.join(folder, name));
const secret = 'a secret that is long enough for the daemon';
const [editor, speaker] = ['listen speak operate', 'listen speak'].map((rights) => sign({ secret, claims: { rights } }));
const wink = fs.readFileSync(path.join(root, 'models/gestures/wink.json'), 'utf8');
const folders = ['--library', works, '--library-index', path.join(folder, 'index'), '--gestures', gestures];

let daemon;
before(async () => {
  for (const each of [works, gestures]) fs.mkdirSync(each);
  fs.writeFileSync(path.join(folder, 'secrets'), secret, { mode: 0o600 });
  daemon = await Daemon.start([...folders, '--editing', '--secret-file', path.join(folder, 'secrets')], {}, { voices: false });
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

async function ask(method, address, { body, token = editor, to = daemon, ...headers } = {}) {
  const response = await fetch(`${to.url}${address}`, { method, body, headers: { ...(token ? { authorization: `Bearer ${token}` } : {}), ...headers } });
  const text = await response.text();
  return { status: response.status, etag: response.headers.get('etag'), text, ...(text.startsWith('{') ? JSON.parse(text) : {}) };
}
const put = (address, body, headers) => ask('PUT', address, { body, ...headers });
const found = async (q) => (await ask('GET', `/v1/library/search?q=${q}`)).results;

test('saves a marked-up text in the library, finds, changes and removes it', async () => {
  const address = '/v1/library/files/sogno.it.ssml';
  const first = await put(address, '<speak xml:lang="it">Un sogno di zafferano.</speak>');
  assert.deepEqual([first.status, first.name], [201, 'sogno.it.ssml']);
  const [place] = await eventually(async () => { const all = await found('zafferano'); return all.length && all; }, 'the new work');
  assert.equal(place.work.id, 'sogno-it');
  const read = await ask('GET', address);
  assert.deepEqual([read.text, read.etag], ['<speak xml:lang="it">Un sogno di zafferano.</speak>', first.etag]);
  assert.equal((await put(address, '<speak>x</speak>')).code, 'condition-needed');
  assert.equal((await put(address, '<speak>x</speak>', { 'if-match': '"other"' })).code, 'changed');
  const second = await put(address, '<speak xml:lang="it">Un sogno di cannella.</speak>', { 'if-match': first.etag });
  assert.equal(second.status, 200);
  await eventually(async () => (await found('cannella')).length, 'the changed work');
  assert.deepEqual((await ask('GET', '/v1/library/files')).files.map(({ name }) => name), ['sogno.it.ssml']);
  assert.equal((await ask('DELETE', address, { 'if-match': second.etag })).type, 'removed');
  await eventually(async () => !(await found('cannella')).length, 'the end of it');
  assert.deepEqual(fs.readdirSync(works), []);
});

test('rejects an unreadable document with its position', async () => {
  for (const [name, body, place] of [
    ['a.ssml', '<speak>\nUna <p>riga</speak>', { code: 'bad-work', line: 2 }],
    ['a.xml', '<TEI><text><body>\n<p>Poi <hi>no</p></body></text></TEI>', { code: 'bad-work', line: 2, column: 16 }],
    ['a.txt', Buffer.from('Una riga.\nPerch\xe9 no?\n', 'latin1'), { code: 'bad-work', line: 2, column: 6 }],
    ['a.md', '', { code: 'bad-work' }],
    ['a.exe', 'Testo.', { code: 'bad-field', field: 'name' }],
    ['a.epub', 'PK', { code: 'bad-field', field: 'name' }],
    ['.a.md', 'Testo.', { code: 'bad-field', field: 'name' }],
    ['..%2Fa.md', 'Testo.', { code: 'bad-field', field: 'name' }],
  ]) {
    const answer = await put(`/v1/library/files/${name}`, body);
    assert.equal(answer.status, 400, name);
    for (const key in place) assert.equal(answer[key], place[key], `${name} ${answer.text}`);
  }
  const long = await put('/v1/library/files/long.txt', 'Una riga di testo.\n'.repeat(450000));
  assert.deepEqual([long.status, long.code], [413, 'document-too-long']);
  assert.deepEqual(fs.readdirSync(works), []);
});

test('makes a saved gesture available at once, and after a restart', async () => {
  const mine = wink.replace('"wink"', '"my-wink"');
  assert.equal((await put('/v1/gestures/my-wink', mine)).status, 201);
  for (const [body, place] of [
    [wink, { field: 'name' }],
    ['{\n "name": }', { line: 2 }],
    [mine.replace(/"r_cheek|"close_t_l_eyelid|"close_/, '"no_such_'), {}],
    [mine.replace('"faccia-gesture"', '"other"'), { field: 'format' }],
  ]) {
    const answer = await put('/v1/gestures/my-wink', body, { 'if-match': '*' });
    assert.deepEqual([answer.status, answer.code], [400, 'bad-expressions'], answer.text);
    for (const key in place) assert.equal(answer[key], place[key], answer.text);
  }
  assert.equal((await ask('GET', '/v1/gestures/my-wink')).text, mine, 'a refused one changes nothing');
  const text = `<speak xml:lang="it">${'La mamma <gesture name="my-wink"/> parla piano. '.repeat(3)}</speak>`;
  /** Amplitude of the nod. */
  const nods = async () => {
    const { text: fap } = await ask('POST', '/v1/speech?format=fap&life=0', { body: text, 'content-type': 'application/ssml+xml' });
    return Math.max(...parseFap(fap).frames.map((frame) => frame[48]));
  };
  const lists = async () => (await ask('GET', '/v1/expressions')).expressions.some(({ name }) => name === 'my-wink');
  assert.ok((await nods()) < 20000);
  assert.ok(await lists());
  const nod = JSON.stringify({ ...JSON.parse(mine), curves: { head_pitch: Array(26).fill(40000) } });
  const stream = await daemon.stream(`?token=${editor}`);
  stream.send({ type: 'speak', id: 'long', lang: 'it', text });
  await stream.wait({ type: 'begin', id: 'long' });
  for (let i = 0; i < 6; i++) assert.equal((await put('/v1/gestures/my-wink', i % 2 ? mine : nod, { 'if-match': '*' })).status, 200);
  assert.equal((await put('/v1/gestures/my-wink', nod, { 'if-match': '*' })).status, 200);
  assert.ok((await nods()) > 30000, 'the new one is shown');
  stream.send({ type: 'speak', id: 'mood', lang: 'it', text: 'Ciao.' });
  for (const id of ['long', 'mood']) assert.equal((await stream.wait({ type: 'end', id })).reason, 'done');
  await stream.close();
  assert.equal((await put('/v1/gestures/my-wink', mine, { 'if-match': '*' })).status, 200);
  assert.ok((await nods()) < 20000, 'and the old one again');
  const other = await Daemon.start(folders, {}, { voices: false });
  const { expressions } = await (await other.get('/v1/expressions')).json();
  assert.ok(expressions.some(({ kind, name }) => kind === 'gesture' && name === 'my-wink'));
  for (const [method, address] of [['PUT', '/v1/gestures/a'], ['GET', '/v1/gestures'], ['PUT', '/v1/library/files/a.md'], ['DELETE', '/v1/gestures/my-wink']])
    assert.equal((await ask(method, address, { to: other, token: null, body: method === 'PUT' ? mine : undefined })).code, 'nothing-kept', 'without --editing nothing is kept');
  assert.equal((await other.stop()).code, 0);
  assert.equal((await ask('DELETE', '/v1/gestures/my-wink', { 'if-match': '*' })).status, 200);
  assert.ok(!(await lists()));
  const { warnings } = await ask('POST', '/v1/speech?format=json', { body: text, 'content-type': 'application/ssml+xml' });
  assert.ok(warnings.some(({ message }) => message.includes('my-wink')), JSON.stringify(warnings));
});

test('requires the right to operate for every change', async () => {
  for (const [token, code] of [[null, 'token-needed'], [speaker, 'forbidden']])
    for (const [method, address] of [['PUT', '/v1/gestures/a'], ['DELETE', '/v1/gestures/a'], ['PUT', '/v1/library/files/a.md'], ['DELETE', '/v1/library/files/a.md']])
      assert.equal((await ask(method, address, { token, body: method === 'PUT' ? wink : undefined })).code, code);
  assert.deepEqual((await ask('GET', '/v1/library/files', { token: speaker })).files, []);
});
