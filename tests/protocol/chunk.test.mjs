// SPDX-License-Identifier: GPL-3.0-or-later
// The chunk codec against the vectors that the C codec is held to as well.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import {
  AUDIO_PCM_S16LE,
  AUDIO_SILENCE,
  ChunkError,
  decodeChunk,
  encodeChunk,
  FAP_NONE,
  FAP_PLAIN,
} from '../../protocol/chunk/chunk.mjs';

const vectors = JSON.parse(fs.readFileSync(new URL('../../protocol/vectors/chunks.json', import.meta.url)));
const bytesOf = (vector) => new Uint8Array(Buffer.from(vector.hex, 'hex'));

function assertDecodes(vector) {
  const chunk = decodeChunk(bytesOf(vector));
  assert.equal(chunk.utterance, vector.utterance);
  assert.equal(chunk.sampleRate, vector.rate);
  assert.equal(chunk.fps, vector.fps_hundreds / 100);
  assert.equal(chunk.start, vector.start);
  assert.equal(chunk.samples, vector.samples);
  assert.equal(chunk.firstFrame, vector.first_frame);
  assert.deepEqual([...(chunk.audio ?? [])], vector.audio);
  assert.equal(chunk.frames.length, vector.frames.length);
  vector.frames.forEach((frame, i) => {
    const values = Object.fromEntries([...chunk.frames[i].entries()].filter(([, v]) => v));
    assert.deepEqual(values, frame.values);
    assert.deepEqual([...chunk.visemes[i]], frame.viseme);
    assert.deepEqual([...chunk.expressions[i]], frame.expression);
  });
  return chunk;
}

for (const vector of vectors.good)
  test(`decodes and encodes: ${vector.name}`, () => {
    const chunk = assertDecodes(vector);
    assert.equal(Buffer.from(encodeChunk(chunk)).toString('hex'), vector.hex);
  });

for (const vector of vectors.loose)
  test(`decodes, but encodes in a shorter form: ${vector.name}`, () => {
    const chunk = assertDecodes(vector);
    assert.ok(encodeChunk(chunk).length < bytesOf(vector).length);
  });

for (const vector of vectors.bad)
  test(`rejects ${vector.name}`, () => {
    assert.throws(
      () => decodeChunk(bytesOf(vector)),
      (e) => e instanceof ChunkError && e.at === vector.at,
    );
  });

test('reads ArrayBuffers, and views and Buffers at any offset', () => {
  const [vector] = vectors.good.filter((v) => v.audio.length && v.frames.length);
  const bytes = bytesOf(vector);
  const room = Buffer.alloc(bytes.length + 8, 0xee);
  room.set(bytes, 3);
  const expected = decodeChunk(bytes);
  const there = room.subarray(3, 3 + bytes.length);
  assert.deepEqual(decodeChunk(bytes.buffer), expected);
  assert.deepEqual(decodeChunk(new Uint8Array(there.buffer, there.byteOffset, there.length)), expected);
  const chunk = decodeChunk(there);
  assert.deepEqual(chunk, expected);
  room.fill(0); // what has been decoded is a copy
  assert.deepEqual(chunk, expected);
});

test('encodes without visemes and expressions', () => {
  const chunk = decodeChunk(bytesOf(vectors.good.find((v) => v.name === 'one frame, one FAP')));
  const bytes = encodeChunk(chunk);
  delete chunk.visemes;
  delete chunk.expressions;
  assert.deepEqual(encodeChunk(chunk), bytes);
});

test('refuses to encode invalid values', () => {
  const fine = {
    utterance: 1,
    sampleRate: 8000,
    fps: 25,
    start: 0,
    samples: 2,
    firstFrame: 0,
    audioCodec: AUDIO_PCM_S16LE,
    audio: new Int16Array(2),
    fapCodec: FAP_PLAIN,
    frames: [new Int32Array(69)],
  };
  assert.equal(encodeChunk(fine).length, 32 + 4 + 9);
  const wrong = [
    { audio: new Int16Array(3) },
    { audio: null },
    { audioCodec: AUDIO_SILENCE },
    { audioCodec: 9 },
    { fapCodec: FAP_NONE },
    { fapCodec: 9 },
    { sampleRate: 0 },
    { sampleRate: 2 ** 32 },
    { fps: 0 },
    { fps: 656 },
    { fps: NaN },
    { start: -1 },
    { start: 0.5 },
    { utterance: undefined },
    { firstFrame: 2 ** 32 },
    { frames: Array(65536).fill(fine.frames[0]) },
  ];
  for (const change of wrong)
    assert.throws(() => encodeChunk({ ...fine, ...change }), RangeError, JSON.stringify(Object.keys(change)));
});

test('survives any bytes', () => {
  let seed = 1;
  const random = (below) => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return (seed >>> 8) % below;
  };
  let accepted = 0;
  let refused = 0;
  for (let round = 0; round < 5000; round++) {
    let bytes = bytesOf(vectors.good[round % vectors.good.length]);
    for (let hit = 0; hit < 1 + (round % 5); hit++) bytes[random(hit % 2 ? 32 : bytes.length)] = random(256);
    if (round % 7 === 0) bytes = bytes.slice(0, random(bytes.length + 1));
    let chunk;
    try {
      chunk = decodeChunk(bytes);
    } catch (e) {
      assert.ok(e instanceof ChunkError && e.at >= 0 && e.at <= bytes.length, e.stack);
      refused++;
      continue;
    }
    const again = encodeChunk(chunk);
    assert.ok(again.length <= bytes.length);
    assert.deepEqual(decodeChunk(again), chunk);
    accepted++;
  }
  assert.ok(accepted > 300 && refused > 300);
});
