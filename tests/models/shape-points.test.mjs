// SPDX-License-Identifier: GPL-3.0-or-later
// A head without a detectable face, such as an animal's: its own shapes locate the face, and in the result everything that must close
// closes.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { findPoints } from '../../models/tools/import/find-points.mjs';
import { makeHead, readScene } from '../../models/tools/import/make-head.mjs';
import { checkEyelids } from '../../models/tools/lib/check.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { view } from '../../models/tools/lib/visibility.mjs';
import { models } from '../lib/built-heads.mjs';

const blind = async () => null;
const POINTS = ['2.1', '2.2', '2.3', '3.1', '3.2', '3.3', '3.4', '8.3', '8.4'];

async function read(name, change = () => {}) {
  const scene = await readScene(path.join(models, `heads/${name}.glb`));
  delete scene.points;
  change(scene);
  return scene;
}

for (const name of ['mara', 'samuel'])
  test(`${name}, without a visible face: finds lips, chin and lids by the shapes that move them`, async (t) => {
    const { fdp } = unpack(JSON.parse(fs.readFileSync(path.join(models, `heads/${name}.json`), 'utf8')));
    const scene = await read(name);
    const { points, notes } = await findPoints(scene, blind);
    assert.match(notes[0], /^feature points by what its shapes move, for no face was seen: 1\d landmarks, .*; y up, looking to \+z/);
    const { head } = makeHead(scene, points, { name, title: name, licence: 'CC0-1.0', credits: [] });
    const made = unpack(head);
    const off = Object.fromEntries(POINTS.map((one) => [one, Math.hypot(...made.fdp[one].map((x, k) => x - fdp[one][k]))]));
    t.diagnostic(JSON.stringify(off, (_, x) => (typeof x === 'number' ? Number(x.toFixed(1)) : x)));
    for (const one of POINTS) assert.ok(off[one] < ({ 2.1: 25, 2.2: 4, 2.3: 4, 8.3: 13, 8.4: 13 }[one] ?? 8), `${one}: ${off[one]} mm`);
    const inside = (faps) => ['teeth_upper', 'teeth_lower', 'tongue'].reduce((sum, part) => sum + view(made, faps, { yaw: 0, pitch: 0 }).count(part), 0) / 16;
    const [rest, jaw, open] = [{}, { 3: 200 }, { 3: 350, 4: -60, 5: -350, 8: -50, 9: -50, 10: -300, 11: -300, 51: -60, 52: -350, 55: -50, 56: -50, 57: -300, 58: -300 }].map(inside);
    t.diagnostic(`seen of the mouth: ${rest} at rest, ${jaw} with the jaw down and the lips closed, ${open} mm² open`);
    assert.ok(rest < 1 && jaw < 3 && open > 80, `${rest} ${jaw} ${open}`);
    assert.deepEqual(checkEyelids(made).filter((line) => / at 0 rad/.test(line)), []);
  });

test('finds points on a head facing backwards, with left and right swapped', async () => {
  const scene = await read('mara', ({ meshes }) => {
    const turn = (list) => list.map((x, i) => (i % 3 === 1 ? x : -x));
    for (const mesh of meshes) {
      mesh.position = turn(mesh.position);
      mesh.targets = Object.fromEntries(Object.entries(mesh.targets).map(([name, deltas]) => [name.replace(/Left$|Right$/, (side) => (side === 'Left' ? 'Right' : 'Left')), turn(deltas)]));
    }
  });
  const { points, notes } = await findPoints(scene, blind);
  assert.match(notes[0], /y up, looking to -z/);
  assert.ok(points.fdp['3.1'][0] > 0 && points.fdp['3.2'][0] < 0 && points.fdp['8.3'][0] > 0, JSON.stringify(points.fdp));
});

test('guesses nothing without a face and shapes', async () => {
  const scene = await read('mara', ({ meshes }) => meshes.forEach((mesh) => (mesh.targets = {})));
  await assert.rejects(findPoints(scene, blind), /no face was found in its views: --points FILE/);
});
