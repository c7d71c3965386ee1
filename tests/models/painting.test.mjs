// SPDX-License-Identifier: GPL-3.0-or-later
// Surface measures that the painting tools use.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { packIslands } from '../../models/tools/head/atlas.mjs';
import { DepthMap } from '../../models/tools/head/paint/depth.mjs';
import { distanceTo } from '../../models/tools/head/paint/near-hair.mjs';
import { neckPaint } from '../../models/tools/head/paint/paint-neck.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { drawHead, seenAt } from '../../models/tools/lib/portrait.mjs';
import { rounded } from '../../models/tools/head/refine.mjs';
import { wideEnough } from '../../models/tools/head/strips.mjs';
import '../lib/built-heads.mjs';

/** A square of 40 mm in the plane z = 10. */
const square = () => ({
  position: Float64Array.from([-20, -20, 10, 20, -20, 10, 20, 20, 10, -20, 20, 10]),
  uv: [0, 0, 1, 0, 1, 1, 0, 1], index: [0, 1, 2, 0, 2, 3], smooth: null, refs: [[[0, 1]], [[1, 1]], [[2, 1]], [[3, 1]]],
});

test('a height map knows what occludes what, and looks through transparent points', () => {
  const size = { resolution: 64, reach: 50 };
  const map = new DepthMap([0, 0, 1], size);
  map.draw(square());
  assert.ok(map.hides(0, 0, 0, 1));
  assert.ok(!map.hides(0, 0, 9.5, 1), 'it does not hide what lies in it');
  assert.ok(!map.hides(30, 0, 0, 1));
  assert.equal(map.reaches(0, 0, 0, 1), 0);
  assert.equal(map.reaches(30, 0, 0, 1), 1);
  assert.equal(map.reaches(0, 0, 0, 1, (mm) => mm / 20), 0.45, 'what comes through, by how far it lies below');
  const edge = map.reaches(20, 0, 0, 1);
  assert.ok(edge > 0.1 && edge < 0.9, `${edge}`);
  const half = new DepthMap([0, 0, 1], size);
  half.draw(square(), (u) => u > 0.5);
  assert.ok(half.hides(10, 0, 0, 1) && !half.hides(-10, 0, 0, 1));
});

test('the distance to hair is accurate to about a cell, and ignores transparent parts', () => {
  const far = distanceTo(square(), undefined, 20);
  for (const [x, y, z, mm] of [[0, 0, 10, 0], [0, 0, 20, 10], [0, 32, 10, 12], [35, 0, 10, 15]])
    assert.ok(Math.abs(far(x, y, z) - mm) < 3, `${[x, y, z]}: ${far(x, y, z)}`);
  assert.ok(far(0, 0, 200) > 100);
  assert.ok(distanceTo(square(), (u) => u > 0.5, 20)(-15, 0, 10) > 10);
});

test('islands get space by their surface size, and do not overlap', () => {
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

test('limits the length of edges in a mesh with few faces', () => {
  const { index, position } = rounded(square(), 12);
  for (let t = 0; t < index.length; t += 3)
    for (let i = 0; i < 3; i++) {
      const [a, b] = [index[t + i], index[t + ((i + 1) % 3)]];
      const length = Math.hypot(...[0, 1, 2].map((k) => position[a * 3 + k] - position[b * 3 + k]));
      assert.ok(length <= 12, `${length}`);
    }
});

test('finds an isolated thin strip, and keeps a broad one', () => {
  const at = [[0, 0, 0], [40, 0, 0], [40, 20, 0], [0, 20, 0], [60, 0, 0], [60, 100, 0], [61, 100, 0], [61, 0, 0]];
  const faces = [{ v: [0, 1, 2, 3] }, { v: [4, 5, 6, 7] }];
  assert.deepEqual(faces.map(wideEnough(faces, (v) => at[v], 3)), [true, false]);
  assert.deepEqual(faces.map(wideEnough(faces, (v) => at[v], 0.5)), [true, true]);
});

test('paints tendons, collar bones and the hollow between them in place, symmetrically', () => {
  const joints = { 'joint-l-clavicle': [23, -209, -91], 'joint-l-scapula': [90, -189, -89] };
  const ctx = { fdp: { '2.1': [0, -93, 22], '10.5': [65, -46, -66] }, point: ({ group }) => joints[group] };
  const skin = [200, 150, 130];
  const light = (spec, x, y) => neckPaint(ctx, spec, 0.3)(skin, [x, y, -20], [0, 0, 1]).reduce((a, b) => a + b) / 480;
  const spec = { tendons: 4, collar: 4, larynx: 3 };
  const column = (x) => Array.from({ length: 60 }, (_, i) => light(spec, x, -225 + i));
  for (const x of [40, -40]) assert.ok(Math.max(...column(x)) > 1.02 && Math.min(...column(x)) < 0.98, `a collar bone at ${x}`);
  assert.ok(light(spec, 0, -203) < 0.9, 'the hollow is dark');
  assert.deepEqual(neckPaint(ctx, spec, 0.3)(skin, [10, -60, 0], [0, 0, 1]), skin, 'nothing on the face');
  assert.equal(light(undefined, 40, -207), 1);
});

test('pictures without a graphics processor have the shadow of the upper lid on the eye', async () => {
  const built = process.env.FACCIA_MODELS ?? fileURLToPath(new URL('../../build/models', import.meta.url));
  const head = unpack(JSON.parse(fs.readFileSync(path.join(built, 'heads/mara.json'))));
  const [left, right] = ['eye_l', 'eye_r'].map((name) => head.turns.find((turn) => turn.name.startsWith(name)).pivot);
  const crop = { x: 500, y: 900, width: 1000, height: 400 };
  const { data, width } = await drawHead(head, { width: 2000, height: 2600, shadows: false, crop });
  const light = (below) => {
    const each = [[left, '3.1'], [right, '3.2']].map(([centre, point]) => {
      const margin = head.fdp[point];
      const place = [margin[0] + 7.5 * Math.sign(margin[0]), margin[1] - 1.5 - below, centre[2] + 10]; // the white beside the iris
      const [x, y] = seenAt(head, { width: 2000, height: 2600 }, [place])[0].map(Math.round);
      const at = 4 * ((y - crop.y) * width + x - crop.x);
      return data[at] + data[at + 1] + data[at + 2];
    });
    return each[0] + each[1]; // the lamp stands on one side
  };
  assert.ok(light(2) < 0.97 * light(4), `${light(2)} below the lid and its lashes, ${light(4)} farther down`);
});
