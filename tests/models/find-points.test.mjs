// SPDX-License-Identifier: GPL-3.0-or-later
// Heads without any description: no feature points, names, textures or morph targets, in other axes and units. Their points are found
// close to the known ones, and in the result everything that must close closes.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test, { after } from 'node:test';
import { findPoints } from '../../models/tools/import/face/find-points.mjs';
import { readScene } from '../../models/tools/import/formats/read-scene.mjs';
import { checkEyelids, checkLipsMoveAsOne } from '../../models/tools/lib/check.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { view } from '../../models/tools/lib/visibility.mjs';
import { models } from '../lib/built-heads.mjs';
import { cases } from '../lib/long.mjs';
import { writeGlb, writeObj } from '../lib/plain-files.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-find-'));
const at = (name) => path.join(folder, name);
const load = (file) => unpack(JSON.parse(fs.readFileSync(file, 'utf8')));
const ours = (name) => load(path.join(models, `heads/${name}.json`));
const faccia = (...words) => spawnSync(path.join(build, 'server/cli/faccia'), ['--models', models, 'head', ...words], { encoding: 'utf8', cwd: folder });
after(() => fs.rmSync(folder, { recursive: true }));

const MOUTH = ['2.2', '2.3', '2.4', '2.5', '2.6', '2.7', '2.8', '2.9', '8.1', '8.3', '8.4', '9.15'];
const LIDS = ['3.1', '3.2', '3.3', '3.4', '3.5', '3.6'];
const OTHERS = ['2.1', '2.10', '4.1', '4.2', '4.3', '4.4', '4.5', '4.6', '8.2', '8.5', '8.6', '8.7', '8.8', '9.1', '9.2', '9.3'];

/** As the program finds them, with a mean face that is made of the other heads alone. @returns {Promise<object>} points in mm from between the eyes */
async function foundAlone(name, file, back) {
  const others = fs.readdirSync(path.join(models, 'heads')).filter((one) => one.endsWith('.json') && one !== `${name}.json`).map((one) => path.join(models, 'heads', one));
  assert.equal(others.length, 9);
  const tool = new URL('../../models/tools/import/face/make-template.mjs', import.meta.url).pathname;
  const { stdout } = spawnSync(process.execPath, [tool, path.join(process.env.FACCIA_WEB ?? path.join(build, 'web'), 'face-points.json'), ...others], { encoding: 'utf8', maxBuffer: 1 << 24 });
  const { openEye } = await import(path.join(models, 'tools/import/faccia-eye.mjs'));
  const scene = await readScene(at(file));
  const { points } = await findPoints(scene, await openEye(), { template: JSON.parse(stdout) });
  const eyes = Object.entries({ 3.5: 'eye_l', 3.6: 'eye_r' }).map(([one, part]) => {
    const { ball } = scene.meshes.find((mesh) => mesh.name === part);
    return [one, [ball.centre[0], ball.centre[1], ball.centre[2] + ball.radius]];
  });
  return Object.fromEntries([...Object.entries(points.fdp), ...eyes].map(([one, p]) => [one, back(p)]));
}

