// SPDX-License-Identifier: MIT
// Warps by radial basis functions: they meet their points, are affine where the points are, and say what is wrong.
import assert from 'node:assert/strict';
import test from 'node:test';
import { MOST_POINTS, rbf, WarpError } from '../../../../web/element/head/model/rbf.mjs';

let seed = 7;
const random = () => ((seed = (seed * 16807) % 2147483647) / 2147483647) * 2 - 1;
const cloud = (count, size) => Float64Array.from({ length: 3 * count }, () => size * random());
const moved = (points, by) => points.map((value) => value + by * random());
const off = (a, b) => a.reduce((most, value, i) => Math.max(most, Math.abs(value - b[i])), 0);

const KERNELS = ['biharmonic', 'thin-plate', 'triharmonic'];

test('each kernel interpolates its points', () => {
  for (const kernel of KERNELS)
    for (const count of [4, 5, 84, 482]) {
      const from = cloud(count, 120);
      const to = moved(from, 15);
      const error = off(rbf(from, to, { kernel }).apply(from, new Float64Array(from.length)), to);
      assert.ok(error < 1e-6, `${kernel}, ${count} points: ${error} mm`);
    }
});

test('extends an affine map of the points to all points', () => {
  const turned = ([x, y, z]) => [1.1 * x - 0.2 * y + 3, 0.3 * x + 0.9 * y - 7, 0.1 * y + 1.2 * z + 11];
  const map = (points) => Float64Array.from({ length: points.length }, (_, i) => turned(points.subarray(i - (i % 3), i - (i % 3) + 3))[i % 3]);
  for (const kernel of KERNELS) {
    const from = cloud(40, 100);
    const elsewhere = cloud(200, 500);
    assert.ok(off(rbf(from, map(from), { kernel }).apply(elsewhere, new Float64Array(600)), map(elsewhere)) < 1e-6, kernel);
  }
});

test('is continuous between the points', () => {
  const from = cloud(60, 100);
  const warp = rbf(from, moved(from, 10));
  for (let i = 0; i < 200; i++) {
    const p = [...cloud(1, 100)];
    const q = [p[0] + 1e-3, p[1], p[2]];
    assert.ok(off(warp.at(p), warp.at(q)) < 0.01);
  }
});

test('with a support radius, nothing beyond it moves, and few points suffice', () => {
  const warp = rbf([0, 0, 0], [5, 0, 0], { reach: 40 });
  assert.ok(off(warp.at([0, 0, 0]), [5, 0, 0]) < 1e-9);
  assert.deepEqual(warp.at([0, 41, 0]), [0, 41, 0]);
  const half = warp.at([0, 20, 0])[0];
  assert.ok(half > 0.2 && half < 4.8);
});

test('smoothing misses the points slightly and oscillates less', () => {
  const from = cloud(50, 100);
  const to = moved(from, 10);
  const miss = (smooth) => off(rbf(from, to, { smooth }).apply(from, new Float64Array(150)), to);
  const [none, some, much] = [0, 0.01, 10].map(miss);
  assert.ok(none < 1e-6 && none < some && some < much, `${none} ${some} ${much}`);
});

test('the points may be overwritten in place, and float32 is sufficient', () => {
  const from = Float32Array.from(cloud(30, 100));
  const to = Float32Array.from(moved(from, 5));
  const points = from.slice();
  assert.equal(rbf(from, to).apply(points, points), points);
  assert.ok(off(points, to) < 1e-4);
});

test('names the point and the reason why there is no warp', () => {
  const four = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
  const wrong = (from, to, pattern, point = -1, options) =>
    assert.throws(() => rbf(from, to, options), (error) => error instanceof WarpError && error.point === point && pattern.test(error.message));
  wrong([0, 0, 0], [0, 0, 0], /at least 4/);
  wrong([], [], /at least 1/, -1, { reach: 3 });
  wrong([1, 2], [1, 2], /three numbers/);
  wrong(four, four.slice(3), /three numbers/);
  wrong([...four, 1, 0, 0], [...four, 1, 0, 0], /where point 1 is/, 4);
  wrong([...four.slice(0, 11), NaN], four, /not three numbers/, 3);
  wrong(four, [...four.slice(0, 11), Infinity], /not three numbers/, 3);
  wrong([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0], new Float64Array(15), /one plane/);
  wrong(four, four, /no kernel/, -1, { kernel: 'cubic' });
  wrong(four, four, /reach/, -1, { reach: 0 });
  wrong(four, four, /smooth/, -1, { smooth: -1 });
  wrong(four, four, /affine/, -1, { affine: false });
  wrong(cloud(MOST_POINTS + 1, 100), cloud(MOST_POINTS + 1, 100), /more than/);
});
