// SPDX-License-Identifier: MIT
// Avatars without a browser: names, mapping files, the solver, and what is found on a mesh.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { BoxSquares } from '../../../web/element/avatar/box-squares.mjs';
import { modelOf } from '../../../web/element/avatar/avatar.mjs';
import { readMap } from '../../../web/element/avatar/map.mjs';
import { ARKIT, boneOf, mirrored, presetOf, rowShapes, shapeOf, shapesAmong } from '../../../web/element/avatar/names.mjs';
import { faceValues } from '../../../web/element/face/face-mixer.mjs';
import { models } from '../../lib/built-heads.mjs';
import { partsOf, writeGlb } from '../../lib/foreign-avatars.mjs';
import { violations } from '../../lib/schema.mjs';

const root = fileURLToPath(new URL('../../../', import.meta.url));
globalThis.createImageBitmap ??= async () => ({ width: 1, height: 1, close() {} }); // nothing is drawn here

test('the shapes are those of models/shapes', () => {
  const { shapes } = JSON.parse(fs.readFileSync(path.join(root, 'models/shapes/arkit.json')));
  assert.deepEqual([...ARKIT].sort(), Object.keys(shapes).sort());
});

test('recognises the shape names of avatars', () => {
  const known = {
    jawOpen: 'jawOpen', JawOpen: 'jawOpen', 'blendShape1.jawOpen': 'jawOpen', mouthSmile_L: 'mouthSmileLeft', eyeBlinkRight: 'eyeBlinkRight',
    'Face.eye_blink_right': 'eyeBlinkRight', viseme_PP: 'viseme_PP', 'vrc.v_pp': 'viseme_PP', 'vrc.v_ou': 'viseme_U', viseme_I: 'viseme_I',
    eyesClosed: 'eyeBlink', mouthLeft: 'mouthLeft', mouthOpen: 'mouthOpen', Fcl_MTH_A: null, big_hat: null, E: null, '': null,
    'Head_blendShape.jawOpen': 'jawOpen', 'h_expressions.JawOpen_h': 'jawOpen', AK_09_EyeBlinkLeft: 'eyeBlinkLeft', Genesis8Female__facs_jnt_JawOpen: 'jawOpen', L_eyeBlink: 'eyeBlinkLeft',
    Eye_Blink_L: 'eyeBlinkLeft', Left_EyeBlink: 'eyeBlinkLeft', 'vrc.blink_left': 'eyeBlinkLeft', Fcl_EYE_Close_R: 'eyeBlinkRight', Fcl_EYE_Close: 'eyeBlink', Smile_Left: 'mouthSmileLeft',
    jaw_L: 'jawLeft', browInnerUpRight: 'browInnerUp', teeth_jawOpen: 'jawOpen', mouth_jawOpen: 'jawOpen', 'jawOpen.001': 'jawOpen', あ: 'vowel_aa', まばたき: 'eyeBlink',
    Fcl_EYE_Joy: null, jawOpen_mouthSmile: null, jawOpen_fix: null, jawOpenLeft: null, mouthOpenWide: null, 'vrc.lowerlid_left': null, eyesLookUp: null, Mouth_Up: null,
  };
  for (const [name, shape] of Object.entries(known)) assert.equal(shapeOf(name), shape, name);
  assert.deepEqual(['a', 'ee', 'Blink_L', 'blinkRight', 'happy', 'JawOpen'].map(presetOf), ['vowel_aa', 'vowel_ee', 'eyeBlinkLeft', 'eyeBlinkRight', null, 'jawOpen']);
  assert.equal(rowShapes(['A', 'I', 'U', 'E']).size, 0);
  assert.deepEqual([...rowShapes(['A', 'I', 'U', 'E', 'O', 'aa']).keys()], ['A', 'I', 'U', 'E', 'O']);
  assert.equal(rowShapes(['Fcl_MTH_A', 'Fcl_MTH_I', 'Fcl_MTH_U', 'Fcl_MTH_E', 'Fcl_MTH_O', 'Fcl_ALL_A']).get('Fcl_MTH_U'), 'vowel_ou');
  assert.equal(rowShapes(['SIL', 'PP', 'FF', 'TH', 'DD', 'KK', 'CH', 'SS', 'NN', 'RR', 'AA', 'E', 'IH', 'OH', 'OU']).get('OU'), 'viseme_U');
  assert.equal(rowShapes(['AA_VI_01_PP', 'AA_VI_02_FF', 'AA_VI_03_TH', 'AA_VI_04_DD', 'AA_VI_05_KK', 'AA_VI_06_CH', 'AA_VI_10_aa']).get('AA_VI_10_aa'), 'viseme_aa');
  assert.deepEqual([...shapesAmong(['jawOpen', 'a_jawOpen_50', 'x_mouthClose'], new Map())], [['jawOpen', 'jawOpen'], ['x_mouthClose', 'mouthClose']], 'the plainest');
  const bones = { head: 'head', 'mixamorig:Head': 'head', J_Bip_C_Head: 'head', Jaw: 'jaw', LeftEye: 'leftEye', eye_r: 'rightEye', forehead: null, HeadTop_End: null, jawbreaker: null, mixamorigHead: 'head', CC_Base_JawRoot: 'jaw', CC_Base_L_Eye: 'leftEye', J_Adj_R_FaceEye: 'rightEye', 'DEF-eye.L': 'leftEye', 'Bip01 Head': 'head', chin_bone: 'jaw', Upper_Jaw: null, L_eyelid: null, EyeLash_L: null, Neck02_end: null };
  for (const [name, bone] of Object.entries(bones)) assert.equal(boneOf(name), bone, name);
  assert.deepEqual(['mouthSmileLeft', 'jawOpen', 'viseme_aa'].map(mirrored), ['mouthSmileRight', 'jawOpen', 'viseme_aa']);
});

