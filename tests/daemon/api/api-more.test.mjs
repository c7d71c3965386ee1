// SPDX-License-Identifier: GPL-3.0-or-later
// Speech by GET and by JSON, unknown members and suggestions for them, and speech to empty rooms.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const json = (body, headers = {}) => ({ method: 'POST', body: typeof body === 'string' ? body : JSON.stringify(body), headers: { 'content-type': 'application/json', ...headers } });
const plain = (body) => ({ method: 'POST', body, headers: { 'content-type': 'text/plain' } });
const asked = async (address, options, from = daemon) => {
  const response = await from.get(address, options);
  return { status: response.status, ...(await response.json()) };
};
const bytes = async (address, options) => Buffer.from(await (await daemon.get(address, options)).arrayBuffer());

test('GET, POST of text and POST of JSON speak the same', async () => {
  const text = 'Città & paese: è già perché?';
  const posted = await bytes('/v1/speech?lang=it&rate=200&seed=3&format=wav', plain(text));
  assert.ok(posted.length > 20000);
  assert.deepEqual(await bytes(`/v1/speech?lang=it&rate=200&seed=3&text=${encodeURIComponent(text)}`), posted);
  assert.deepEqual(await bytes('/v1/speech', json({ text, lang: 'it', rate: 200, seed: 3 })), posted);
  // members of the body override the query; the content type may name a charset
  assert.deepEqual(await bytes('/v1/speech?lang=tr&rate=100', json({ text, lang: 'it', rate: 200, seed: 3 }, { 'content-type': 'application/json; charset=utf-8' })), posted);
  // markup is detected or stated in every form
  const marked = '<speak xml:lang="it">Uno <mark name="m"/>due.</speak>';
  for (const answer of [
    await asked(`/v1/speech?format=json&text=${encodeURIComponent(marked)}`),
    await asked('/v1/speech', json({ format: 'json', text: marked })),
    await asked('/v1/speech', json({ format: 'json', text: marked, markup: 'ssml' })),
  ])
    assert.deepEqual([answer.status, answer.marks?.[0].name], [200, 'm']);
  assert.equal((await asked('/v1/speech', json({ format: 'json', text: marked, markup: 'plain' }))).marks.length, 0);
});

test('removes arrows from the cues of WebVTT', async () => {
  for (const text of ['<speak xml:lang="it">Uno --> due &amp; tre.</speak>', 'Uno --> due & tre.']) {
    const cues = (await bytes(`/v1/speech?format=vtt&lang=it&text=${encodeURIComponent(text)}`)).toString().split('\n').filter((line) => /[a-z]/.test(line));
    assert.match(cues.join(' ').replace(/<[\d:.]+>/g, ''), /^Uno --&gt; due &amp; tre\.$/);
  }
});

const wrong = [
  ['GET without a text', '/v1/speech?lang=it', undefined, { status: 400, code: 'missing-field', field: 'text' }],
  ['GET with an empty text', '/v1/speech?text=', undefined, { status: 400, code: 'empty-text' }],
  ['JSON without a text', '/v1/speech', json({ lang: 'it' }), { status: 400, code: 'missing-field', field: 'text' }],
  ['JSON with a text that is none', '/v1/speech', json({ text: 7 }), { status: 400, code: 'bad-field', field: 'text' }],
  ['JSON with a rate that is none', '/v1/speech', json({ text: 'a', rate: '200' }), { status: 400, code: 'bad-field', field: 'rate' }],
  ['JSON with a format that is none', '/v1/speech', json({ text: 'a', format: 7 }), { status: 400, code: 'bad-field', field: 'format' }],
  ['JSON that is cut', '/v1/speech', json('{"text":'), { status: 400, code: 'bad-json', byte: 8 }],
  ['an empty body', '/v1/speech', json(''), { status: 400, code: 'bad-json' }],
  ['JSON that is a list', '/v1/speech', json([]), { status: 400, code: 'bad-message' }],
  ['JSON in a room that cannot be', '/v1/say?room=no%20spaces', json({ text: 'a' }), { status: 400, code: 'bad-field', field: 'room' }],
  ['JSON without a room', '/v1/say', json({ text: 'a' }), { status: 400, code: 'missing-field', field: 'room' }],
  ['a type that there is not', '/v1/speech', { method: 'POST', body: 'a', headers: { 'content-type': 'application/jsonp' } }, { status: 415, code: 'unsupported-media-type' }],
];
for (const [what, address, options, pattern] of wrong)
  test(`rejects ${what}: ${pattern.code}`, async () => {
    const answer = await asked(address, options);
    for (const [key, value] of Object.entries(pattern)) assert.equal(answer[key], value, JSON.stringify(answer));
  });

