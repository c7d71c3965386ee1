// SPDX-License-Identifier: GPL-3.0-or-later
// Heads as avatars for others: valid glTF, ARKit's 52 shapes and 15 visemes that do what the head does at their FAPs, VRM 1.0, CC0.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import validator from 'gltf-validator';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { models } from '../lib/built-heads.mjs';
import { readGlb } from '../lib/glb.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const { Matrix4, Quaternion, Vector3 } = createRequire(path.join(root, 'web/package.json'))('three');
const build = process.env.FACCIA_BUILD ?? path.join(root, 'build');
const heads = fs.readdirSync(path.join(models, 'heads')).filter((file) => file.endsWith('.json')).map((file) => path.basename(file, '.json'));
const file = (name, kind) => path.join(models, 'heads', `${name}.${kind}`);
const shapes = (name) => JSON.parse(fs.readFileSync(path.join(root, `models/shapes/${name}.json`)));
const arkit = Object.fromEntries(Object.entries(shapes('arkit').shapes).map(([name, { faps }]) => [name, faps]));
const visemes = Object.fromEntries(Object.entries(shapes('visemes').visemes).map(([name, { faps }]) => [`viseme_${name}`, faps]));
const targets = { ...arkit, ...visemes };
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-avatar-'));
after(() => fs.rmSync(folder, { recursive: true }));

test('exports an avatar of each head', () => assert.ok(heads.length >= 10));

for (const name of heads)
  test(`${name} is valid, complete, and openly licensed`, async () => {
    const bytes = fs.readFileSync(file(name, 'glb'));
    const { issues, info } = await validator.validateBytes(new Uint8Array(bytes), { maxIssues: 1000 });
    // Programs for talking heads look for meshes below Armature, which nothing moves.
    assert.deepEqual(issues.messages.filter(({ severity, code }) => severity < 2 && code !== 'NODE_SKINNED_MESH_NON_ROOT'), []);
    // VRM's extension the validator does not know: it is looked at below; a body of bones is empty
    assert.deepEqual([...new Set(issues.messages.map(({ code }) => code))].filter((code) => !['UNSUPPORTED_EXTENSION', 'UNUSED_OBJECT', 'NODE_EMPTY', 'NODE_SKINNED_MESH_NON_ROOT', 'IMAGE_NPOT_DIMENSIONS'].includes(code)), []);
    assert.ok(info.hasMorphTargets && info.hasSkins && info.hasTextures);
    assert.ok(bytes.length < 12e6, `${bytes.length} bytes`);
    const { json } = readGlb(bytes);
    const head = JSON.parse(fs.readFileSync(file(name, 'json')));
    assert.equal(json.asset.copyright, `CC0-1.0. ${head.credits.join('; ')}`);
    assert.deepEqual(json.extras.credits, head.credits);
    const skin = json.meshes.find((mesh) => mesh.name === 'skin');
    assert.deepEqual(skin.extras.targetNames, [...Object.keys(targets), 'breath']);
    assert.deepEqual(json.meshes.map((mesh) => mesh.name), [...head.parts.map((part) => part.name), 'stand']);
    assert.deepEqual(json.meshes.find((mesh) => mesh.name === 'tongue').extras.targetNames.filter((target) => target === 'tongueOut'), ['tongueOut']);
    // cards of hair are dull: with light from all around they would turn grey
    const strands = json.materials.filter(({ alphaMode }) => alphaMode === 'MASK');
    assert.deepEqual(strands.map((look) => look.name).sort(), Object.keys(head.materials).filter((look) => head.materials[look].alpha === 'cutout').sort());
    for (const { doubleSided, pbrMetallicRoughness, extensions } of strands)
      assert.ok(doubleSided && pbrMetallicRoughness.roughnessFactor >= 0.8 && extensions.KHR_materials_specular.specularFactor <= 0.3);
    assert.equal(json.extensionsUsed.includes('KHR_materials_specular'), strands.length > 0);
    for (const { mimeType } of json.images) assert.match(mimeType, /^image\/(png|jpeg)$/);
  });

test('each target matches the head at the FAPs of its definition', () => {
  for (const name of ['mara', 'bruno']) {
    const { json, numbers } = readGlb(fs.readFileSync(file(name, 'glb')));
    const head = unpack(JSON.parse(fs.readFileSync(file(name, 'json'))));
    let most = 0;
    for (const [i, part] of head.parts.entries()) {
      const [{ targets: morphs = [], attributes }] = json.meshes[i].primitives;
      const names = json.meshes[i].extras?.targetNames ?? [];
      const rest = numbers(attributes.POSITION);
      assert.equal(rest.length, part.position.length);
      for (const [target, faps] of Object.entries(targets)) {
        const posed = pose(head, part, faps);
        const at = names.indexOf(target);
        const deltas = at < 0 ? new Float32Array(rest.length) : numbers(morphs[at].POSITION);
        let worst = 0;
        for (let v = 0; v < posed.length; v++) worst = Math.max(worst, Math.abs(deltas[v] * 1000 - (posed[v] - part.position[v])));
        assert.ok(worst < 0.003, `${name}, ${part.name}, ${target}: ${worst} mm`);
        most = Math.max(most, ...deltas);
      }
    }
    assert.ok(most > 0.005, 'something moves');
  }
});

