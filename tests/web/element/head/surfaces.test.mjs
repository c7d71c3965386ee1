// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { outsideFirst } from '../../../../web/element/head/shading/surfaces.mjs';

test('sorts the outermost triangles of hair first, without losing any', () => {
  const ring = (r) => [r, 0, -70, 0, r, -70, 0, 0, r - 70];
  const part = { position: Float32Array.from([...ring(80), ...ring(120), ...ring(100)]) };
  const strand = (first) => Array.from({ length: 3 * 48 }, (_, i) => first + (i % 3)); // what stays together
  const index = Uint16Array.from([...strand(0), ...strand(3), ...strand(6)]);
  assert.deepEqual([...outsideFirst(part, index)], [...strand(3), ...strand(6), ...strand(0)]);
});