test('answers 413 to a JSON body over the limit, and to its text', async () => {
  const own = await Daemon.start(['--max-text', '100', '--max-message', '300']);
  assert.deepEqual((({ status, code }) => [status, code])(await asked('/v1/speech', json({ text: 'a'.repeat(400) }), own)), [413, 'message-too-long']);
  assert.deepEqual((({ status, code, field }) => [status, code, field])(await asked('/v1/speech', json({ text: 'a'.repeat(150) }), own)), [413, 'text-too-long', 'text']);
  assert.equal((await asked(`/v1/speech?text=${'a'.repeat(150)}`, undefined, own)).status, 413);
  assert.equal((await own.stop()).code, 0);
});

const unknown = { code: 'unknown-member', field: 'rat' };
const has = (warnings, wanted) => {
  const found = warnings?.find((w) => w.code === wanted.code && (w.field === wanted.field || w.message.startsWith(`${wanted.field}: `)));
  assert.ok(found, JSON.stringify(warnings));
  return found;
};
const headerOf = (response) => JSON.parse(`[${response.headers.get('faccia-warning')}]`);

test('unknown members cause a warning in every format', async () => {
  const query = 'lang=it&rat=200&text=Ciao';
  const timing = await asked(`/v1/speech?${query}&format=json`);
  assert.match(has(timing.warnings, unknown).message, /no member 'rat'; near: rate/);
  const lines = String(await bytes(`/v1/speech?${query}&format=ndjson`)).trim().split('\n').map(JSON.parse);
  has(lines.filter((line) => line.type === 'warning'), unknown);
  for (const format of ['wav', 'ogg', 'fap', 'fapc']) {
    const response = await daemon.get(`/v1/speech?${query}&format=${format}`);
    assert.equal(response.status, 200);
    has(headerOf(response), unknown);
    assert.ok((await response.arrayBuffer()).byteLength > 100);
  }
  const read = await daemon.get(`/v1/speech?${query}`, { headers: { origin: 'http://localhost:5173' } });
  assert.equal(read.headers.get('access-control-expose-headers'), 'etag, faccia-warning');
  await read.arrayBuffer();
  // known parameters cause no warning, and then the warning header is absent
  const clean = await daemon.get('/v1/speech?lang=it&format=wav&seed=1&life=1&text=Ciao');
  assert.equal(clean.headers.get('faccia-warning'), null);
  await clean.arrayBuffer();
  const said = await asked('/v1/speech?format=json', json({ text: 'Ciao', lang: 'it', speeed: 1, Voice: 'x' }));
  has(said.warnings, { code: 'unknown-member', field: 'speeed' });
  assert.match(has(said.warnings, { code: 'unknown-member', field: 'Voice' }).message, /near: voice/);
  // other JSON responses, and errors
  has((await asked('/v1/voices?rat=1')).warnings, unknown);
  assert.equal('warnings' in (await asked('/v1/voices')), false);
  const refused = await daemon.get('/v1/speech?rat=1&lang=xx&text=Ciao');
  assert.equal(refused.status, 400);
  has(headerOf(refused), unknown);
  await refused.arrayBuffer();
});

test('the warning header escapes any content, and is bounded', async () => {
  const names = ['città', 'a"b\\c', 'x\r\nset-cookie: y', ...Array.from({ length: 50 }, (_, i) => `n${i}`)];
  const response = await daemon.get(`/v1/voices?${names.map((name) => `${encodeURIComponent(name)}=1`).join('&')}`);
  assert.equal(response.status, 200);
  assert.equal(response.headers.get('set-cookie'), null);
  const warnings = headerOf(response);
  assert.ok(warnings.length >= 3 && warnings.length <= 10, `${warnings.length}`);
  assert.equal(warnings[0].field, 'città');
  await response.arrayBuffer();
});

test('warns of unknown parameters in the address of a WebSocket', async () => {
  const stream = await daemon.stream('?lang=it&rom=hall&token=x&volume=2');
  const { message } = await stream.wait({ type: 'warning', code: 'unknown-member', field: 'rom' });
  assert.match(message, /near: room/);
  stream.send({ type: 'ping', id: 1 });
  await stream.wait({ type: 'pong' });
  assert.equal(stream.messages.filter((m) => m.type === 'warning').length, 1);
  await stream.close();
});

