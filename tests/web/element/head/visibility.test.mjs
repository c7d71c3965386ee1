// SPDX-License-Identifier: MIT
// Visible parts of a head from the front: neither hidden behind others nor facing away.
import assert from 'node:assert/strict';
import test from 'node:test';
import { shut, visibleTriangles, within } from '../../../../web/element/head/mesh/visibility.mjs';

/** Squares of 4 mm in a plane across the view, `half` to each side of the middle. */
function plate(half, z, more = {}) {
  const position = [];
  const index = [];
  const row = half + 1;
  for (let y = 0; y < row; y++) for (let x = 0; x < row; x++) position.push(4 * x - 2 * half, 4 * y - 2 * half, z);
  for (let y = 0; y < half; y++)
    for (let x = 0; x < half; x++) {
      const a = y * row + x;
      index.push(a, a + 1, a + row + 1, a, a + row + 1, a + row);
    }
  const vertices = position.length / 3;
  return {
    position: Float32Array.from(position), index: Uint16Array.from(index), vertices, uv: new Float32Array(2 * vertices),
    double: false, alpha: null, hides: true, asked: true, free: null, ...more,
  };
}

function seen(parts) {
  const work = visibleTriangles(parts, () => ({ positions: parts.map(({ position }) => position), turn: (direction) => direction }));
  for (;;) {
    const { done, value } = work.next();
    if (done) return value.map((list) => list.filter((one) => one).length / list.length);
  }
}

test('hides surfaces right behind others, and keeps those that stand out', () => {
  const [front, behind] = seen([plate(40, 0), plate(20, -10)]);
  assert.equal(front, 1);
  assert.equal(behind, 0);
  const [, wider] = seen([plate(20, 0), plate(40, -10)]);
  assert.ok(wider > 0.5 && wider < 1, `${wider}`);
});

test('translucent surfaces hide nothing, and fully clear ones are invisible', () => {
  assert.deepEqual(seen([plate(40, 0, { alpha: () => 128 }), plate(20, -10)]), [1, 1]);
  assert.deepEqual(seen([plate(40, 0, { alpha: () => 0 }), plate(20, -10)]), [0, 1]);
  assert.deepEqual(seen([plate(40, 0, { hides: false }), plate(20, -10)]), [1, 1]);
});

test('hides back faces unless the material is double-sided', () => {
  const turned = plate(10, 0);
  turned.index.reverse();
  assert.deepEqual(seen([turned]), [0]);
  assert.deepEqual(seen([{ ...turned, double: true }]), [1]);
});

test('parts that move by themselves count as visible', () => {
  const behind = plate(20, -10);
  behind.free = new Uint8Array(behind.vertices).fill(1, 0, 21);
  const [, share] = seen([plate(40, 0), behind]);
  assert.ok(share > 0.04 && share < 0.2, `${share}`);
});

const face = (faps = {}) => Float32Array.from({ length: 69 }, (_, fap) => faps[fap] ?? 0);

test('excludes far turns, side views and mouths wider than the sampled poses', () => {
  assert.ok(within(face(), [0, 0, 1]));
  assert.ok(within(face({ 3: 600, 5: -700, 49: 20000 }), [0, 0.1, 0.99]));
  assert.ok(!within(face({ 49: 40000 }), [0, 0, 1]));
  assert.ok(!within(face({ 3: 1080 }), [0, 0, 1]));
  assert.ok(!within(face({ 10: -1500 }), [0, 0, 1]));
  assert.ok(!within(face(), [Math.sin(0.4), 0, Math.cos(0.4)]));
  assert.ok(!within(face(), [0, Math.sin(0.3), Math.cos(0.3)]));
});

test('lips that meet are shut; lips open at one side are not', () => {
  assert.ok(shut(face()));
  assert.ok(shut(face({ 4: 50, 5: 50 })));
  assert.ok(!shut(face({ 4: -20 })));
  assert.ok(!shut(face({ 11: -20 })));
});
