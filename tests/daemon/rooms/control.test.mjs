// SPDX-License-Identifier: GPL-3.0-or-later
// Controlling speech: stop, pause, rate, jumps, and the order of utterances. The puppet voice speaks 10 ms per byte.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, framesOf } from '../../lib/daemon.mjs';
import { violations } from '../../lib/schema.mjs';

let daemon, puppet;
before(async () => {
  daemon = await Daemon.start();
  puppet = await Daemon.start(['--plugins', path.join(build, 'tests/plugins'), '--deadline-base', '3', '--max-queue', '100']);
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  assert.deepEqual(await puppet.stop(), { code: 0, signal: null });
});

const RATE = 16000;
const about = (stream, id, type) => stream.messages.filter((m) => m.id === id && (!type || m.type === type));
const words = (stream, id) => about(stream, id, 'word').map((m) => m.text);
const ends = (stream) => stream.messages.filter((m) => m.type === 'end').map((m) => `${m.id} ${m.reason}`);
const valid = (stream) => {
  for (const { arrived, ...message } of stream.messages) assert.equal(violations('server', message), null, `${arrived} ${JSON.stringify(message)}`);
};

/** Checks that the utterance's chunks are contiguous in samples and frames. */
function checkClock(stream, utterance) {
  const chunks = stream.chunks.filter((c) => c.utterance === utterance);
  let at = 0, frame = 0;
  for (const chunk of chunks) {
    assert.equal(chunk.start, at);
    assert.equal(chunk.firstFrame, frame);
    at += chunk.samples;
    frame += chunk.frames.length;
  }
  return at;
}

const open = async (query = '') => {
  const stream = await puppet.stream(query);
  stream.speak = (id, text, more = {}) => stream.send({ type: 'speak', id, voice: 'puppet:plain', text, ...more });
  return stream;
};
/** A sentence of three seconds, far longer than the lead of sent media. */
const sentence = (name) => `Questa frase si chiama ${name} e dura ${'molto '.repeat(43)}poco.`;

test('replace drops all speech, interrupt cuts one utterance, queue waits', async () => {
  const stream = await open();
  for (const id of ['a', 'b', 'c']) stream.speak(id, sentence(id));
  await stream.wait({ type: 'word', id: 'a' });
  stream.speak('i', sentence('i'), { mode: 'interrupt' });
  await stream.wait({ type: 'word', id: 'i' });
  stream.speak('j', 'Ecco.', { mode: 'interrupt' });
  await stream.wait({ type: 'word', id: 'b' });
  stream.speak('r', 'Basta.', { mode: 'replace' });
  stream.speak('q', 'Fine.', { mode: 'queue' });
  await stream.wait({ type: 'end', id: 'q' });
  assert.deepEqual(ends(stream), ['a stopped', 'i stopped', 'j done', 'b stopped', 'c stopped', 'r done', 'q done']);
  const begun = stream.messages.filter((m) => m.type === 'begin').map((m) => m.id);
  assert.deepEqual(begun, ['a', 'i', 'j', 'b', 'r', 'q']);
  for (let utterance = 1; utterance <= 7; utterance++) checkClock(stream, utterance);
  valid(stream);
  await stream.close();
});

test('a failing interruption interrupts nothing; an unknown mode is refused', async () => {
  const stream = await open();
  stream.speak('a', sentence('a'));
  stream.speak('x', '', { mode: 'interrupt' });
  stream.speak('y', 'Sì.', { mode: 'replace', lang: 'xx' });
  stream.speak('z', 'Sì.', { mode: 'sometimes' });
  stream.speak('z', 'Sì.', { mode: 5 });
  await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  assert.deepEqual(about(stream, 'z', 'error').map((m) => m.field), ['mode', 'mode']);
  assert.equal(ends(stream).filter((end) => end.endsWith('failed')).length, 4);
  await stream.close();
});