test('a breath lifts chest and shoulders as the head model says, and nothing of the face', () => {
  const { json, numbers } = readGlb(fs.readFileSync(file('mara', 'glb')));
  const head = unpack(JSON.parse(fs.readFileSync(file('mara', 'json'))));
  const breathing = json.meshes.filter(({ extras }) => extras?.targetNames.includes('breath'));
  assert.deepEqual(breathing.map(({ name }) => name).sort(), ['clothes', 'skin']);
  for (const { name, extras, primitives: [{ targets: morphs, attributes }] } of breathing) {
    const deltas = numbers(morphs[extras.targetNames.indexOf('breath')].POSITION).map((x) => 1000 * x);
    const rest = numbers(attributes.POSITION);
    const lifts = Array.from({ length: deltas.length / 3 }, (_, v) => deltas[3 * v + 1]);
    assert.ok(Math.abs(Math.max(...lifts) - head.breath.shift[1]) < 0.05, `${name}: ${Math.max(...lifts)} mm`);
    assert.ok(lifts.every((mm, v) => mm < 0.01 || rest[3 * v + 1] < 1.45), `${name}: below the chin`); // the eyes are 1.55 m above the floor
  }
});

test('exports a VRM 1.0 avatar', () => {
  const { json } = readGlb(fs.readFileSync(file('mara', 'glb')));
  const { meta, humanoid, expressions, lookAt, specVersion } = json.extensions.VRMC_vrm;
  assert.equal(specVersion, '1.0');
  assert.equal(meta.licenseUrl, 'https://vrm.dev/licenses/1.0/');
  assert.match(meta.otherLicenseUrl, /publicdomain\/zero/);
  const limbs = { UpperArm: 'Arm', LowerArm: 'ForeArm', Hand: 'Hand', UpperLeg: 'UpLeg', LowerLeg: 'Leg', Foot: 'Foot' };
  const sides = ['left', 'right'].flatMap((side) => Object.entries(limbs).map(([human, bone]) => [side + human, side[0].toUpperCase() + side.slice(1) + bone]));
  const bones = { hips: 'Hips', spine: 'Spine', head: 'Head', ...Object.fromEntries(sides) };
  for (const [human, bone] of Object.entries(bones)) assert.equal(json.nodes[humanoid.humanBones[human].node].name, bone);
  assert.equal(new Set(Object.values(humanoid.humanBones).map(({ node }) => node)).size, Object.keys(humanoid.humanBones).length);
  assert.equal(lookAt.type, 'bone');
  for (const preset of ['aa', 'ih', 'ou', 'ee', 'oh', 'blink', 'blinkLeft', 'blinkRight', 'lookUp', 'lookDown', 'lookLeft', 'lookRight', 'happy', 'angry', 'sad', 'relaxed', 'surprised', 'neutral']) {
    const { morphTargetBinds } = expressions.preset[preset];
    assert.ok(morphTargetBinds.length || preset === 'neutral', preset);
    for (const { node, index, weight } of morphTargetBinds) {
      const { extras } = json.meshes[json.nodes[node].mesh];
      assert.ok(extras.targetNames[index] && weight > 0 && weight <= 1, preset);
    }
  }
  assert.deepEqual(Object.keys(expressions.custom), Object.keys(arkit));
  const shown = (preset) => new Set(expressions.preset[preset].morphTargetBinds.map(({ node, index }) => json.meshes[json.nodes[node].mesh].extras.targetNames[index]));
  assert.ok(shown('happy').has('mouthSmileLeft') && shown('sad').has('mouthFrownRight') && shown('angry').has('browDownLeft'));
  assert.deepEqual([...shown('aa')], ['viseme_aa']);
});

const SPINE = ['Hips', 'Spine', 'Spine1', 'Spine2', 'Neck', 'Head'];
const LIMBS = ['Shoulder', 'Arm', 'ForeArm', 'Hand', ...['Thumb', 'Index', 'Middle', 'Ring', 'Pinky'].flatMap((finger) => [1, 2, 3].map((i) => `Hand${finger}${i}`)), 'UpLeg', 'Leg', 'Foot', 'ToeBase', 'Eye'];

