// SPDX-License-Identifier: GPL-3.0-or-later
// Feature points told by landmarks: which vertex each of a mesh's landmarks is (nothing is looked for then), single points by a landmark that is found, and
// some points told while the others are found.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test, { after, before } from 'node:test';
import { checkEyelids, checkLipsMoveAsOne } from '../../models/tools/lib/check.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { models } from '../lib/built-heads.mjs';
import { cases, further } from '../lib/long.mjs';
import { writeGlb, writeObj } from '../lib/plain-files.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const web = process.env.FACCIA_WEB ?? path.join(build, 'web');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-told-'));
const at = (name) => path.join(folder, name);
const load = (file) => unpack(JSON.parse(fs.readFileSync(file, 'utf8')));
const mara = load(path.join(models, 'heads/mara.json'));
const landmarks = JSON.parse(fs.readFileSync(path.join(web, 'face-points.json'), 'utf8')).mara.at;
const faccia = (...words) => spawnSync(path.join(build, 'server/cli/faccia'), ['--models', models, 'head', ...words], { encoding: 'utf8', cwd: folder });
/** The 68 of 300-W by the face mesh, as published elsewhere than in our table: where both have a jaw they differ along it. */
const IBUG = '127 234 93 58 172 136 149 148 152 377 378 365 397 288 323 454 356 70 63 105 66 107 336 296 334 293 300 168 197 5 4 75 97 2 326 305 33 160 158 133 153 144 362 385 387 263 373 380 61 39 37 0 267 269 291 405 314 17 84 181 78 82 13 312 308 317 14 87'.split(' ').map(Number);

const skin = mara.parts.find(({ name }) => name === 'skin');
const nearest = (p) => {
  let [best, least] = [0, Infinity];
  for (let v = 0; v < skin.position.length / 3; v++) {
    const far = Math.hypot(...p.map((x, k) => x - skin.position[3 * v + k]));
    if (far < least) [best, least] = [v, far];
  }
  return best;
};
const vertices = landmarks.map((p) => p && nearest(p));
const MOUTH = ['2.2', '2.3', '8.1', '8.2', '8.3', '8.4', '9.15'];
const OTHERS = ['2.1', '4.1', '4.2', '4.3', '4.4', '9.3'];

before(() => {
  writeGlb(at('plain.glb'), mara, ([x, y, z]) => [x / 1000, 1.6 + y / 1000, z / 1000]);
  writeObj(at('turned.obj'), mara, ([x, y, z]) => [x / 10, -z / 10, 160 + y / 10]);
});
after(() => fs.rmSync(folder, { recursive: true }));

function imported(file, points, ...more) {
  fs.writeFileSync(at('points.json'), JSON.stringify(points));
  const { status, stdout, stderr } = faccia('import', at(file), '--points', at('points.json'), '-o', at('out.json'), ...more);
  assert.equal(status, 0, stderr);
  return { head: load(at('out.json')), said: stdout };
}

/** From the true points: mm of those of the mouth, and of others, in the mean; laid by the eyes, which both have. */
const missed = (head, names) => names.reduce((sum, name) => sum + Math.hypot(...head.fdp[name].map((x, k) => x - mara.fdp[name][k])) / names.length, 0);

