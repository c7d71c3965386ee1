// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes in files of their own, with the vertices of the head at rest: the 37 models of Turkish letters (METU 2004), and ARKit's.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test, { after } from 'node:test';
import { readScene } from '../../models/tools/import/formats/read-scene.mjs';
import { addShapes } from '../../models/tools/import/formats/shape-files.mjs';
import { ARKIT, LETTERS } from '../../models/tools/avatar/shapes.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { models } from '../lib/built-heads.mjs';
import { writeObj } from '../lib/plain-files.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-shape-files-'));
const at = (...names) => path.join(folder, ...names);
const load = (file) => unpack(JSON.parse(fs.readFileSync(file, 'utf8')));
const rosa = load(path.join(models, 'heads/rosa.json'));
const parts = ['skin', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower'].map((name) => rosa.parts.find((part) => part.name === name));
const posed = (faps) => ({ parts: parts.map((part) => ({ ...part, position: pose(rosa, part, faps) })) });
const faccia = (...words) => spawnSync(path.join(build, 'server/cli/faccia'), ['--models', models, 'head', 'import', ...words], { encoding: 'utf8', cwd: folder });
const metres = ([x, y, z]) => [x / 1000, y / 1000, z / 1000];
after(() => fs.rmSync(folder, { recursive: true }));

fs.writeFileSync(at('points.json'), JSON.stringify({
  frame: 'file', fdp: Object.fromEntries(Object.entries(rosa.fdp).map(([name, p]) => [name, metres(p)])), parts: Object.fromEntries(parts.map(({ name }, i) => [`thing${i}`, name])),
}));

/** A set of meshes, spoken broader than faccia's own: 1.3 times. */
function writeSet(name, shapes) {
  fs.mkdirSync(at(name));
  for (const [one, faps] of Object.entries(shapes)) writeObj(at(name, `${one}.obj`), posed(Object.fromEntries(Object.entries(faps).map(([fap, value]) => [fap, 1.3 * value]))), metres);
}

/** Distance of the lips and what is about them from the meshes that were given, mm: root mean square and largest. */
function apart(head, faps) {
  const [part] = head.parts;
  const [own, theirs] = [pose(head, part, faps), pose(rosa, parts[0], Object.fromEntries(Object.entries(faps).map(([fap, value]) => [fap, 1.3 * value])))];
  let [most, sum, count] = [0, 0, 0];
  for (let v = 0; v < own.length; v += 3) {
    if (Math.hypot(...[0, 1, 2].map((k) => part.position[v + k] - rosa.fdp['2.2'][k])) > 40) continue;
    const off = Math.hypot(...[0, 1, 2].map((k) => own[v + k] - part.position[v + k] - (theirs[v + k] - parts[0].position[v + k])));
    [most, sum, count] = [Math.max(most, off), sum + off * off, count + 1];
  }
  return { most, rms: Math.sqrt(sum / count) };
}

test('the 37 meshes of Turkish letters are a head that speaks them', (t) => {
  writeSet('letters', Object.fromEntries(Object.entries(LETTERS).map(([name, faps]) => [name.replace('letter_', ''), faps])));
  const { status, stdout, stderr } = faccia(at('letters', 'neutral.obj'), '--shapes', at('letters'), '--points', at('points.json'), '-o', at('letters.json'));
  assert.equal(status, 0, stderr);
  assert.match(stdout, /actions from 36 morph targets/);
  const plain = faccia(at('letters', 'neutral.obj'), '--points', at('points.json'), '-o', at('plain.json'));
  assert.equal(plain.status, 0, plain.stderr);
  const [own, zones] = ['letters', 'plain'].map((name) => load(at(`${name}.json`))).map((head) => Object.entries(LETTERS).map(([name, faps]) => ({ name, ...apart(head, faps) })));
  const mean = (list) => list.reduce((sum, { rms }) => sum + rms, 0) / list.length;
  const [worst] = [...own].sort((a, b) => b.rms - a.rms);
  t.diagnostic(`lips ${mean(own).toFixed(2)} mm from the meshes on average, without their shapes ${mean(zones).toFixed(2)}; ${worst.name} ${worst.rms.toFixed(2)}`);
  assert.ok(mean(own) < 0.7 && mean(own) < mean(zones) / 3, `${mean(own)}, ${mean(zones)}`);
  for (const { name, rms, most } of own) assert.ok(rms < 1.3 && most < 3.2, `${name}: ${rms}, ${most}`);
});

test('meshes named as ARKit names shapes', () => {
  const some = ['jawOpen', 'mouthFunnel', 'mouthSmileLeft', 'eyeBlinkLeft'];
  fs.mkdirSync(at('arkit'));
  for (const name of some) writeObj(at('arkit', `${name}.obj`), posed(ARKIT[name]), metres);
  fs.writeFileSync(at('arkit', 'readme.txt'), 'no mesh');
  writeObj(at('rest.obj'), posed({}), metres);
  const { status, stdout, stderr } = faccia(at('rest.obj'), '--shapes', at('arkit'), '--points', at('points.json'), '-o', at('arkit.json'));
  assert.equal(status, 0, stderr);
  assert.match(stdout, /actions from 4 morph targets/);
});

test('a polygon that a shape bends is still the same face', async () => {
  fs.mkdirSync(at('bent'));
  const mesh = (x, faces) => `v 0 0 0\nv 1 0 0\nv ${x} ${x} 0\nv 0 1 0\nv 2 0 0\nv 2 1 1\n${faces.map((one) => `f ${one}\n`).join('')}`;
  const faces = ['2 3 4 1', '2 5 6 3'];
  fs.writeFileSync(at('flat.obj'), mesh(1, faces));
  const shaped = async (text) => {
    const scene = await readScene(at('flat.obj'));
    fs.writeFileSync(at('bent', 'jawOpen.obj'), text);
    const before = [...scene.meshes[0].index];
    assert.notDeepEqual([...(await readScene(at('bent', 'jawOpen.obj'))).meshes[0].index], before, 'it is cut otherwise');
    await addShapes(scene, at('bent'), at('flat.obj'));
    assert.deepEqual([...scene.meshes[0].index], before);
    return scene.meshes[0].targets.jawOpen;
  };
  assert.ok(Math.abs((await shaped(mesh(0.3, faces)))[3] + 0.7) < 1e-9);
  await assert.rejects(shaped(mesh(1, ['2 3 4 1', '2 5 6', '2 6 1'])), /jawOpen|faces are not/);
});

test('names the file whose mesh is another', () => {
  fs.mkdirSync(at('wrong'));
  fs.mkdirSync(at('empty'));
  const fails = (shapes, said) => {
    const { status, stderr } = faccia(at('rest.obj'), '--shapes', at(shapes), '--points', at('points.json'), '-o', at('never.json'));
    assert.equal(status, 1);
    assert.match(stderr, said);
    assert.ok(!fs.existsSync(at('never.json')));
  };
  writeObj(at('rest.obj'), posed({}), metres);
  fails('empty', /empty: there is no mesh in it/);
  fails('nowhere', /nowhere/);
  const [skin, ...others] = posed({}).parts;
  for (const [name, mesh, said] of [
    ['less', { parts: [skin] }, /less\.obj: has 1 meshes, the head at rest has 5/],
    ['short', { parts: [{ ...skin, position: skin.position.slice(0, 9), index: [0, 1, 2] }, ...others] }, /short\.obj: thing0: has 3 vertices/],
    ['turned', { parts: [{ ...skin, index: [...skin.index].reverse() }, ...others] }, /turned\.obj: thing0: /],
  ]) {
    writeObj(at('wrong', `${name}.obj`), mesh, metres);
    fails('wrong', said);
    fs.rmSync(at('wrong', `${name}.obj`));
  }
});