test('stops before the synthesis, between sentences, inside a word, and everything queued', async () => {
  const stream = await open();
  // the voice hangs on this sentence: it speaks again only if its worker was cancelled
  stream.speak('before', 'hang.');
  stream.speak('waits', sentence('due'));
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'waits', reason: 'stopped' });
  stream.speak('between', `Una. Due. ${sentence('tre')}`);
  await stream.wait((m) => m.id === 'between' && m.type === 'sentence' && m.start > 0);
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'between', reason: 'stopped' });
  stream.speak('inside', `Precipitevolissimevolmente${'e'.repeat(200)} fine.`);
  await stream.wait({ type: 'word', id: 'inside' });
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'inside', reason: 'stopped' });
  assert.deepEqual(words(stream, 'inside').length, 1);
  const count = stream.chunks.length;
  stream.speak('after', 'Sì.');
  await stream.wait({ type: 'end', id: 'after', reason: 'done' });
  const later = stream.chunks.slice(count).map((c) => c.utterance);
  assert.ok(later.length && later.every((n) => n === 5), 'no media of what was stopped');
  stream.send({ type: 'stop' }); // nothing is being spoken
  stream.send({ type: 'ping', id: 1 });
  await stream.wait({ type: 'pong' });
  valid(stream);
  await stream.close();
});

test('2000 pairs of speak and stop leak nothing', async () => {
  const stream = await open();
  const memory = () => Number(fs.readFileSync(`/proc/${puppet.process.pid}/statm`, 'utf8').split(' ')[1]);
  let early;
  for (let i = 0; i < 2000; i++) {
    stream.speak(`n${i}`, i % 3 ? sentence(i) : 'Sì.', i % 5 ? {} : { mode: 'replace' });
    stream.send({ type: 'stop' });
    if (i % 100 === 99) await stream.wait({ type: 'end', id: `n${i}` });
    if (i === 999) early = memory();
  }
  stream.speak('last', 'Ancora qui.');
  await stream.wait({ type: 'end', id: 'last', reason: 'done' });
  assert.equal(ends(stream).length, 2001);
  assert.equal(new Set(ends(stream)).size, 2001);
  assert.ok(memory() - early < 2048, `${memory() - early} pages more`); // 8 MiB of pages
  assert.deepEqual(words(stream, 'last'), ['Ancora', 'qui.']);
  await stream.close();
});

test('a pause stops the clock; later speech follows to the sample', async () => {
  const stream = await open();
  stream.send({ type: 'idle', on: true, seed: 1 });
  stream.speak('a', sentence('uno').repeat(2));
  await stream.wait({ type: 'word', id: 'a' });
  stream.send({ type: 'pause' });
  stream.send({ type: 'pause' });
  const paused = await stream.wait({ type: 'paused', id: 'a' });
  const at = stream.chunks.length;
  const sent = stream.chunks.filter((c) => c.utterance === 1).reduce((sum, c) => sum + c.samples, 0);
  assert.ok(paused.sample <= sent && paused.sample >= sent - 0.5 * RATE, `${paused.sample} of ${sent}`);
  assert.equal(paused.time, Math.round((paused.sample / RATE) * 1e6) / 1e6);
  // idle media continue; nothing is spoken
  await stream.until(() => stream.chunks.length >= at + 12);
  assert.ok(stream.chunks.slice(at).every((c) => c.utterance === 0));
  stream.send({ type: 'resume' });
  stream.send({ type: 'resume' });
  const resumed = await stream.wait({ type: 'resumed' });
  assert.equal(resumed.sample, paused.sample);
  assert.ok(resumed.idle > 0);
  const end = await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  assert.equal(checkClock(stream, 1), Math.round(end.duration * RATE));
  assert.equal(stream.messages.filter((m) => ['paused', 'resumed'].includes(m.type)).length, 2);
  valid(stream);
  await stream.close();
});

test('numbers Opus packets continuously through a pause with an idling face', async () => {
  const stream = await daemon.stream('?audio=opus&fap=fapc');
  stream.send({ type: 'idle', on: true });
  stream.send({ type: 'speak', text: sentence('uno'), lang: 'it' });
  await stream.wait({ type: 'word' });
  stream.send({ type: 'pause' });
  await stream.wait({ type: 'paused' });
  const at = stream.chunks.length;
  await stream.until(() => stream.chunks.slice(at).some((c) => c.utterance === 0));
  stream.send({ type: 'resume' });
  await stream.wait({ type: 'end', reason: 'done' });
  const spoken = stream.chunks.filter((c) => c.utterance === 1 && c.audio?.length);
  assert.deepEqual(spoken.slice(1).map((c) => c.firstPacket), spoken.slice(0, -1).map((c) => c.firstPacket + c.audio.length));
  await stream.close();
});