for (const [file, landmarked, most] of cases([
  ['plain.glb', { scheme: 'mediapipe', vertices }, [1.8, 3]],
  ['turned.obj', { scheme: 'ibug', vertices: IBUG.slice(17).map((i) => vertices[i]) }, [2, 6]],
], [
  ['turned.obj', { scheme: 'mediapipe', vertices: vertices.slice(0, 468) }, [1.8, 3]],
  ['plain.glb', { scheme: 'ibug', vertices: IBUG.map((i) => vertices[i]) }, [2, 4.5]],
]))
  test(`accepts ${file} with ${landmarked.vertices.length} landmarks in the numbering of ${landmarked.scheme}`, (t) => {
    const { head, said } = imported(file, { landmarks: landmarked });
    assert.match(said, /^feature points by \d+ landmarks, /m);
    assert.match(said, file === 'plain.glb' ? /y up, looking to \+z, 1000 mm a unit/ : /z up, looking to -y, 10 mm a unit/);
    const off = [missed(head, MOUTH), missed(head, OTHERS)];
    t.diagnostic(`mouth ${off[0].toFixed(1)} mm, others ${off[1].toFixed(1)} mm from the true ones`);
    assert.ok(off[0] < most[0] && off[1] < most[1], `${off}`);
    for (const [unit, value] of Object.entries(mara.fapu)) assert.ok(Math.abs(head.fapu[unit] / value - 1) < 0.08, `${unit} ${head.fapu[unit]} ${value}`);
    assert.deepEqual(checkLipsMoveAsOne(head), []);
    assert.ok(checkEyelids(head).every((line) => !/ at 0 rad/.test(line)));
    for (const part of ['skin', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower', 'tongue', 'brows', 'lashes']) assert.ok(head.parts.some((one) => one.name === part), part);
  });

test('accepts single points by a landmark or a vertex, and finds the others', further, () => {
  const { head, said } = imported('plain.glb', { find: true, fdp: { '2.1': vertices[152], '8.4': { landmark: 61 }, '4.1': [0.01, 1.65, 0.03] } });
  assert.match(said, /^feature points found by themselves: 4\d\d of 478/m);
  assert.match(said, /^feature points as they were told: 2\.1, 4\.1, 8\.4$/m);
  assert.ok(Math.hypot(...[0, 1, 2].map((k) => head.fdp['2.1'][k] - skin.position[3 * vertices[152] + k])) < 0.8, `${head.fdp['2.1']} ${skin.position.slice(3 * vertices[152], 3 * vertices[152] + 3)}`);
  assert.ok(Math.hypot(head.fdp['4.1'][0] - 10, head.fdp['4.1'][1] - 50) < 4, `${head.fdp['4.1']}`);
  assert.ok(missed(head, ['8.4']) < 3 && missed(head, ['8.3']) < 3);
});

test('reports errors in a list of landmarks with their position, and writes nothing', () => {
  const swapped = [...vertices];
  for (const i of swapped.keys()) {
    const [x, y, z] = landmarks[i] ?? [0, 0, 0];
    swapped[i] = landmarks[i] && vertices[landmarks.reduce((best, p, j) => (p && Math.hypot(p[0] + x, p[1] - y, p[2] - z) < best[0] ? [Math.hypot(p[0] + x, p[1] - y, p[2] - z), j] : best), [Infinity, 0])[1]];
  }
  for (const [points, pattern] of [
    [{ landmarks: { scheme: 'dlib', vertices } }, /landmarks\.scheme: must be one of mediapipe, ibug/],
    [{ landmarks: { scheme: 'ibug', vertices } }, /landmarks\.vertices: must be a list of 51 or 68/],
    [{ landmarks: { scheme: 'mediapipe', vertices: [...vertices.slice(0, 467), 'x'] } }, /landmarks\.vertices\[467\]: must be/],
    [{ landmarks: { scheme: 'mediapipe', vertices: [...vertices.slice(0, 467), 99999999] } }, /landmarks\.vertices\[467\]: there is no vertex 99999999/],
    [{ landmarks: { scheme: 'mediapipe', vertices: vertices.map((v, i) => (i < 9 ? v : null)) } }, /landmarks: 9 are too few/],
    [{ landmarks: { scheme: 'mediapipe', vertices: swapped } }, /landmarks: they are no face: \d+ mm/],
    [{ landmarks: { scheme: 'mediapipe', vertices: vertices.map((_, i) => i) } }, /landmarks: they are no face/],
    [{ landmarks: 7 }, /landmarks: must have a scheme/],
    [{ fdp: { '2.1': { landmark: 478 } } }, /fdp\.2\.1: must be .* a landmark \(0 to 477\)/],
    [{ frame: 'head', fdp: { '2.1': { landmark: 152 } } }, /frame: must be file/],
  ]) {
    fs.writeFileSync(at('points.json'), JSON.stringify(points));
    const { status, stderr } = faccia('import', at('plain.glb'), '--points', at('points.json'), '-o', at('never.json'));
    assert.equal(status, 1, JSON.stringify(points).slice(0, 80));
    assert.match(stderr, pattern);
    assert.ok(!fs.existsSync(at('never.json')) && !/\n {4}at /.test(stderr), stderr);
  }
});
