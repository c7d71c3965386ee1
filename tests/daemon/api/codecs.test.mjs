// SPDX-License-Identifier: GPL-3.0-or-later
// The default media encoding: Opus and FAPC, a few kbit/s.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { CompactReader, OPUS_PACKET_SAMPLES, OPUS_RATE, OPUS_SKIP } from '../../../protocol/chunk/compact.mjs';
import { fapcStep } from '../../../protocol/fapc/fapc.mjs';
import { Daemon, framesOf } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const text = 'La mamma prepara il pane con la farina bianca. Il bambino guarda fuori, e vede passare un gatto. Poi torna il sole.';
const DEFAULT = '?audio=opus&fap=fapc';

/** Joins one room with several encodings, so that all streams carry the same speech. */
const hear = async (room, ways) => {
  const streams = await Promise.all(ways.map((way) => daemon.stream(`?room=${room}&${way}`)));
  streams[0].send({ type: 'speak', id: 's', lang: 'it', text, seed: 5 });
  for (const stream of streams) await stream.wait({ type: 'end', id: 's', reason: 'done' });
  await Promise.all(streams.map((stream) => stream.close()));
  return streams;
};

test('coded and plain FAPs agree within half a step, at the same times', async () => {
  const [coded, plain] = await hear('same', ['audio=opus&fap=fapc', 'audio=pcm&fap=plain']);
  const a = framesOf(coded.chunks);
  const b = framesOf(plain.chunks);
  assert.equal(a.length, b.length);
  assert.ok(a.length > 100);
  a.forEach((frame, i) => {
    assert.equal(frame.time, b[i].time);
    for (let n = 3; n <= 68; n++) assert.ok(Math.abs(frame.values[n] - b[i].values[n]) <= fapcStep(n, 5) / 2, `FAP ${n}`);
  });
});

test('the Opus packets cover the utterance without a gap, in step with the frames', async () => {
  const [coded, plain] = await hear('cover', ['audio=opus&fap=fapc', 'audio=pcm&fap=plain']);
  const seconds = plain.chunks.reduce((sum, chunk) => sum + chunk.samples / chunk.sampleRate, 0);
  let packets = 0;
  for (const chunk of coded.chunks) {
    assert.equal(chunk.firstPacket, packets);
    // sound starts no later than the frames of the same chunk, and not much earlier
    const heard = (packets * OPUS_PACKET_SAMPLES - OPUS_SKIP) / OPUS_RATE;
    assert.ok(heard <= chunk.start / chunk.sampleRate + 1e-9);
    assert.ok(heard > chunk.start / chunk.sampleRate - 0.1, `${heard} ${chunk.start / chunk.sampleRate}`);
    packets += chunk.audio?.length ?? 0;
  }
  const covered = (packets * OPUS_PACKET_SAMPLES - OPUS_SKIP) / OPUS_RATE;
  assert.ok(covered >= seconds - 0.001 && covered < seconds + 0.045, `${covered} of ${seconds}`);
});

test('audio needs under 26 kbit/s, and everything else under 3.5 kbit/s', async () => {
  const [coded] = await hear('few', ['audio=opus&fap=fapc']);
  const seconds = coded.chunks.reduce((sum, chunk) => sum + chunk.samples / chunk.sampleRate, 0);
  const kilobits = (bytes) => (bytes * 8) / seconds / 1000;
  const audio = coded.chunks.flatMap((chunk) => chunk.audio ?? []).reduce((sum, packet) => sum + packet.length + 1, 0);
  const all = coded.chunks.reduce((sum, chunk) => sum + chunk.bytes, 0);
  assert.ok(kilobits(audio) < 26, `${kilobits(audio)} kbit/s of audio`);
  assert.ok(kilobits(all - audio) < 3.5, `${kilobits(all - audio)} kbit/s of all else`);
});

