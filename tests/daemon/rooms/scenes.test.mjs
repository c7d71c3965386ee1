// SPDX-License-Identifier: GPL-3.0-or-later
// Operators' scenes on the server: permissions, errors with their places, and no overwriting of concurrent changes.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-scenes-'));
const kept = path.join(folder, 'kept');
const secret = 'a secret that is long enough for the daemon';
const operator = sign({ secret, claims: { rights: 'listen speak operate' } });
const scene = (text = 'Buongiorno.') => JSON.stringify({ title: 'Pranzo', lines: [{ id: '1', text }] });

let daemon;
before(async () => {
  fs.mkdirSync(kept);
  fs.writeFileSync(path.join(folder, 'secrets'), secret, { mode: 0o600 });
  daemon = await Daemon.start(['--scenes', kept, '--max-scenes', '4', '--max-scene', '20000', '--secret-file', path.join(folder, 'secrets')], {}, { voices: false });
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

/** @returns {Promise<{status: number, code?: string, etag: string|null, text: string, json: any}>} */
async function ask(method, name = '', { body, token = operator, ...headers } = {}) {
  const response = await daemon.get(`/v1/scenes${name && `/${name}`}`, { method, body, headers: { ...(token ? { authorization: `Bearer ${token}` } : {}), ...headers } });
  const text = await response.text();
  const json = text.startsWith('{') ? JSON.parse(text) : null;
  return { status: response.status, etag: response.headers.get('etag'), text, json, code: json?.code, field: json?.field };
}
const put = (name, body, headers) => ask('PUT', name, { body, ...headers });

test('stores, reads, changes, lists and removes a scene', async () => {
  assert.deepEqual((await ask('GET')).json, { scenes: [] });
  const first = await put('pranzo', scene());
  assert.equal(first.status, 201);
  assert.deepEqual(first.json, { type: 'kept', name: 'pranzo', etag: first.etag });
  const read = await ask('GET', 'pranzo');
  assert.deepEqual([read.status, read.text, read.etag], [200, scene(), first.etag]);
  assert.equal((await ask('GET', 'pranzo', { 'if-none-match': first.etag })).status, 304);
  const second = await put('pranzo', scene('Buonasera.'), { 'if-match': first.etag });
  assert.equal(second.status, 200);
  assert.notEqual(second.etag, first.etag);
  const { scenes } = (await ask('GET')).json;
  assert.deepEqual(scenes.map(({ name, bytes }) => [name, bytes]), [['pranzo', scene('Buonasera.').length]]);
  assert.ok(Math.abs(scenes[0].saved - Date.now() / 1000) < 600);
  assert.deepEqual(fs.readdirSync(kept), ['pranzo.json'], 'nothing else stays in the folder');
  assert.equal((await ask('DELETE', 'pranzo', { 'if-match': first.etag })).code, 'changed');
  assert.deepEqual((await ask('DELETE', 'pranzo', { 'if-match': second.etag })).json, { type: 'removed', name: 'pranzo' });
  assert.equal((await ask('GET', 'pranzo')).code, 'unknown-scene');
  assert.equal((await ask('DELETE', 'pranzo')).code, 'unknown-scene');
});

test('of several clients that saw the same version, one saves; the others get a conflict', async () => {
  const { etag } = await put('sera', scene());
  const all = await Promise.all(Array.from({ length: 12 }, (_, i) => put('sera', scene(`Numero ${i}.`), { 'if-match': etag })));
  assert.deepEqual(all.map(({ status }) => status).sort(), [200, ...Array(11).fill(412)]);
  const won = all.findIndex(({ status }) => status === 200);
  const now = await ask('GET', 'sera');
  assert.equal(now.text, scene(`Numero ${won}.`));
  assert.ok(all.filter(({ status }) => status === 412).every(({ code, json }) => code === 'changed' && json.message.includes(now.etag)));
  assert.deepEqual(await put('sera', scene()).then(({ status, code }) => [status, code]), [428, 'condition-needed']);
  assert.equal((await put('sera', scene(), { 'if-none-match': '*' })).status, 412);
  assert.equal((await put('sera', scene(), { 'if-match': '*' })).status, 200);
  assert.equal((await ask('DELETE', 'sera')).status, 428);
  assert.equal((await ask('DELETE', 'sera', { 'if-match': '*' })).status, 200);
});

const line = (more) => JSON.stringify({ lines: [{ id: 'a', text: 'Sì.' }, { id: 'b', text: 'No.', ...more }] });
const wrong = [
  ['', 'bad-json', undefined],
  ['{"lines":[', 'bad-json', undefined],
  ['{"lines":[],"lines":[]}', 'bad-json', undefined],
  [Buffer.from([0x7b, 0xff, 0x7d]), 'bad-json', undefined],
  ['[]', 'bad-field', undefined],
  ['{}', 'missing-field', 'lines'],
  ['{"lines":7}', 'bad-field', 'lines'],
  ['{"title":7,"lines":[]}', 'bad-field', 'title'],
  ['{"lines":[7]}', 'bad-field', 'lines.0.id'],
  [line({ id: 'a' }), 'bad-field', 'lines.1.id'],
  [line({ text: ' ' }), 'bad-field', 'lines.1.text'],
  [line({ next: 'c' }), 'bad-field', 'lines.1.next'],
  [line({ mood: 1 }), 'bad-field', 'lines.1.mood'],
  [line({ variants: ['x', ''] }), 'bad-field', 'lines.1.variants'],
  [line({ choices: Array(9).fill({ text: 'x' }) }), 'bad-field', 'lines.1.choices'],
  [line({ choices: [{ text: 'x', next: 'a' }, { text: 'y', next: 'z' }] }), 'bad-field', 'lines.1.choices.1.next'],
  [JSON.stringify({ lines: Array(501).fill({ id: 'a', text: 'x' }) }), 'bad-field', 'lines'],
  [scene('x'.repeat(20000)), 'document-too-long', undefined],
  [`${'['.repeat(9000)}`, 'bad-json', undefined],
];
test('rejects an invalid scene with its position, and changes nothing', async () => {
  const { etag } = await put('ieri', scene());
  for (const [body, code, field] of wrong) {
    const refused = await put('ieri', body, { 'if-match': etag });
    assert.deepEqual([refused.code, refused.field], [code, field], String(body).slice(0, 80));
    if (code === 'bad-json' && String(body).length < 100) assert.equal(typeof refused.json.byte, 'number');
  }
  assert.equal((await ask('GET', 'ieri')).etag, etag);
  assert.equal((await ask('DELETE', 'ieri', { 'if-match': etag })).status, 200);
});

test('rejects names that lead out of the folder', async () => {
  fs.writeFileSync(path.join(folder, 'outside.json'), scene('Fuori.'));
  for (const name of ['..%2Foutside', '%2e%2e%2foutside', '.hidden', 'caff%C3%A8', 'a%20b', 'x'.repeat(65), 'a%2Fb', '%5c..%5coutside'])
    for (const method of ['GET', 'PUT', 'DELETE']) {
      const answer = await ask(method, name, method === 'PUT' ? { body: scene() } : {});
      assert.deepEqual([answer.status, answer.field], [400, 'name'], `${method} ${name}`);
    }
  assert.deepEqual((await ask('GET')).json, { scenes: [] });
  assert.equal((await ask('PUT')).status, 405);
  assert.equal((await ask('POST')).status, 405);
});

test('limits the number of scenes; reports a folder that cannot be written', async () => {
  for (const name of ['a', 'b', 'c', 'd']) assert.equal((await put(name, scene())).status, 201);
  assert.deepEqual(await put('e', scene()).then(({ status, code }) => [status, code]), [507, 'store-full']);
  assert.equal((await put('d', scene('Altro.'), { 'if-match': '*' })).status, 200);
  fs.renameSync(kept, `${kept}-away`);
  assert.deepEqual(await put('d', scene(), { 'if-match': '*' }).then(({ status, code }) => [status, code]), [500, 'cannot-keep']);
  assert.equal((await ask('GET')).status, 500);
  fs.renameSync(`${kept}-away`, kept);
  for (const name of ['a', 'b', 'c', 'd']) assert.equal((await ask('DELETE', name, { 'if-match': '*' })).status, 200);
});

test('rights: operators change scenes, speakers read them, others do neither', async () => {
  await put('turno', scene());
  const who = (claims) => sign({ secret, claims });
  const rights = async (token) => [
    await ask('GET', '', { token }), await ask('GET', 'turno', { token }), await put('nuovo', scene(), { token }), await ask('DELETE', 'turno', { token, 'if-match': '"x"' }),
  ].map(({ status }) => status);
  assert.deepEqual(await rights(null), [401, 401, 401, 401]);
  assert.deepEqual(await rights(who({ rights: 'listen' })), [403, 403, 403, 403]);
  assert.deepEqual(await rights(who({ rights: 'listen speak' })), [200, 200, 403, 403]);
  assert.deepEqual(await rights(who({ rights: 'listen speak', room: 'kitchen' })), [200, 200, 403, 403]);
  assert.deepEqual(await rights(who({ rights: 'listen speak operate', room: 'kitchen' })), [200, 200, 201, 412]);
  assert.equal((await put('turno', scene(), { 'if-match': '*', origin: 'https://elsewhere.example' })).code, 'forbidden-origin');
});

test('a client that disconnects inside a body leaves the old version unchanged', async () => {
  const before = await ask('GET', 'turno');
  for (const part of ['', scene().slice(0, 9)]) {
    const socket = net.connect(daemon.port, '127.0.0.1');
    socket.on('error', () => {});
    await new Promise((resolve) => socket.on('connect', resolve));
    socket.end(`PUT /v1/scenes/turno HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer ${operator}\r\nIf-Match: *\r\nContent-Length: ${scene().length}\r\n\r\n${part}`);
    await new Promise((resolve) => socket.resume().on('close', resolve));
  }
  const after = await ask('GET', 'turno');
  assert.deepEqual([after.etag, after.text], [before.etag, before.text]);
  // disconnects while the disk is busy
  const socket = net.connect(daemon.port, '127.0.0.1');
  await new Promise((resolve) => socket.on('connect', resolve));
  socket.write(`PUT /v1/scenes/turno HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer ${operator}\r\nIf-Match: *\r\nContent-Length: ${scene('Via.').length}\r\n\r\n${scene('Via.')}`, () => socket.destroy());
  await eventually(async () => [scene(), scene('Via.')].includes((await ask('GET', 'turno')).text));
});