test('speech requested during a pause waits; stop, replace and interrupt end the pause', async () => {
  const stream = await open();
  stream.send({ type: 'pause' });
  assert.equal((await stream.wait({ type: 'paused' })).utterance, undefined);
  stream.speak('a', 'Sì.');
  for (let i = 0; i < 3; i++) {
    stream.send({ type: 'ping', id: i });
    await stream.wait({ type: 'pong', id: i });
  }
  stream.speak('b', 'No.', { mode: 'interrupt' });
  await stream.wait({ type: 'resumed' });
  await stream.wait({ type: 'end', id: 'b', reason: 'done' });
  assert.deepEqual(ends(stream), ['a stopped', 'b done']);
  assert.equal(about(stream, 'a', 'begin').length, 0);
  for (const lift of [() => stream.send({ type: 'stop' }), () => stream.speak('r', 'Forse.', { mode: 'replace' })]) {
    const from = stream.messages.length;
    stream.send({ type: 'pause' });
    stream.speak('w', 'Aspetta.');
    lift();
    await stream.wait({ type: 'resumed' }, { from });
    await stream.wait({ type: 'end', id: 'w', reason: 'stopped' }, { from });
  }
  await stream.wait({ type: 'end', id: 'r', reason: 'done' });
  valid(stream);
  await stream.close();
});

const document = (...parts) => `<speak>${parts.join(' ')}</speak>`;
const marked = document(
  `Comincia ${'qui '.repeat(40)}. <mark name="due"/> La seconda frase viene.`, `Nella terza sta <mark name="tre"/> il segno ${'tre '.repeat(20)}.`,
  `Poi ${'ancora '.repeat(10)}basta.`,
);

for (const [name, mark, expected] of [['forwards', 'tre', 'il'], ['backwards', 'due', 'La']])
  test(`jumps ${name}, to the exact mark`, async () => {
    const stream = await open();
    stream.speak('a', marked, { markup: 'ssml' });
    await stream.wait({ type: 'word', id: 'a', text: name === 'forwards' ? 'Comincia' : 'terza' });
    const from = stream.messages.length;
    stream.send({ type: 'jump', mark });
    const jumped = await stream.wait({ type: 'jumped', mark, id: 'a' });
    const told = await stream.wait({ type: 'mark', name: mark }, { from });
    assert.equal(told.sample, jumped.sample, 'the mark is where the jump went');
    await stream.wait({ type: 'end', id: 'a', reason: 'done' });
    const afterwards = stream.messages.slice(stream.messages.findIndex((m) => m.type === 'jumped'));
    assert.equal(afterwards.find((m) => m.type === 'word').text, expected);
    assert.equal(afterwards.filter((m) => m.type === 'word').at(-1).text, 'basta.');
    const times = afterwards.filter((m) => m.sample !== undefined && m.type !== 'mark').map((m) => m.sample);
    assert.deepEqual(times, [...times].sort((a, b) => a - b));
    checkClock(stream, 1);
    assert.ok(stream.chunks.some((c) => c.start === jumped.sample), 'new media begin there');
    valid(stream);
    await stream.close();
  });

test('jumps in a pause, before the beginning, and repeatedly', async () => {
  const stream = await open();
  stream.send({ type: 'jump', mark: 'due' });
  await stream.wait({ type: 'error', code: 'not-speaking' });
  stream.send({ type: 'pause' });
  stream.speak('a', marked, { markup: 'ssml' });
  stream.send({ type: 'jump', mark: 'tre' });
  assert.equal((await stream.wait({ type: 'jumped', mark: 'tre' })).sample, 0);
  stream.send({ type: 'resume' });
  await stream.wait({ type: 'word', id: 'a' });
  assert.deepEqual(words(stream, 'a')[0], 'il');
  stream.send({ type: 'jump', mark: 'quattro' });
  await stream.wait({ type: 'error', code: 'unknown-mark', field: 'mark' });
  stream.send({ type: 'jump' });
  await stream.wait({ type: 'error', code: 'missing-field', field: 'mark' });
  stream.send({ type: 'pause' });
  await stream.wait({ type: 'paused', id: 'a' });
  stream.send({ type: 'jump', mark: 'due' });
  const jumped = await stream.wait({ type: 'jumped', mark: 'due' });
  const count = stream.chunks.length;
  stream.send({ type: 'resume' });
  const resumed = await stream.wait({ type: 'resumed', id: 'a' });
  assert.equal(resumed.sample, jumped.sample);
  assert.equal(stream.chunks.filter((chunk) => chunk.arrived < resumed.arrived).length, count, 'nothing moves in a pause');
  for (let i = 0; i < 50; i++) stream.send({ type: 'jump', mark: i % 2 ? 'due' : 'tre' });
  await stream.until(() => stream.messages.filter((m) => m.type === 'jumped').length === 52);
  await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  checkClock(stream, 1);
  assert.equal(words(stream, 'a').at(-1), 'basta.');
  valid(stream);
  await stream.close();
});