test('suggests a similar name for an unknown one', async () => {
  const stream = await daemon.stream();
  const cases = [
    [{ type: 'speek' }, /near: speak/],
    [{ type: 'speak', text: 'a', voice: 'espeak:itt' }, /near: espeak:it\b/],
    [{ type: 'speak', text: 'a', lang: 'Italain' }, /near: it/],
    [{ type: 'speak', text: 'a', engine: 'dominence' }, /near: dominance/],
    [{ type: 'speak', text: 'a', markup: 'smml' }, /near: ssml/],
    [{ type: 'media', audio: 'opsu' }, /near: opus/],
    [{ type: 'media', fap: 'fapcc' }, /near: fapc/],
    [{ type: 'model', name: 'marra' }, /near: mara/],
    [{ type: 'express', mix: [{ name: 'jyo' }] }, /near: joy/],
  ];
  for (const [message, pattern] of cases) {
    const from = stream.messages.length;
    stream.send(message);
    assert.match((await stream.wait({ type: 'error' }, { from })).message, pattern);
  }
  stream.send({ type: 'speak', id: 'jump', lang: 'it', markup: 'ssml', text: `<speak>Uno <mark name="inizio"/> ${'e poi due '.repeat(50)}.</speak>` });
  await stream.wait({ type: 'word', id: 'jump' });
  stream.send({ type: 'jump', mark: 'inzio' });
  assert.match((await stream.wait({ type: 'error', code: 'unknown-mark' })).message, /near: inizio/);
  stream.send({ type: 'stop' });
  stream.send({ type: 'speak', id: 'mood', lang: 'it', markup: 'ssml', text: '<speak><emotion><category name="hapiness"/>Ciao.</emotion></speak>' });
  const warning = await stream.wait((m) => m.type === 'warning' && m.id === 'mood');
  assert.match(warning.message, /near: /);
  // no suggestion for a name unlike any other
  const from = stream.messages.length;
  stream.send({ type: 'speak', text: 'a', voice: 'zzzzzzzzzz' });
  assert.doesNotMatch((await stream.wait({ type: 'error' }, { from })).message, /near/);
  await stream.close();
  assert.match((await asked('/v1/speech?format=waw&text=a')).message, /near: wav/);
});

test('say reports the number of listeners; without any, the request is accepted and dropped', async () => {
  const nobody = await asked('/v1/say?room=empty&lang=it', plain('Buongiorno.'));
  assert.deepEqual(nobody, { status: 202, type: 'accepted', room: 'empty', listeners: 0 });
  const [one, two] = [await daemon.stream('?room=hall'), await daemon.stream('?room=hall')];
  await Promise.all([one.wait({ type: 'joined' }), two.wait({ type: 'joined' })]);
  assert.equal((await asked('/v1/say?room=hall&lang=it', json({ text: 'Buongiorno.', id: 'j' }))).listeners, 2);
  for (const stream of [one, two]) await stream.wait({ type: 'end', id: 'j', reason: 'done' });
  // the refused speech was not held
  const late = await daemon.stream('?room=empty');
  await late.wait({ type: 'joined' });
  late.send({ type: 'ping', id: 1 });
  await late.wait({ type: 'pong' });
  assert.ok(!late.messages.some((m) => m.type === 'begin'));
  // errors are reported with and without listeners
  assert.equal((await asked('/v1/say?room=empty&rate=3', plain('a'))).code, 'bad-field');
  await Promise.all([one, two, late].map((stream) => stream.close()));
});

test('--hold keeps speech for late listeners, in order and for a limited time', async () => {
  const own = await Daemon.start(['--hold', '60', '--max-queue', '3']);
  const say = (room, text, id) => asked(`/v1/say?room=${room}&lang=it&id=${id}`, plain(text), own);
  assert.deepEqual(await say('hall', 'Uno.', 'a'), { status: 202, type: 'accepted', room: 'hall', listeners: 0, held: 60 });
  await say('other', 'Altrove.', 'x');
  await say('hall', 'Due.', 'b');
  await say('hall', 'Tre.', 'c');
  const full = await say('hall', 'Quattro.', 'd');
  assert.deepEqual([full.status, full.code], [503, 'queue-full']);
  const stream = await own.stream('?room=hall');
  await stream.wait({ type: 'end', id: 'c', reason: 'done' });
  assert.deepEqual(stream.messages.filter((m) => m.type === 'begin').map((m) => m.id), ['a', 'b', 'c']);
  assert.deepEqual(await say('hall', 'Ora sì.', 'e'), { status: 202, type: 'accepted', room: 'hall', listeners: 1 });
  await stream.wait({ type: 'end', id: 'e', reason: 'done' });
  await stream.close();
  // held speech is spoken only once
  const again = await own.stream('?room=hall');
  await again.wait({ type: 'joined' });
  again.send({ type: 'ping', id: 1 });
  await again.wait({ type: 'pong' });
  assert.ok(!again.messages.some((m) => m.type === 'begin'));
  // limit of held speech in all rooms: 100
  let statuses = [];
  for (let i = 0; i < 110; i++) statuses.push((await say(`r${i}`, 'Sì.', 'z')).status);
  assert.equal(statuses.filter((s) => s === 202).length, 99);
  assert.equal((await own.stop()).code, 0);
});

test('drops speech that was held too long', async () => {
  const own = await Daemon.start(['--hold', '1']);
  assert.equal((await asked('/v1/say?room=hall&lang=it', plain('Presto!'), own)).held, 1);
  await new Promise((resolve) => setTimeout(resolve, 1100)); // the hold time under test
  const stream = await own.stream('?room=hall');
  await stream.wait({ type: 'joined' });
  stream.send({ type: 'ping', id: 1 });
  await stream.wait({ type: 'pong' });
  assert.ok(!stream.messages.some((m) => m.type === 'begin'));
  assert.equal((await own.stop()).code, 0);
});
