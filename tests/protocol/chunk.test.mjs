// SPDX-License-Identifier: GPL-3.0-or-later
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { ChunkError, decodeChunk, encodeChunk } from '../../protocol/chunk.mjs';
import { clampFap, fapByName, faps, fapScale } from '../../protocol/fap.mjs';

const vectors = JSON.parse(fs.readFileSync(new URL('../../protocol/vectors/chunks.json', import.meta.url)));
const bytesOf = (vector) => new Uint8Array(Buffer.from(vector.hex, 'hex'));

for (const vector of vectors.good)
  test(`decodes and encodes: ${vector.name}`, () => {
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
    assert.equal(Buffer.from(encodeChunk(chunk)).toString('hex'), vector.hex);
  });

for (const vector of vectors.bad)
  test(`refuses: ${vector.name}`, () => {
    assert.throws(() => decodeChunk(bytesOf(vector)), (e) => e instanceof ChunkError && e.at === vector.at);
  });

test('the table is that of the standard', () => {
  assert.equal(faps.length, 69);
  assert.equal(fapByName('open_jaw'), 3);
  assert.equal(fapByName('pull_r_ear'), 68);
  assert.equal(fapByName('nothing'), 0);
  assert.deepEqual([1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map((g) => faps.filter((f) => f?.group === g).length), [2, 16, 12, 8, 4, 5, 3, 10, 4, 4]);
  assert.equal(clampFap(3, -5), 0);
  assert.equal(clampFap(3, 99999), 4320);
  assert.equal(clampFap(48, -1e9), -1860 * 170);
  assert.equal(fapScale(3, { MNS: 1024 }), 1);
  assert.equal(fapScale(49, {}), 1e-5);
});
