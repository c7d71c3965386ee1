// SPDX-License-Identifier: GPL-3.0-or-later
// What the tools find out about surfaces before they paint them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { packIslands } from '../../models/tools/lib/atlas.mjs';
import { DepthMap } from '../../models/tools/lib/depth.mjs';
import { distanceTo } from '../../models/tools/lib/near-hair.mjs';
import { rounded } from '../../models/tools/lib/refine.mjs';

/** A square of 40 mm in the plane z = 10. */
const square = () => ({
  position: Float64Array.from([-20, -20, 10, 20, -20, 10, 20, 20, 10, -20, 20, 10]),
  uv: [0, 0, 1, 0, 1, 1, 0, 1], index: [0, 1, 2, 0, 2, 3], smooth: null, refs: [[[0, 1]], [[1, 1]], [[2, 1]], [[3, 1]]],
});

test('a picture of heights knows what hides what, and sees through what is not opaque', () => {
  const size = { resolution: 64, reach: 50 };
  const map = new DepthMap([0, 0, 1], size);
  map.draw(square());
  assert.ok(map.hides(0, 0, 0, 1));
  assert.ok(!map.hides(0, 0, 9.5, 1), 'it does not hide what lies in it');
  assert.ok(!map.hides(30, 0, 0, 1));
  assert.equal(map.reaches(0, 0, 0, 1), 0);
  assert.equal(map.reaches(30, 0, 0, 1), 1);
  const edge = map.reaches(20, 0, 0, 1);
  assert.ok(edge > 0.1 && edge < 0.9, `${edge}`);
  const half = new DepthMap([0, 0, 1], size);
  half.draw(square(), (u) => u > 0.5);
  assert.ok(half.hides(10, 0, 0, 1) && !half.hides(-10, 0, 0, 1));
});

test('the distance to hair is known to about a cell, and only to what is opaque', () => {
  const far = distanceTo(square(), undefined, 20);
  for (const [x, y, z, mm] of [[0, 0, 10, 0], [0, 0, 20, 10], [0, 32, 10, 12], [35, 0, 10, 15]])
    assert.ok(Math.abs(far(x, y, z) - mm) < 3, `${[x, y, z]}: ${far(x, y, z)}`);
  assert.ok(far(0, 0, 200) > 100);
  assert.ok(distanceTo(square(), (u) => u > 0.5, 20)(-15, 0, 10) > 10);
});

test('islands get room by their size on the surface, and none lies over another', () => {
  const [a, b] = [square(), square()];
  const part = {
    position: Float64Array.from([...a.position, ...b.position.map((x) => x / 2)]),
    uv: [...a.uv.map((x) => x / 10), ...b.uv], index: [...a.index, ...b.index.map((v) => v + 4)],
  };
  packIslands(part);
  const box = (from) => [0, 1].map((k) => [0, 1, 2, 3].map((v) => part.uv[(from + v) * 2 + k])).map((list) => [Math.min(...list), Math.max(...list)]);
  const [one, other] = [box(0), box(4)];
  const width = ([[low, high]]) => high - low;
  assert.ok(Math.abs(width(one) / width(other) - 2) < 1e-6);
  assert.ok(part.uv.every((x) => x >= 0 && x <= 1));
  assert.ok(one[0][1] < other[0][0] || other[0][1] < one[0][0] || one[1][1] < other[1][0] || other[1][1] < one[1][0]);
});

test('a thing of few faces gets no edge longer than it may', () => {
  const { index, position } = rounded(square(), 12);
  for (let t = 0; t < index.length; t += 3)
    for (let i = 0; i < 3; i++) {
      const [a, b] = [index[t + i], index[t + ((i + 1) % 3)]];
      const length = Math.hypot(...[0, 1, 2].map((k) => position[a * 3 + k] - position[b * 3 + k]));
      assert.ok(length <= 12, `${length}`);
    }
});
