// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { fingerprint, shared } from '../../../../web/element/head/model/cache.mjs';
import { outsideFirst } from '../../../../web/element/head/shading/surfaces.mjs';

test('what is the same is made once, what is not is not', () => {
  let made = 0;
  const make = () => ({ number: made++ });
  const one = shared('list', 'AAAA', make);
  assert.equal(shared('list', 'AAAA', make), one);
  assert.notEqual(shared('list', 'AAAB', make), one);
  assert.notEqual(shared('uv', 'AAAA', make), one, 'another kind of thing is made of it');
  assert.equal(made, 3);
});

test('fingerprints of texts that differ in little differ', () => {
  const texts = Array.from({ length: 20000 }, (_, i) => `AAAA${i.toString(36).padStart(4, '0')}AAAA`);
  assert.equal(new Set(texts.map(fingerprint)).size, texts.length);
});

test('the outermost triangles of hair come first, and none is lost', () => {
  const ring = (r) => [r, 0, -70, 0, r, -70, 0, 0, r - 70];
  const part = { position: Float32Array.from([...ring(80), ...ring(120), ...ring(100)]) };
  const strand = (first) => Array.from({ length: 3 * 48 }, (_, i) => first + (i % 3)); // what stays together
  const index = Uint16Array.from([...strand(0), ...strand(3), ...strand(6)]);
  assert.deepEqual([...outsideFirst(part, index)], [...strand(3), ...strand(6), ...strand(0)]);
});