test('mapping files: reader and schema accept the same', () => {
  const whole = { format: 'faccia-avatar-map', version: 1 };
  const cases = [
    [whole, true],
    [{ ...whole, shapes: { jawOpen: 'A', viseme_PP: { B: 0.5, C: 1 }, eyeBlink: 'lids' }, bones: { jaw: 'J' }, others: false }, true],
    [{ ...whole, version: 2 }, false],
    [{ ...whole, shapes: { jawOpen: 3 } }, false],
    [{ ...whole, shapes: { jawOpen: { A: '1' } } }, false],
    [{ ...whole, shapes: { smell: 'A' } }, false],
    [{ ...whole, shapes: [] }, false],
    [{ ...whole, bones: { tail: 'A' } }, false],
    [{ ...whole, bones: { head: 1 } }, false],
    [[], false],
    [null, false],
  ];
  for (const [map, right] of cases) {
    const bytes = new TextEncoder().encode(JSON.stringify(map));
    assert.equal(violations('avatar-map', map) === null, right, JSON.stringify(map));
    if (right) assert.doesNotThrow(() => readMap(bytes));
    else assert.throws(() => readMap(bytes), { reason: 'bad-map' });
  }
  assert.throws(() => readMap(new Uint8Array([1, 2, 3])), { reason: 'bad-map' });
});

test('least squares within a box: no step inside it is better', () => {
  let seed = 7;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647 - 0.5;
  for (let n = 1; n < 30; n += 4) {
    const a = Array.from({ length: 2 * n }, () => Array.from({ length: n }, random));
    const gram = Array.from({ length: n }, (_, i) => Float64Array.from({ length: n }, (_x, k) => a.reduce((sum, row) => sum + row[i] * row[k], i === k ? 0.01 : 0)));
    const squares = new BoxSquares(gram);
    for (let round = 0; round < 5; round++) {
      const right = Float64Array.from({ length: n }, () => 3 * random());
      const x = squares.solve(right);
      x.forEach((value, i) => {
        const gradient = gram[i].reduce((sum, one, k) => sum + one * x[k], -right[i]);
        assert.ok(value >= 0 && value <= 1);
        if (value > 0) assert.ok(gradient < 1e-6, `${value} ${gradient}`);
        if (value < 1) assert.ok(gradient > -1e-6, `${value} ${gradient}`);
      });
    }
  }
});

const glb = () => fs.readFileSync(path.join(models, 'heads/mara.glb'));
const SIDES = [[6, 7], [8, 9], [10, 11], [12, 13], [19, 20], [21, 22], [31, 32], [33, 34], [35, 36], [37, 38], [39, 40], [41, 42]];

test('finds points and measures of a mesh by what its shapes move', async () => {
  const { head, title, credits } = await modelOf(new Uint8Array(glb()), readMap(null), 'mara.glb');
  const { fdp, fapu, title: own } = JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json')));
  assert.equal(title, own);
  assert.match(credits[0], /^CC0-1\.0/);
  const { rest } = head.found;
  const far = (point, name) => Math.hypot(...rest[point].map((value, k) => value - fdp[name][k]));
  for (const [point, name] of [['upper', '2.2'], ['lower', '2.3'], ['cornerL', '2.4'], ['cornerR', '2.5'], ['upperL', '2.6'], ['lowerR', '2.9'], ['lidTopL', '3.1'], ['lidBottomR', '3.4'], ['browInL', '4.1'], ['browOutR', '4.6']])
    assert.ok(far(point, name) < 8, `${point}: ${far(point, name)} mm from ${name}`);
  for (const [unit, share] of [['ES', 0.02], ['MW', 0.1], ['MNS', 0.15], ['ENS', 0.15]]) assert.ok(Math.abs(head.found.fapu[unit] / fapu[unit] - 1) < share, `${unit} ${head.found.fapu[unit]}`);
  const { solver } = head;
  const weights = (faps) => Object.fromEntries(solver.names.map((name, i) => [name, solver.solve(faps)[i]]));
  const { shapes } = JSON.parse(fs.readFileSync(path.join(root, 'models/shapes/arkit.json')));
  for (const name of ['jawOpen', 'eyeBlinkLeft', 'mouthSmileRight', 'browInnerUp', 'jawLeft']) {
    const found = weights(faceValues(shapes[name].faps));
    assert.ok(found[name] > 0.6, `${name}: ${found[name]}`);
  }
  assert.deepEqual(Object.values(weights(faceValues({}))).filter((weight) => weight > 1e-9), []);
  const askew = faceValues({ 3: 200, 4: -60, 5: -200, 8: -90, 9: -40, 10: -160, 11: -120, 12: 90, 6: 60, 19: 300, 31: 100, 16: 40 });
  const mirror = faceValues(Object.fromEntries([...askew.entries()].map(([n, value]) => [SIDES.flatMap(([l, r]) => (l === n ? r : r === n ? l : [])).at(0) ?? n, value])));
  const first = weights(askew);
  const other = weights(mirror);
  for (const name of solver.names) assert.ok(Math.abs(first[name] - other[mirrored(name)]) < 1e-6, name);
  const blink = (share) => Object.values(weights(faceValues({ 19: 940 * share, 20: 940 * share, 21: 84 * share, 22: 84 * share }))).map((x) => x.toFixed(6));
  assert.deepEqual(blink(2), blink(1), 'lids that are asked for more than to meet drag nothing along');
  assert.deepEqual(Object.values(weights(askew)).map((x) => x.toFixed(6)), Object.values(first).map((x) => x.toFixed(6)), 'whatever came before');
});