test('a new rate applies from the next sentence, and to queued speech', async () => {
  const stream = await daemon.stream();
  const text = 'Questa è la prima frase, e non è corta. Detta adagio. Detta adagio.';
  const durations = (id) => about(stream, id, 'sentence').map((m) => m.duration);
  stream.send({ type: 'speak', id: 'plain', lang: 'it', rate: 300, text });
  await stream.wait({ type: 'end', id: 'plain' });
  stream.send({ type: 'speak', id: 'slower', lang: 'it', rate: 300, text });
  stream.send({ type: 'speak', id: 'next', lang: 'it', rate: 300, text });
  await stream.wait({ type: 'word', id: 'slower' });
  stream.send({ type: 'rate', rate: 150 });
  await stream.wait({ type: 'end', id: 'next' });
  const [before, after] = [durations('plain'), durations('slower')];
  assert.equal(after[0], before[0], 'what has begun goes on as it was');
  assert.ok(after[1] > 1.5 * before[1] && after[2] > 1.5 * before[2], `${before}; ${after}`);
  assert.ok(durations('next')[0] > 1.5 * before[0]);
  for (const rate of [0, '150', 501, undefined]) {
    stream.send({ type: 'rate', rate });
    await stream.wait({ type: 'error', field: 'rate' }, { from: stream.messages.length });
  }
  for (const n of [1, 2, 3]) checkClock(stream, n);
  valid(stream);
  await stream.close();
});

test('requested phones cover the speech', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'a', lang: 'it', text: 'La mamma.' });
  await stream.wait({ type: 'end', id: 'a' });
  assert.equal(about(stream, 'a', 'phone').length, 0);
  stream.send({ type: 'speak', id: 'b', lang: 'it', text: 'La mamma.', phones: true });
  const end = await stream.wait({ type: 'end', id: 'b' });
  const phones = about(stream, 'b', 'phone');
  let at = 0;
  for (const phone of phones) {
    assert.ok(Math.abs(phone.time - at) < 1e-4, JSON.stringify(phone));
    at = phone.time + phone.duration;
  }
  assert.ok(Math.abs(at - end.duration) < 1e-3);
  assert.equal(phones.map((p) => p.ipa).join('').replaceAll('mm', 'm').replaceAll('mː', 'm'), 'lamama');
  valid(stream);
  await stream.close();
});

test('a worker that dies mid-sentence costs that sentence', async () => {
  const stream = await open();
  stream.speak('a', `${sentence('uno')}\n\ncrash adesso.\n\n${sentence('tre')}`);
  await stream.wait({ type: 'error', id: 'a', code: 'voice-crashed' });
  await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  assert.deepEqual(words(stream, 'a').filter((word) => word === 'Questa').length, 2);
  checkClock(stream, 1);
  await stream.close();
});

test('in a room everyone hears it; controlling needs the right to speak', async () => {
  const [a, b] = [await open('?room=control'), await open('?room=control')];
  a.speak('a', marked, { markup: 'ssml' });
  await b.wait({ type: 'word', id: 'a' });
  b.send({ type: 'pause' });
  await a.wait({ type: 'paused', id: 'a' });
  const late = await open('?room=control');
  await late.wait({ type: 'paused', id: 'a' });
  a.send({ type: 'jump', mark: 'tre' });
  await b.wait({ type: 'jumped', mark: 'tre' });
  assert.equal((await puppet.get('/v1/rooms/control/commands', { method: 'POST', body: '{"type":"resume"}' })).status, 200);
  for (const stream of [a, b, late]) {
    await stream.wait({ type: 'resumed' });
    await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  }
  assert.deepEqual(framesOf(a.chunks), framesOf(b.chunks));
  for (const stream of [a, b, late]) await stream.close();
});
