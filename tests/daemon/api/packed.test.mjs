// SPDX-License-Identifier: GPL-3.0-or-later
// Packed events inside media chunks: the same as text events, in a tenth of the bytes.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const text = '<speak>La città è più bella <mark name="qui &quot;"/>di sera. Il bambino guarda fuori, e vede passare un 🐈 gatto.</speak>';
const speak = { type: 'speak', id: 's', lang: 'it', markup: 'ssml', text, phones: true };
const PACKED = 'audio=opus&fap=fapc&events=packed';
const INSIDE = ['sentence', 'word', 'mark', 'phone'];

/** The members that both forms have in common. */
const essence = ({ packed: _, arrived: _a, stream: _s, id: _i, ...message }) => message;
const inside = (stream) => stream.messages.filter(({ type }) => INSIDE.includes(type));

test('packed events equal the text events, in the chunks in which they begin', async () => {
  const packed = await daemon.stream(`?room=both&${PACKED}`);
  const plain = await daemon.stream('?room=both&audio=opus&fap=fapc');
  packed.send(speak);
  for (const stream of [packed, plain]) await stream.wait({ type: 'end', id: 's', reason: 'done' });
  assert.ok(inside(plain).length > 50);
  assert.ok(inside(packed).every((event) => event.packed));
  assert.ok(!plain.messages.some((event) => event.packed));
  assert.deepEqual(inside(packed).map(essence), inside(plain).map(essence));
  for (const { start, samples, events } of packed.chunks)
    for (const { sample, type } of events) assert.ok(sample < start + samples, `a ${type} before its time`);
  for (const type of ['begin', 'end']) assert.ok(packed.messages.some((m) => m.type === type && !m.packed && m.stream === 'both'));
  await Promise.all([packed.close(), plain.close()]);
});

test('a late joiner gets earlier events as text, and later ones in chunks', async () => {
  const first = await daemon.stream(`?room=late&${PACKED}`);
  first.send(speak);
  await first.until(() => first.messages.filter(({ type }) => type === 'word').length > 3);
  const late = await daemon.stream(`?room=late&${PACKED}`);
  for (const stream of [first, late]) await stream.wait({ type: 'end', id: 's', reason: 'done' });
  const of = (stream, type) => stream.messages.filter((m) => m.type === type).map(essence);
  assert.deepEqual(of(late, 'word'), of(first, 'word').slice(-of(late, 'word').length));
  assert.ok(of(late, 'word').length > 3 && of(late, 'sentence').length > 0);
  const forms = late.messages.filter(({ type }) => type === 'word').map(({ packed }) => packed ?? false);
  assert.ok(!forms[0] && forms.at(-1));
  assert.deepEqual(forms, [...forms].sort());
  await Promise.all([first.close(), late.close()]);
});

test('without compact chunks, sends events as text; a client can change the form', async () => {
  const stream = await daemon.stream('?audio=pcm&fap=plain&events=packed');
  const say = async (id) => {
    const from = stream.messages.length;
    stream.send({ type: 'speak', id, lang: 'it', text: 'Ecco qua.' });
    await stream.wait({ type: 'end', id, reason: 'done' }, { from });
    return stream.messages.slice(from).filter(({ type }) => type === 'word').map(({ packed }) => packed ?? false);
  };
  assert.deepEqual(await say('plain'), [false, false]);
  stream.send({ type: 'media', fap: 'fapc' });
  assert.deepEqual(await say('compact'), [true, true]);
  stream.send({ type: 'media', events: 'text' });
  assert.deepEqual(await say('text'), [false, false]);
  stream.send({ type: 'media', events: 'knots' });
  await stream.wait({ type: 'error', code: 'unknown-codec', field: 'events' });
  stream.send({ type: 'media', audio: 'none', fap: 'none', events: 'packed' });
  assert.deepEqual(await say('none'), [false, false]);
  await stream.close();
});

test('hello names both forms', async () => {
  const stream = await daemon.stream();
  assert.deepEqual((await stream.wait({ type: 'hello' })).events, ['text', 'packed']);
  await stream.close();
});