test('the Opus bit rate follows the request', async () => {
  const ways = ['kilobits=8', 'kilobits=12', '', 'kilobits=32'].map((way) => `audio=opus&fap=fapc&${way}`);
  const sizes = (await hear('bits', ways)).map(({ chunks }) => chunks.flatMap((chunk) => chunk.audio ?? []).reduce((sum, packet) => sum + packet.length + 1, 0));
  for (let i = 1; i < sizes.length; i++) assert.ok(sizes[i] > 1.15 * sizes[i - 1], `${sizes}`);
  const stream = await daemon.stream(DEFAULT);
  for (const kilobits of [5, 65, 'many']) {
    stream.send({ type: 'media', kilobits });
    await stream.wait({ type: 'error', code: 'bad-field', field: 'kilobits' });
    stream.messages.length = 0;
  }
  await stream.close();
});

test('a late listener can decode the stream', async () => {
  const first = await daemon.stream(`${DEFAULT}&room=late`);
  first.send({ type: 'speak', id: 's', lang: 'it', text });
  await first.until(() => first.chunks.length > 15);
  const late = await daemon.stream(`${DEFAULT}&room=late`);
  await late.wait({ type: 'end', id: 's' });
  await first.wait({ type: 'end', id: 's' });
  const both = framesOf(late.chunks);
  const from = late.chunks[0].firstFrame;
  assert.ok(from > 10 && both.length > 30);
  assert.ok(late.chunks.every((chunk) => !chunk.missing));
  const truth = framesOf(first.chunks).slice(from);
  assert.deepEqual(both.map((f) => [...f.values]), truth.map((f) => [...f.values]));
  assert.equal(late.chunks[0].firstPacket, first.chunks.find((c) => c.firstFrame === from).firstPacket);
  await first.close();
  await late.close();
});

test('after a stop, the next utterance contains nothing of the old one', async () => {
  const stream = await daemon.stream(DEFAULT);
  stream.send({ type: 'speak', id: 'a', lang: 'it', text });
  await stream.until(() => stream.chunks.length > 5);
  stream.send({ type: 'stop' });
  stream.send({ type: 'speak', id: 'b', lang: 'it', text: 'Un’altra cosa.' });
  await stream.wait({ type: 'end', id: 'b' });
  const second = stream.chunks.filter((chunk) => chunk.utterance === 2);
  assert.equal(second[0].firstPacket, 0);
  assert.equal(second[0].start, 0);
  await stream.close();
});

test('refuses incompatible codecs', async () => {
  const stream = await daemon.stream('?audio=opus&fap=plain');
  await stream.wait({ type: 'error', code: 'unknown-codec', field: 'fap' });
  stream.send({ type: 'media', audio: 'pcm', fap: 'fapc' });
  stream.send({ type: 'speak', id: 's', lang: 'it', text: 'Sì.' });
  await stream.wait({ type: 'end', id: 's', reason: 'done' });
  assert.ok(stream.chunks.length > 0 && stream.chunks.every((chunk) => chunk.audio instanceof Int16Array && chunk.fapCodec === 2));
  await stream.close();
});

test('rejects damaged compact chunks with their position, or drops their frames; the reader survives', async () => {
  const { default: WebSocket } = await import('ws');
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream`);
  const raw = [];
  await new Promise((resolve) => {
    socket.on('message', (data, binary) => (binary ? raw.push(new Uint8Array(data)) : JSON.parse(data).type === 'end' && resolve()));
    socket.on('open', () => socket.send(JSON.stringify({ type: 'speak', lang: 'it', text })));
  });
  socket.close();
  let seed = 1;
  const random = (n) => (seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) % n;
  let refused = 0;
  for (let round = 0; round < 200; round++) {
    const reader = new CompactReader();
    for (const bytes of raw.slice(0, 20)) {
      const broken = bytes.slice(0, 1 + random(bytes.length));
      broken[random(broken.length)] = random(256);
      try {
        reader.decode(broken);
      } catch (error) {
        assert.equal(error.name, 'ChunkError', error.stack);
        refused++;
      }
    }
  }
  assert.ok(refused > 500);
});
