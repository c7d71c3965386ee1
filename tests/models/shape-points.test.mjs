// SPDX-License-Identifier: GPL-3.0-or-later
// A head without a detectable face, such as an animal's: its own shapes locate the face, and in the result everything that must close
// closes.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { openEye } from '../../models/tools/import/faccia-eye.mjs';
import { findPoints, liftNose } from '../../models/tools/import/face/find-points.mjs';
import { makeHead } from '../../models/tools/import/make-head.mjs';
import { readScene } from '../../models/tools/import/formats/read-scene.mjs';
import { checkEyelids } from '../../models/tools/lib/check.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { view } from '../../models/tools/lib/visibility.mjs';
import { models } from '../lib/built-heads.mjs';

const blind = async () => null;
const LIPS = new Set([0, 13, 14, 17, 37, 39, 40, 61, 78, 80, 81, 82, 84, 87, 88, 91, 95, 146, 178, 181, 185, 191, 267, 269, 270, 291, 308, 310, 311, 312, 314, 317, 318, 321, 324, 375, 402, 405, 409, 415]);
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

test('a drawn face: its small mouth moves nothing but itself', async () => {
  const mara = unpack(JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json'), 'utf8')));
  let middle = null;
  const scene = await read('mara', ({ meshes }) => {
    const skin = meshes.find(({ name }) => name === 'skin');
    const part = mara.parts.find((one) => one.name === 'skin');
    middle = [0, 1, 2].map((k) => skin.position[k] - part.position[k] / 1000 + (mara.fdp['8.3'][k] + mara.fdp['8.4'][k]) / 2000);
    for (const mesh of meshes) {
      const before = mesh.position.slice();
      for (let v = 0; v < before.length / 3; v++) {
        const far = Math.hypot(before[3 * v] - middle[0], before[3 * v + 1] - middle[1]);
        const share = 0.3 + 0.7 * Math.min(1, far / 0.05) ** 2;
        for (const k of [0, 1]) mesh.position[3 * v + k] = middle[k] + (before[3 * v + k] - middle[k]) * share;
        for (const [name, deltas] of Object.entries(mesh.targets)) if (!/^eye/.test(name)) for (const k of [0, 1, 2]) deltas[3 * v + k] *= far < 0.03 && mesh === skin ? share : 0;
      }
    }
  });
  const { points } = await findPoints(scene, blind);
  const high = (name) => 1000 * (points.fdp[name][1] - middle[1]);
  assert.ok(Math.abs(high('2.2')) < 6 && high('2.1') < -15 && high('9.15') > 6, ['2.1', '2.2', '9.15'].map(high).join());
  const { fapu } = makeHead(scene, points, { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] }).head;
  assert.ok(fapu.MNS > 6 && fapu.ENS > 10, JSON.stringify(fapu));
});

test('a nose that a drawn mouth has drawn down is lifted between mouth and eyes', () => {
  const face = (nose) => ({ 2.2: [0, 10, 8], 3.1: [30, 72, 0], 3.2: [-30, 72, 0], 3.3: [30, 68, 0], 3.4: [-30, 68, 0], 9.15: [0, nose, 9], 9.3: [0, nose + 6, 14], 9.7: [0, nose + 25, 6] });
  const low = face(9);
  liftNose(low);
  assert.ok(Math.abs(low['9.15'][1] - 29.8) < 0.1 && Math.abs(low['9.3'][1] - 35.8) < 0.1 && Math.abs(low['9.7'][1] - 54.8) < 0.1 && low['9.3'][2] === 14, JSON.stringify(low));
  const usual = face(25);
  liftNose(usual);
  assert.deepEqual(usual, face(25));
});

test('guesses nothing without a face and shapes', async () => {
  const scene = await read('mara', ({ meshes }) => meshes.forEach((mesh) => (mesh.targets = {})));
  await assert.rejects(findPoints(scene, blind), /no face was found in its views: --points FILE/);
});

/** A detector that sees landmarks too high by a share of the face's height. */
function mistaken(eye, share, which) {
  return async (picture) => {
    const marks = await eye(picture);
    const up = marks && share * (marks[152][1] - marks[10][1]);
    return marks && marks.map(([u, v, ...more], i) => [u, which(i) ? v - up : v, ...more]);
  };
}

test('a mouth that is seen on the nose gives way to the shapes; without them the file is refused', async () => {
  const { fdp } = unpack(JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json'), 'utf8')));
  const eye = await openEye();
  const lips = mistaken(eye, 0.16, (i) => LIPS.has(i));
  for (const [why, seeing] of [[/for no face was seen/, lips], [/for the mouth was seen \d\d mm beside it/, mistaken(eye, 0.12, () => true)]]) {
    const scene = await read('mara');
    const { points, notes } = await findPoints(scene, seeing);
    assert.match(notes[0], why);
    const { head } = makeHead(scene, points, { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] });
    for (const one of ['2.2', '2.3']) assert.ok(Math.hypot(...head.fdp[one].map((x, k) => x - fdp[one][k])) < 4, `${why} ${one}: ${head.fdp[one]}`);
  }
  const bare = await read('mara', ({ meshes }) => meshes.forEach((mesh) => (mesh.targets = {})));
  await assert.rejects(findPoints(bare, lips), /the mouth was found where a face has none: --points FILE/);
});
