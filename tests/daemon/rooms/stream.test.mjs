// SPDX-License-Identifier: GPL-3.0-or-later
// Streams: order, clocks, offsets, pacing, stop and queue.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon, framesOf } from '../../lib/daemon.mjs';

const OPEN_JAW = 3;
let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

/** Speaks and returns all messages of the utterance. */
async function speak(request) {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', ...request });
  const end = await stream.wait({ type: 'end' });
  await stream.close();
  return { ...stream, end };
}

test('sends hello first, with the offer', async () => {
  const stream = await daemon.stream();
  const hello = await stream.wait({ type: 'hello' });
  assert.equal(stream.messages[0], hello);
  assert.deepEqual(hello.languages.map((l) => l.tag).sort(), ['cmn', 'en', 'it', 'pt-BR', 'tr', 'yue']);
  assert.deepEqual(hello.engines, ['dominance', 'cohen-massaro', 'context', 'syllable', 'table']);
  assert.equal(hello.limits.text_bytes, 100000);
  await stream.close();
});

test('chunks follow each other without a gap and hold the frames of their interval', async () => {
  const { chunks, messages, end } = await speak({ text: 'La mamma parla piano. Poi tace.', lang: 'it' });
  const begin = messages.find((m) => m.type === 'begin');
  let sample = 0;
  let frame = 0;
  for (const chunk of chunks) {
    assert.equal(chunk.sampleRate, begin.rate);
    assert.equal(chunk.start, sample);
    assert.equal(chunk.firstFrame, frame);
    assert.equal(chunk.audio.length, chunk.samples);
    sample += chunk.samples;
    frame += chunk.frames.length;
    for (let k = chunk.firstFrame; k < frame; k++) {
      const at = (k * chunk.sampleRate) / chunk.fps;
      assert.ok(at >= chunk.start && at < sample, `frame ${k} at ${at} in ${chunk.start}..${sample}`);
    }
  }
  assert.equal(frame, Math.ceil((sample * 25) / begin.rate));
  assert.ok(Math.abs(end.duration - sample / begin.rate) < 1e-4);
  assert.ok(Math.max(...chunks.map((c) => Math.max(...c.audio))) > 3000, 'there is sound');
});

for (const fps of [25, 29.97, 30, 50, 60, 120])
  test(`sends ${fps} frames per second`, async () => {
    const { chunks, end } = await speak({ text: 'Papà.', lang: 'it', fps });
    const frames = framesOf(chunks);
    assert.ok(Math.abs(frames.length - end.duration * fps) <= 1);
    assert.ok(Math.abs(chunks[0].fps - fps) < 1e-9);
  });

test('the mouth opens on vowels, and is at rest at the beginning and the end', async () => {
  const { chunks } = await speak({ text: 'Una casa alta.', lang: 'it', still: true });
  const jaw = framesOf(chunks).map((f) => f.values[OPEN_JAW]);
  assert.ok(Math.max(...jaw) > 150, `jaw ${jaw}`);
  assert.ok(jaw.at(-1) < 60, `jaw at the end ${jaw.at(-1)}`);
});

test('reports word positions in bytes and in UTF-16 units', async () => {
  const text = '😀 Perché così? Città è più.';
  const { messages } = await speak({ text, lang: 'it' });
  const words = messages.filter((m) => m.type === 'word');
  const bytes = Buffer.from(text);
  assert.ok(words.length >= 5);
  for (const word of words) {
    assert.equal(bytes.subarray(word.start, word.end).toString(), word.text);
    assert.equal(text.slice(word.utf16_start, word.utf16_end), word.text);
  }
  const times = words.map((w) => w.time);
  assert.deepEqual(times, [...times].sort((a, b) => a - b));
  for (const wanted of ['Perché', 'così', 'Città', 'è', 'più']) assert.ok(words.some((w) => w.text === wanted), wanted);
});