test('an export has the skeleton that programs for talking heads ask for', () => {
  const { json } = readGlb(fs.readFileSync(file('mara', 'glb')));
  const names = json.nodes.map(({ name }) => name);
  for (const name of ['Armature', ...SPINE, ...['Left', 'Right'].flatMap((side) => LIMBS.map((bone) => side + bone))]) assert.ok(names.includes(name), name);
  assert.equal(json.nodes[json.scenes[0].nodes[0]].name, 'Armature');
  const parent = (i) => json.nodes.findIndex(({ children }) => children?.includes(i));
  const place = (i) => {
    if (i < 0) return new Matrix4();
    const { translation = [0, 0, 0], rotation = [0, 0, 0, 1] } = json.nodes[i];
    return place(parent(i)).multiply(new Matrix4().compose(new Vector3(...translation), new Quaternion(...rotation), new Vector3(1, 1, 1)));
  };
  const at = (name) => new Vector3().setFromMatrixPosition(place(names.indexOf(name)));
  for (const [name, axis, sign] of [['LeftHandMiddle3', 'x', 1], ['RightHandMiddle3', 'x', -1]]) assert.ok(sign * at(name)[axis] > 0.6, `${name} lies at ${at(name).toArray()}`);
  for (const name of ['LeftToeBase', 'RightToeBase']) assert.ok(at(name).y < 0.1 && at(name).z > 0, `${name} lies at ${at(name).toArray()}`);
  assert.ok(at('LeftEye').x > 0.02 && Math.abs(at('LeftEye').y - 1.55) < 0.01);
  // TalkingHead stands an avatar on its lowest mesh
  const stand = names.indexOf('stand');
  assert.equal(names[parent(stand)], 'Hips');
  assert.ok(at('stand').length() < 1e-6 && json.nodes[stand].mesh !== undefined, `the stand is at ${at('stand').toArray()}`);
  const [skin] = json.skins;
  assert.deepEqual(skin.joints.map((i) => names[i]), ['Spine2', 'Head', 'LeftEye', 'RightEye']);
});

/** The first bytes of a PNG that says it is so large. */
function headOfPng(width, height) {
  const bytes = Buffer.alloc(64);
  bytes.write('89504e470d0a1a0a0000000d49484452', 'hex');
  bytes.writeUInt32BE(width, 16);
  bytes.writeUInt32BE(height, 20);
  return bytes.toString('base64');
}

test('refuses a head with a small texture file of gigabytes of pixels before decoding it', () => {
  const head = JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json'), 'utf8'));
  const texture = Object.values(head.textures)[0];
  Object.assign(texture, { type: 'image/png', data: headOfPng(16000, 16000) });
  const bomb = path.join(folder, 'bomb.json');
  fs.writeFileSync(bomb, JSON.stringify(head));
  for (const [tool, out] of [['avatar/export-head.mjs', 'bomb.glb'], ['draw-head.mjs', 'bomb.webp']]) {
    const { status, stderr } = spawnSync('node', [fileURLToPath(new URL(`../../models/tools/${tool}`, import.meta.url)), bomb, path.join(folder, out)], { encoding: 'utf8' });
    assert.notEqual(status, 0, tool);
    assert.match(stderr, /textures: one has 16000 x 16000 (pixels|points): .*\d+/, tool);
    assert.equal(fs.existsSync(path.join(folder, out)), false, tool);
  }
});

test('faccia head export writes avatars, and reports missing ones', () => {
  const faccia = (...args) => spawnSync(path.join(build, 'server/cli/faccia'), ['--models', models, 'head', ...args]);
  const [glb, vrm] = ['mara.glb', 'mara.vrm'].map((name) => path.join(folder, name));
  const { status, stderr } = faccia('export', 'mara', '--glb', glb, '--vrm', vrm);
  assert.equal(status, 0, String(stderr));
  const bytes = fs.readFileSync(file('mara', 'glb'));
  assert.ok(fs.readFileSync(glb).equals(bytes) && fs.readFileSync(vrm).equals(bytes));
  assert.equal(spawnSync('sh', ['-c', '"$0" --models "$1" head export mara | cmp - "$1/heads/mara.glb"', path.join(build, 'server/cli/faccia'), models]).status, 0);
  for (const [args, code, what] of [
    [['export', 'nobody'], 1, /unknown head model 'nobody'/],
    [['export', '../speech/it'], 1, /unknown head model/],
    [['export'], 2, /the name of one head/],
    [['bring', 'mara'], 2, /expected 'export'/],
    [['export', 'mara', '--glb', path.join(folder, 'no/where.glb')], 1, /No such file/],
  ]) {
    const said = faccia(...args);
    assert.equal(said.status, code, args.join(' '));
    assert.match(String(said.stderr), what);
  }
});
