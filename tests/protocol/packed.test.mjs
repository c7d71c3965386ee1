// SPDX-License-Identifier: GPL-3.0-or-later
// Packed events against the vectors that the C code is held to as well.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { ChunkError } from '../../protocol/chunk/chunk.mjs';
import { CompactReader } from '../../protocol/chunk/compact.mjs';
import { packEvents } from '../../protocol/chunk/packed.mjs';

const vectors = JSON.parse(fs.readFileSync(new URL('../../protocol/vectors/packed.json', import.meta.url)));

for (const vector of vectors.good)
  test(`reads and writes ${vector.name}`, () => {
    const chunk = new CompactReader().decode(Buffer.from(vector.hex, 'hex'));
    assert.deepEqual(chunk.events, vector.events);
    assert.equal(chunk.samples, 4410);
    assert.equal(Buffer.from(packEvents(vector.events, chunk.sampleRate)).toString('hex'), vector.packed);
  });

for (const vector of vectors.bad)
  test(`rejects ${vector.name}`, () => {
    assert.throws(() => new CompactReader().decode(Buffer.from(vector.hex, 'hex')), ChunkError);
  });

test('rejects text that is not UTF-8', () => {
  const [, word] = vectors.good;
  const bytes = Buffer.from(word.hex, 'hex');
  bytes[bytes.length - 1] = 0xff;
  assert.throws(() => new CompactReader().decode(bytes), ChunkError);
});