test('accepts an avatar of any size and direction, with its lips parted at rest', async () => {
  const plain = (await modelOf(new Uint8Array(glb()), readMap(null))).head.solver;
  const solved = (solver) => Array.from(solver.solve(faceValues({ 3: 200, 4: -60, 5: -200, 8: -60, 9: -60, 10: -160, 11: -160 })));
  const wanted = solved(plain);
  for (const node of [{ scale: [100, 100, 100] }, { rotation: [0, Math.SQRT1_2, 0, Math.SQRT1_2] }]) {
    const parts = partsOf(glb());
    parts.json.nodes.push({ ...node, children: parts.json.scenes[0].nodes });
    parts.json.scenes[0].nodes = [parts.json.nodes.length - 1];
    const { head } = await modelOf(new Uint8Array(writeGlb(parts)), readMap(null));
    assert.ok(head.found.fapu.ES > 50 && head.found.fapu.ES < 65, `${head.found.fapu.ES}`);
    solved(head.solver).forEach((weight, i) => assert.ok(Math.abs(weight - wanted[i]) < 0.15, `${plain.names[i]} ${weight} ${wanted[i]}`));
  }
  const parts = partsOf(glb());
  const skin = parts.json.meshes.find(({ name }) => name === 'skin');
  // a shape of no name that is known here is as its maker left it
  for (const { targets } of skin.primitives) targets.push(targets[skin.extras.targetNames.indexOf('jawOpen')]);
  skin.weights = [...skin.extras.targetNames.map(() => 0), 0.12];
  skin.extras.targetNames.push('Sculpt 7');
  const { head } = await modelOf(new Uint8Array(writeGlb(parts)), readMap(null));
  assert.ok(head.solver.parted > 0.05, 'it is seen');
  head.setFaps(faceValues({}));
  assert.ok(Math.max(...head.solver.opened) < 0.1, 'and closed');
});

test('an avatar with a breath breathes, and moves its face no more by that', async () => {
  const { head } = await modelOf(glb(), readMap(null));
  const weights = () => head.meshes.map(({ morphTargetInfluences = [], morphTargetDictionary = {} }) => Object.fromEntries(Object.entries(morphTargetDictionary).map(([name, i]) => [name, morphTargetInfluences[i]])));
  head.setFaps(faceValues({ 3: 300 }));
  const before = weights();
  head.setFaps(faceValues({ 0: 0.75, 3: 300 }));
  const after = weights();
  assert.equal(after.filter(({ breath }) => breath === 0.75).length, 2);
  assert.deepEqual(after.map((all) => ({ ...all, breath: 0 })), before.map((all) => ({ ...all, breath: 0 })));
});

test('uses expressions of VRM 1.0 where targets have no names', async () => {
  const parts = partsOf(glb());
  for (const mesh of parts.json.meshes) delete mesh.extras;
  const { expressions } = parts.json.extensions.VRMC_vrm;
  delete expressions.custom;
  const { head } = await modelOf(new Uint8Array(writeGlb(parts)), readMap(null), 'a.vrm');
  assert.deepEqual(head.solver.names.slice(0, 5).sort(), ['vowel_aa', 'vowel_ee', 'vowel_ih', 'vowel_oh', 'vowel_ou']);
  assert.deepEqual(Object.keys(head.controls.bones).sort(), ['head', 'leftEye', 'neck', 'rightEye']);
  head.setFaps(faceValues({ 3: 300, 4: -100, 5: -300, 8: -80, 9: -80, 10: -250, 11: -250 }));
  assert.ok(head.solver.opened[0] > 3);
  head.setFaps(faceValues({ 3: 300 }));
  assert.ok(head.solver.opened[0] < 0.1);
});