for (const [name, file, write, place, back, said] of cases([
  ['mara', 'plain.glb', writeGlb, ([x, y, z]) => [x / 1000, 1.6 + y / 1000, z / 1000], ([x, y, z]) => [1000 * x, 1000 * y - 1600, 1000 * z], /y up, looking to \+z, 1000 mm a unit/],
], [
  ['bruno', 'turned.obj', writeObj, ([x, y, z]) => [x / 10, -z / 10, 160 + y / 10], ([x, y, z]) => [10 * x, 10 * y - 1600, 10 * z], /z up, looking to -y, 10 mm a unit/],
]))
  test(`${name} as ${file}: finds the points, and closes lips and lids`, async (t) => {
    const head = ours(name);
    write(at(file), head, place);
    const { status, stdout, stderr } = faccia('import', at(file), '-o', at(`${name}.json`));
    assert.equal(status, 0, stderr);
    assert.match(stdout, /^feature points found by themselves: 4\d\d of 478 landmarks in 3 views, .* \(sure\)/m);
    assert.match(stdout, said);
    const found = load(at(`${name}.json`));
    const alone = await foundAlone(name, file, back);
    const off = (points) => points.map((one) => Math.hypot(...alone[one].map((x, k) => x - head.fdp[one][k])));
    const mean = (list) => list.reduce((a, b) => a + b) / list.length;
    const figures = Object.fromEntries(Object.entries({ MOUTH, LIDS, OTHERS }).map(([group, points]) => [group, { mean: mean(off(points)), most: Math.max(...off(points)) }]));
    t.diagnostic(`${name}, mm from the true ones: ${JSON.stringify(figures, (_, x) => (typeof x === 'number' ? Number(x.toFixed(1)) : x))}`);
    assert.ok(figures.MOUTH.mean < 3 && figures.MOUTH.most < 6, 'mouth'); // those of the inner lips are kept off the line, on their own lip
    assert.ok(figures.LIDS.most < 5 && LIDS.every((one) => Math.abs(found.fdp[one][1] - head.fdp[one][1]) < 1.2), 'lids'); // along a margin they may lie elsewhere
    assert.ok(figures.OTHERS.mean < 6 && figures.OTHERS.most < 12, 'others'); // a beard hides the chin
    for (const [unit, value] of Object.entries(head.fapu)) assert.ok(Math.abs(found.fapu[unit] / value - 1) < 0.1, `${unit} ${found.fapu[unit]} ${value}`);
    for (const part of ['skin', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower', 'tongue', 'brows', 'lashes', ...(name === 'bruno' ? ['beard'] : [])]) assert.ok(found.parts.some((one) => one.name === part), part);
    assert.deepEqual(checkLipsMoveAsOne(found), []);
    const shows = checkEyelids(found).map((line) => ({ ahead: / at 0 rad/.test(line), count: Number(/: (\d+) points/.exec(line)?.[1] ?? NaN) }));
    t.diagnostic(`between closed lids: ${JSON.stringify(shows)}`);
    // from the front nothing; from the side, where a margin is taken for an arc, a corner's hair of it
    assert.ok(shows.every(({ ahead, count }) => !ahead && count < 30), 'lids');
    const upper = (v) => Object.fromEntries([4, 8, 9, 51, 55, 56].map((fap) => [fap, v]));
    const lower = (v) => Object.fromEntries([5, 10, 11, 52, 57, 58].map((fap) => [fap, v]));
    const inside = (faps) => ['teeth_upper', 'teeth_lower', 'tongue'].reduce((sum, part) => sum + view(found, faps, { yaw: 0, pitch: 0 }).count(part), 0) / 16;
    const closed = [{}, { ...upper(-100), ...lower(100) }].map(inside);
    const open = inside({ ...upper(-200), ...lower(-200), 3: 300 });
    t.diagnostic(`${closed.map((area) => area.toFixed(2)).join(', ')} mm² seen between closed lips, ${open.toFixed(0)} open`);
    assert.ok(closed.every((area) => area < 1) && open > (name === 'mara' ? 80 : 4), `${closed} ${open}`); // a beard hides much of it
    // reports a FAP that is known to do nothing; all others of mouth, jaw, lids and eyes do what they should
    const lines = stdout.split('\n').filter((line) => /^FAP (3|4|5|6|7|8|9|1\d|2[0-6]|5[1-9]|60) /.test(line));
    assert.deepEqual(lines.filter((line) => /does nothing|no vertex/.test(line)), []);
  });

test('a slit between the lips that shows the inside of the head is no lip', async () => {
  const head = ours('mara');
  const parts = ['skin', 'eye_l', 'eye_r'].map((name) => head.parts.find((part) => part.name === name));
  const lower = { 4: -40, 5: -40, 8: -40, 9: -40, 10: -40, 11: -40 };
  writeObj(at('slit.obj'), { parts: parts.map((part) => ({ ...part, position: pose(head, part, lower) })) }, (p) => p);
  const { openEye } = await import(path.join(models, 'tools/import/faccia-eye.mjs'));
  const { points: { fdp } } = await findPoints(await readScene(at('slit.obj')), await openEye());
  for (const name of ['2.2', '2.3', '2.4', '2.5', '2.8', '2.9']) assert.ok(Math.hypot(...fdp[name].map((x, k) => x - head.fdp[name][k])) < 7, `${name}: ${fdp[name]}, not ${head.fdp[name]}`);
});

test('finds the lips of a flat-shaded mesh, whose triangles share no vertex, where those of a smooth one are', async () => {
  const head = ours('mara');
  const { openEye } = await import(path.join(models, 'tools/import/faccia-eye.mjs'));
  const eye = await openEye();
  const split = (part) => ({ ...part, position: Float64Array.from({ length: 3 * part.index.length }, (_, i) => part.position[3 * part.index[Math.floor(i / 3)] + (i % 3)]), index: part.index.map((_, i) => i) });
  const parts = ['skin', 'eye_l', 'eye_r'].map((name) => head.parts.find((part) => part.name === name));
  const found = [];
  for (const [name, own] of [['smooth', (part) => part], ['flat', split]]) {
    writeObj(at(`${name}.obj`), { parts: parts.map(own) }, (p) => p);
    found.push((await findPoints(await readScene(at(`${name}.obj`)), eye)).points.fdp);
  }
  for (const name of ['2.2', '2.3', '2.4', '2.5', '2.6', '2.9']) assert.ok(Math.hypot(...found[0][name].map((x, k) => x - found[1][name][k])) < 1, `${name}: ${found.map((fdp) => fdp[name])}`);
});

test('reports that there is no face; skips the search with --points', () => {
  fs.writeFileSync(at('box.obj'), ['0 0 0', '1 0 0', '1 1 0', '0 1 0', '0 0 1', '1 0 1', '1 1 1', '0 1 1'].map((p) => `v ${p}`).concat(['1 3 2', '1 4 3', '5 6 7', '5 7 8'].map((f) => `f ${f}`)).join('\n'));
  const none = faccia('import', at('box.obj'), '-o', at('never.json'));
  assert.equal(none.status, 1);
  assert.match(none.stderr, /no face was found in its views: --points FILE/);
  assert.ok(!fs.existsSync(at('never.json')));
  fs.writeFileSync(at('points.json'), JSON.stringify({ frame: 'file', fdp: Object.fromEntries(Object.entries(ours('mara').fdp).map(([one, [x, y, z]]) => [one, [x / 1000, 1.6 + y / 1000, z / 1000]])) }));
  const told = faccia('import', at('plain.glb'), '--points', at('points.json'), '-o', at('told.json'));
  assert.equal(told.status, 0, told.stderr);
  assert.ok(!/found by themselves/.test(told.stdout));
});