test('sends events before their chunk, and media at most half a second early', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', lang: 'it', text: 'Questa è una frase piuttosto lunga, che dura ben più di due secondi.' });
  await stream.wait({ type: 'end' });
  const rate = stream.messages.find((m) => m.type === 'begin').rate;
  const first = stream.chunks[0].arrived;
  for (const chunk of stream.chunks.slice(1)) {
    const early = chunk.start / rate - (chunk.arrived - first) / 1000;
    assert.ok(early < 0.55, `chunk at ${chunk.start / rate} s came ${early} s early`);
  }
  for (const word of stream.messages.filter((m) => m.type === 'word')) {
    const chunk = stream.chunks.find((c) => c.start <= word.sample && word.sample < c.start + c.samples);
    assert.ok(word.arrived <= chunk.arrived);
  }
  await stream.close();
});

test('sends the first media of a long text long before the last sentence is generated', async () => {
  const stream = await daemon.stream();
  const started = performance.now();
  stream.send({ type: 'speak', lang: 'it', text: 'Una frase come tante altre. '.repeat(3000) });
  await stream.until(() => stream.chunks.length > 0);
  assert.ok(performance.now() - started < 5000);
  stream.send({ type: 'stop' });
  const end = await stream.wait({ type: 'end' });
  assert.equal(end.reason, 'stopped');
  await stream.close();
});

test('queues utterances; stop ends every one of them; the next speaks', async () => {
  const stream = await daemon.stream();
  for (const id of ['a', 'b', 'c']) stream.send({ type: 'speak', id, lang: 'it', text: 'Uno, due, tre, quattro, cinque.' });
  await stream.until(() => stream.chunks.length > 0);
  stream.send({ type: 'stop' });
  for (const id of ['a', 'b', 'c']) assert.equal((await stream.wait({ type: 'end', id })).reason, 'stopped');
  const before = stream.chunks.length;
  stream.send({ type: 'speak', id: 'd', lang: 'it', text: 'Ancora.' });
  const last = await stream.wait({ type: 'end', id: 'd' });
  assert.equal(last.reason, 'done');
  assert.ok(stream.chunks.length > before);
  assert.deepEqual(stream.chunks.slice(before).filter((chunk) => chunk.utterance !== last.utterance), [], 'silent after stop');
  assert.equal(stream.messages.filter((m) => m.type === 'end').length, 4);
  await stream.close();
});

test('queued utterances follow each other, each with its own clock', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'a', lang: 'it', text: 'Uno.' });
  stream.send({ type: 'speak', id: 'b', lang: 'en', text: 'Two.' });
  await stream.wait({ type: 'end', id: 'b' });
  const order = stream.messages.filter((m) => ['begin', 'end'].includes(m.type)).map((m) => m.type + m.id);
  assert.deepEqual(order, ['begina', 'enda', 'beginb', 'endb']);
  assert.equal(stream.chunks.find((c) => c.utterance === 2).start, 0);
  await stream.close();
});

test('the same seed gives the same face', async () => {
  const face = async (seed) => framesOf((await speak({ text: 'Buongiorno a tutti voi.', lang: 'it', seed })).chunks).map((f) => [...f.values]);
  const [one, again, other] = [await face(7), await face(7), await face(8)];
  // Compares eyelids and head. They are only nearly equal: the voice's output varies by some samples, and the head follows it.
  const alive = [19, 20, 21, 22, 48, 49, 50];
  const difference = (a, b) => a.slice(0, b.length).reduce((sum, frame, i) => sum + alive.reduce((s, n) => s + Math.abs(frame[n] - b[i][n]), 0), 0);
  assert.ok(difference(one, other) > 4 * difference(one, again), `${difference(one, again)}, ${difference(one, other)}`);
});

test('sends the head model over the socket once, part by part', async () => {
  const stream = await daemon.stream();
  const { models } = await stream.wait({ type: 'hello' });
  assert.ok(models.length > 0);
  stream.send({ type: 'model', name: models[0].name });
  await stream.until(() => stream.messages.some((m) => m.type === 'model' && m.index === m.count - 1));
  const parts = stream.messages.filter((m) => m.type === 'model');
  assert.deepEqual(parts.map((p) => p.index), parts.map((_, i) => i));
  const head = parts[0].data;
  head.textures = Object.fromEntries(parts.filter((p) => p.kind === 'texture').map((p) => [p.part, p.data]));
  head.parts = parts.filter((p) => p.kind === 'part').map((p) => p.data);
  assert.deepEqual(head, await (await daemon.get(`/v1/models/${models[0].name}`)).json());
  await stream.close();
});
