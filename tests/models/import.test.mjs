// SPDX-License-Identifier: GPL-3.0-or-later
// Importing heads through the program: an exported head comes back unchanged, zones are derived where a file has none, and errors
// for broken and malicious files.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test, { after, before } from 'node:test';
import { PNG } from 'pngjs';
import { ARKIT, VISEMES } from '../../models/tools/avatar/shapes.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { view } from '../../models/tools/lib/visibility.mjs';
import { checkEyelids, checkLipsMoveAsOne, checkNeutral } from '../../models/tools/lib/check.mjs';
import { readScene } from '../../models/tools/import/formats/read-scene.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';
import { models } from '../lib/built-heads.mjs';
import { writeHeadFiles } from '../lib/head-files.mjs';
import { binaryFbx, textFbx } from '../lib/fbx.mjs';
import { partsOf, writeGlb } from '../lib/foreign-avatars.mjs';
import { further } from '../lib/long.mjs';
import { packed } from '../lib/packed-avatars.mjs';
import { oldLook } from '../lib/strange-cases.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-import-'));
const at = (name) => path.join(folder, name);
const load = (file) => unpack(JSON.parse(fs.readFileSync(file, 'utf8')));
const mara = load(path.join(models, 'heads/mara.json'));
const faccia = (...words) => spawnSync(path.join(build, 'server/cli/faccia'), ['--models', models, 'head', ...words], { encoding: 'utf8', cwd: folder });

function imported(out, ...words) {
  const { status, stdout, stderr } = faccia('import', ...words, '-o', at(out));
  assert.equal(status, 0, stderr);
  readModel(JSON.parse(fs.readFileSync(at(out), 'utf8')));
  return { head: load(at(out)), said: stdout };
}

before(() => writeHeadFiles(mara, folder));
after(() => fs.rmSync(folder, { recursive: true }));

/** Compares a part of a pose with the same part of another head: largest and root mean square distance, mm. */
function apart(a, b, name, faps) {
  const [p, q] = [a, b].map((head) => pose(head, head.parts.find((part) => part.name === name), faps));
  assert.equal(p.length, q.length);
  let [most, sum] = [0, 0];
  for (let v = 0; v < p.length; v += 3) {
    const d = Math.hypot(p[v] - q[v], p[v + 1] - q[v + 1], p[v + 2] - q[v + 2]);
    most = Math.max(most, d);
    sum += d * d;
  }
  return { most, mean: Math.sqrt(sum / (p.length / 3)) };
}

test('reimports a head exported as GLB: the same FAPs, the same face', (t) => {
  const { head, said } = imported('back.json', path.join(models, 'heads/mara.glb'));
  assert.match(said, /actions from 6\d morph targets/);
  assert.deepEqual(head.parts.map(({ name }) => name).sort(), mara.parts.map(({ name }) => name).sort());
  assert.equal(head.licence, mara.licence);
  assert.ok(head.textures.skin.data.length > 1000);
  for (const [unit, value] of Object.entries(mara.fapu)) assert.ok(Math.abs(head.fapu[unit] - value) < 0.01, unit);
  for (const { name } of mara.parts) assert.ok(apart(mara, head, name, {}).most < 0.01, `${name} at rest`);
  const far = Object.entries({ ...ARKIT, ...VISEMES }).map(([name, faps]) => ({ name, ...apart(mara, head, 'skin', faps) }));
  const worst = far.reduce((a, b) => (b.most > a.most ? b : a));
  t.diagnostic(`skin, ${far.length} shapes and visemes: at most ${worst.most.toFixed(2)} mm (${worst.name}), root mean square ${Math.sqrt(far.reduce((sum, { mean }) => sum + mean * mean, 0) / far.length).toFixed(3)} mm`);
  // In these the lips are rounder than the sum of the shapes that a GLB has for their parts.
  const round = ['viseme_O', 'viseme_U', 'viseme_CH', 'mouthFunnel'];
  for (const { name, most, mean } of far) assert.ok(most < (round.includes(name) ? 2.1 : 1.5) && mean < (round.includes(name) ? 0.42 : 0.3), `${name} ${most} ${mean}`);
  for (const eye of ['eye_l', 'eye_r']) assert.ok(apart(mara, head, eye, { 23: 30000, 24: 30000, 25: 20000, 26: 20000 }).most < 0.5);
  assert.deepEqual([...checkNeutral(head), ...checkEyelids(head)], []);
});

test("a viseme of the file's own counts beside ARKit's shapes", () => {
  const { json, binary } = partsOf(fs.readFileSync(path.join(models, 'heads/mara.glb')));
  const { extras, primitives: [{ targets }] } = json.meshes.find(({ name }) => name === 'skin');
  const { sparse } = json.accessors[targets[extras.targetNames.indexOf('viseme_FF')].POSITION];
  const [indices, values] = [sparse.indices, sparse.values].map(({ bufferView, byteOffset = 0 }) => (json.bufferViews[bufferView].byteOffset ?? 0) + byteOffset);
  const skin = mara.parts.find(({ name }) => name === 'skin');
  const moved = new Map();
  for (let e = 0; e < sparse.count; e++) {
    const v = binary.readUInt16LE(indices + 2 * e);
    const far = Math.hypot(...mara.fdp['8.2'].map((x, k) => x - skin.position[3 * v + k]));
    if (far > 14) continue;
    const at = values + 12 * e + 8;
    binary.writeFloatLE(binary.readFloatLE(at) - 0.0025 * (0.5 + 0.5 * Math.cos((Math.PI * far) / 14)), at); // the lower lip is drawn in
    moved.set(v, [0, 1, 2].map((k) => 1000 * binary.readFloatLE(values + 12 * e + 4 * k)));
  }
  assert.ok(moved.size > 50, `${moved.size}`);
  fs.writeFileSync(at('bites.glb'), writeGlb({ json, binary }));
  const { head } = imported('bites.json', at('bites.glb'));
  const part = head.parts.find(({ name }) => name === 'skin');
  const bites = pose(head, part, VISEMES.viseme_FF);
  const off = [...moved].map(([v, d]) => Math.hypot(...d.map((x, k) => bites[3 * v + k] - part.position[3 * v + k] - x)));
  assert.ok(Math.max(...off) < 1, `${Math.max(...off)} mm`);
});

test('OBJ, PLY and VRML97 without targets get zones that close lips and lids', (t) => {
  for (const [file, points, parts, ...more] of [
    ['head.obj', 'obj-points.json', 11], ['head.ply', 'ply-points.json', 1], ['binary.ply', 'ply-points.json', 1], ['head.wrl', 'wrl-points.json', 11, '--up', 'z'],
  ]) {
    const { head, said } = imported('out.json', at(file), '--points', at(points), ...more);
    assert.match(said, /actions from zones/);
    assert.equal(head.parts.length, parts, file);
    assert.ok(head.materials.skin.texture && head.textures.skin.width > 100, file);
    for (const [unit, value] of Object.entries(mara.fapu)) assert.ok(Math.abs(head.fapu[unit] / value - 1) < 0.02, `${file} ${unit} ${head.fapu[unit]}`);
    // each FAP of skin moves its point as far as it should
    const wrong = said.split('\n').filter((line) => /of what it should|there is no vertex/.test(line) && !/tongue|eyelid|eyeball/.test(line));
    assert.deepEqual(wrong, [], file);
    if (parts === 1) continue;
    assert.deepEqual(checkLipsMoveAsOne(head), [], file);
    const upper = (v) => Object.fromEntries([4, 8, 9, 51, 55, 56].map((fap) => [fap, v]));
    const lower = (v) => Object.fromEntries([5, 10, 11, 52, 57, 58].map((fap) => [fap, v]));
    const inside = (faps) => ['teeth_upper', 'teeth_lower', 'tongue'].reduce((sum, name) => sum + view(head, faps, { yaw: 0, pitch: 0 }).count(name), 0);
    const seen = [{}, { ...upper(-100), ...lower(100) }, { 3: 60 }].map(inside);
    const lids = file === 'head.obj' ? checkEyelids(head) : [];
    assert.deepEqual(lids, []);
    t.diagnostic(`${file}: ${seen.map((count) => (count / 16).toFixed(2))} mm² seen between closed lips, ${inside({ ...upper(-200), ...lower(-200), 3: 300 }) / 16} open`);
    assert.ok(seen.every((count) => count <= 8), `${file}: ${seen}`);
    assert.ok(inside({ ...upper(-200), ...lower(-200), 3: 300 }) > 300, file);
  }
});

test('keeps colour and picture of old exporters\' materials; ignores extensions without geometry', () => {
  const { json, binary } = partsOf(fs.readFileSync(path.join(models, 'heads/mara.glb')));
  const plain = imported('back.json', path.join(models, 'heads/mara.glb')).head;
  oldLook(json);
  fs.writeFileSync(at('old.glb'), glb(json, binary));
  const { head } = imported('old.json', at('old.glb'));
  assert.deepEqual(Object.keys(head.textures), Object.keys(plain.textures));
  for (const [part, { color }] of Object.entries(plain.materials)) assert.deepEqual(head.materials[part].color, color, part);
});

test("writes and reads Xface's .fdp with its weights", () => {
  fs.copyFileSync(path.join(models, 'heads/mara.json'), at('mara.json'));
  assert.equal(faccia('points', at('mara.json'), '-o', at('mara.fdp')).status, 0);
  const text = fs.readFileSync(at('mara.fdp'), 'utf8');
  assert.match(text, /<fapu IRISD0="8\.8"/);
  const own = text.replaceAll('mara_skin', 'skin').replace('<source/>', '<source><entity alias="Rest" category="Expression"><bind item="Tongue" pivotX="0" pivotY="0" pivotZ="0" submesh="tongue"/></entity></source>');
  fs.writeFileSync(at('skin.fdp'), own);
  const { head, said } = imported('out.json', at('head.obj'), '-p', at('skin.fdp'));
  assert.match(said, /feature points .* are missing|FAP/);
  for (const [unit, value] of Object.entries(mara.fapu)) if (unit !== 'ES' && unit !== 'ENS' && unit !== 'IRISD') assert.ok(Math.abs(head.fapu[unit] / value - 1) < 0.02, `${unit} ${head.fapu[unit]}`);
  assert.ok(head.parts[0].moves.some(({ fap }) => fap === 51));
  const json = JSON.parse(faccia('points', at('mara.json')).stdout);
  assert.deepEqual(json.fdp['8.4'], mara.fdp['8.4']);
});

test('a command calibrates a head to the points of another, and check reports missing ones', () => {
  const { status, stderr } = faccia('calibrate', at('mara.json'), '--points', path.join(models, 'heads/bruno.json'), '-o', at('taken.json'));
  assert.equal(status, 0, stderr);
  const bruno = load(path.join(models, 'heads/bruno.json'));
  const taken = load(at('taken.json'));
  assert.ok(Math.abs(taken.fapu.MW - bruno.fapu.MW) < 0.01);
  for (const [name, what] of [['breath', 'vertices'], ['sway', 'weights']]) assert.deepEqual(taken.parts.map((part) => part[name]?.[what]), mara.parts.map((part) => part[name]?.[what]), name);
  assert.ok(mara.breath.shift.every((x, k) => Math.abs(taken.breath.shift[k] - x) <= 0.3 * Math.abs(x)), `${taken.breath.shift}`);
  const checked = faccia('check', at('taken.json'));
  assert.match(checked.stdout, /66 of 66 FAPs act/, checked.stderr);
  const { said } = imported('bare.json', at('head.ply'), '-p', at('ply-points.json'));
  assert.match(said, /part tongue is missing: no tongue is seen\n/);
  assert.match(said, /FAP 44 raise_tongue_tip does nothing\n/);
});

test('a file of another kind where a head model is wanted is told as that', () => {
  fs.writeFileSync(at('points.fdp'), '<?xml version="1.0"?>\n<fdp/>\n');
  for (const command of ['points', 'check']) {
    const { status, stderr } = faccia(command, at('points.fdp'));
    assert.equal(status, 1);
    assert.match(stderr, /points\.fdp: no head model, which is JSON; 'faccia head import' makes one/);
  }
});

/** A GLB of its JSON, perhaps changed, and bytes. */
function glb(json, binary) {
  const text = Buffer.from(JSON.stringify(json).padEnd(4 * Math.ceil(JSON.stringify(json).length / 4)));
  const head = Buffer.alloc(20);
  head.write('glTF');
  [2, 28 + text.length + binary.length, text.length, 0x4e4f534a].forEach((x, i) => head.writeUInt32LE(x, 4 + 4 * i));
  const chunk = Buffer.alloc(8);
  chunk.writeUInt32LE(binary.length, 0);
  chunk.writeUInt32LE(0x004e4942, 4);
  return Buffer.concat([head, text, chunk, binary]);
}

test('reads Draco and Basis Universal files like uncompressed ones', further, async (t) => {
  const plain = imported('back.json', path.join(models, 'heads/mara.glb')).head;
  for (const kind of ['etc1s', 'uastc']) {
    fs.writeFileSync(at('packed.glb'), await packed(fs.readFileSync(path.join(models, 'heads/mara.glb')), { kind }));
    const { head, said } = imported('packed.json', at('packed.glb'));
    assert.match(said, /actions from 6\d morph targets/);
    const far = apart(plain, head, 'skin', { 3: 300, 5: -200, 19: 500 });
    t.diagnostic(`${kind}: skin within ${far.most.toFixed(3)} mm`);
    assert.ok(far.most < 0.05 && head.textures.hair.type === 'image/png', `${far.most}`);
    const { data } = PNG.sync.read(Buffer.from(head.textures.hair.data, 'base64'));
    const points = [[4, 4], [12, 4], [4, 12], [12, 12]].map(([x, y]) => [...data.subarray(4 * (y * 16 + x))].slice(0, 3));
    const colours = [[200, 40, 40], [40, 40, 200], [40, 200, 40], [220, 220, 60]];
    colours.forEach((colour, i) => colour.forEach((value, k) => assert.ok(Math.abs(points[i][k] - value) < 12, `${kind} ${i}: ${points[i]}`)));
  }
});

test('FBX, binary with shapes and text without: the same face as from the GLB', further, (t) => {
  const bytes = fs.readFileSync(path.join(models, 'heads/mara.glb'));
  const meshes = ['skin', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower', 'lashes'];
  fs.writeFileSync(at('binary.fbx'), binaryFbx(bytes, { meshes }));
  fs.writeFileSync(at('text.fbx'), textFbx(bytes, { meshes, shapes: false }));
  const fdp = Object.fromEntries(Object.entries(mara.fdp).map(([one, [x, y, z]]) => [one, [x / 10, 155 + y / 10, z / 10]]));
  fs.writeFileSync(at('fbx-points.json'), JSON.stringify({ frame: 'file', fdp }));
  for (const [file, from, most] of [['binary.fbx', /actions from 6\d morph targets/, 0.1], ['text.fbx', /actions from zones/, null]]) {
    const { head, said } = imported('fbx.json', at(file), '--points', at('fbx-points.json'));
    assert.match(said, from, file);
    assert.deepEqual(head.parts.map(({ name }) => name).sort(), [...meshes].sort(), file);
    for (const [unit, value] of Object.entries(mara.fapu)) assert.ok(Math.abs(head.fapu[unit] / value - 1) < 0.02, `${file} ${unit} ${head.fapu[unit]}`);
    assert.ok(Math.abs(head.materials.skin.color[1] - 0.6 ** 2.2) < 0.02, `${head.materials.skin.color}`);
    if (!most) continue;
    // merges equal corners, in a new order, with the origin given by the eyeballs: vertices are identified by their rest position
    const plain = imported('back.json', path.join(models, 'heads/mara.glb')).head;
    const [own, theirs] = [plain, head].map((one) => one.parts.find(({ name }) => name === 'skin'));
    const shift = [0, 1, 2].map((k) => head.fdp['8.1'][k] - plain.fdp['8.1'][k]);
    const faps = { 3: 300, 4: -100, 5: -200, 6: 100, 19: 800, 31: 200 };
    const [posed, other] = [[plain, own], [head, theirs]].map(([one, part]) => pose(one, part, faps));
    const away = (a, v, b, u) => Math.hypot(a[3 * v] - b[3 * u] - shift[0], a[3 * v + 1] - b[3 * u + 1] - shift[1], a[3 * v + 2] - b[3 * u + 2] - shift[2]);
    const far = [];
    for (let v = 0; v < theirs.position.length / 3; v++) {
      const same = [];
      for (let u = 0; u < own.position.length / 3; u++) if (away(theirs.position, v, own.position, u) < 0.05) same.push(u);
      if (same.length === 1) far.push(away(other, v, posed, same[0]));
    }
    t.diagnostic(`${far.length} of ${own.position.length / 3} vertices found, at most ${Math.max(...far).toFixed(2)} mm`);
    assert.ok(far.length > 3000 && Math.max(...far) < most, `${far.length} ${Math.max(...far)}`);
  }
});

test('reports broken and malicious files with their position, and writes nothing', async () => {
  const fbx = binaryFbx(fs.readFileSync(path.join(models, 'heads/luca.glb')), { meshes: ['eye_l'] });
  const bomb = binaryFbx(fs.readFileSync(path.join(models, 'heads/luca.glb')), { meshes: ['eye_l'] });
  bomb.writeUInt32LE(30, bomb.indexOf('Vertices') + 9); // a list that says it is short, and unpacks to more
  const spoilt = await packed(fs.readFileSync(path.join(models, 'heads/luca.glb')), { spoil: (draco) => draco.fill(255, 40, 90) });
  const whole = fs.readFileSync(path.join(models, 'heads/luca.glb'));
  const size = whole.readUInt32LE(12);
  const json = JSON.parse(whole.toString('utf8', 20, 20 + size));
  const binary = whole.subarray(28 + size);
  const changed = (change) => {
    const copy = structuredClone(json);
    const bytes = Buffer.from(binary);
    change(copy, bytes);
    return glb(copy, bytes);
  };
  const first = json.meshes[0].primitives[0];
  const place = json.accessors[first.attributes.POSITION];
  const indices = json.accessors[first.indices];
  const ply = fs.readFileSync(at('head.ply'), 'utf8');
  const obj = fs.readFileSync(at('head.obj'), 'utf8');
  const lines = obj.split('\n');
  const line = (pattern) => lines.findIndex((one) => pattern.test(one));
  const withLine = (i, text) => [...lines.slice(0, i), text, ...lines.slice(i + 1)].join('\n');
  const wrl = fs.readFileSync(at('head.wrl'), 'utf8');
  fs.writeFileSync(path.join(os.tmpdir(), 'faccia-secret.png'), 'x');
  const points = (name) => ['--points', at(`${name}-points.json`)];
  const cases = [
    ['cut.glb', whole.subarray(0, whole.length - 100), [], /byte 8: the file says/],
    ['empty.glb', Buffer.alloc(0), [], /empty\.glb: is empty/],
    ['page.glb', '\n<!-- saved -->\n<!DOCTYPE html>\n<html><body>Log in</body></html>', [], /page\.glb: is a web page, not a model/],
    ['pointer.obj', 'version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n', [], /pointer\.obj: is a pointer of Git LFS/],
    ['zip.vrm', Buffer.from('PK\x03\x04 and more', 'latin1'), [], /zip\.vrm: is a ZIP archive/],
    ['zeros.glb', Buffer.alloc(64), [], /JSON/],
    ['version.glb', Buffer.concat([whole.subarray(0, 4), Buffer.from([9, 0, 0, 0]), whole.subarray(8)]), [], /byte 4: version 9/],
    ['count.glb', changed((j) => (j.accessors[first.attributes.POSITION].count = 2e9)), [], /accessors\[\d+\]: 2000000000 elements/],
    ['past.glb', changed((j) => (j.accessors[first.attributes.POSITION].count += 100000)), [], /accessors\[\d+\]: \d+ elements go beyond/],
    ['none.glb', changed((j) => (j.meshes[0].primitives[0].attributes.POSITION = 99999)), [], /meshes\[0\]\.primitives\[0\]\.attributes\.POSITION: there is no accessors\[99999\]/],
    ['nan.glb', changed((j, b) => b.writeFloatLE(NaN, j.bufferViews[place.bufferView].byteOffset + 24)), [], /accessors\[\d+\]: element 2 is not a number/],
    ['index.glb', changed((j, b) => b.writeUInt16LE(65535, j.bufferViews[indices.bufferView].byteOffset + 6)), [], /accessors\[\d+\]: element 3 is vertex 65535/],
    ['outside.glb', changed((j) => j.buffers.push({ uri: '../../etc/passwd', byteLength: 3 }) && (j.bufferViews[place.bufferView].buffer = 1)), [], /buffers\[1\]\.uri: /],
    ['loop.glb', changed((j) => (j.nodes[0].children = [0])), [], /nodes\[0\]: stands more than once/],
    ['unknown.glb', changed((j) => (j.extensionsRequired = ['KHR_gaussian_splatting']) && (j.meshes[1].primitives[0].extensions = { KHR_gaussian_splatting: {} })), [], /meshes\[1\]\.primitives\[0\]: KHR_gaussian/],
    ['draco.glb', spoilt, [], /meshes\[0\]\.primitives\[0\]\.extensions\.KHR_draco_mesh_compression: what is packed with Draco /],
    ['list.glb', changed((j) => (j.bufferViews = {})), [], /bufferViews: must be a list/],
    ['deep.glb', changed((j) => (j.meshes[0].primitives = 7)), [], /is not built as \.glb files are|no mesh/],
    ['text.gltf', '{"asset": {"version": "2.0"}, ', [], /JSON: /],
    ['short.ply', ply.slice(0, ply.length >> 1), points('ply'), /line \d+: a number is missing/],
    ['huge.ply', ply.replace(/element vertex \d+/, 'element vertex 4000000000'), points('ply'), /line 4: a head has no 4000000000 elements/],
    ['corner.ply', ply.replace(/\n3 \d+ /, '\n3 123456 '), points('ply'), /line \d+: there is no vertex 123456/],
    ['nan.obj', withLine(line(/^v /), 'v 1 nothing 3'), points('obj'), new RegExp(`line ${line(/^v /) + 1}: must have 3 numbers`)],
    ['corner.obj', withLine(line(/^f /), 'f 1 2 99999999'), points('obj'), new RegExp(`line ${line(/^f /) + 1}: there is no vertex 99999999`)],
    ['outside.obj', obj.replace('mtllib head.mtl', 'mtllib ../faccia-secret.png'), points('obj'), /line 2: "\.\.\/faccia-secret\.png" leads out/],
    ['open.wrl', wrl.slice(0, wrl.lastIndexOf('coordIndex')), [...points('wrl'), '--up', 'z'], /line \d+: the file ends within/],
    ['deep.wrl', `#VRML V2.0 utf8\n${'Group { children [ '.repeat(5000)}`, points('wrl'), /line 2: nodes within nodes/],
    ['new.wrl', '#VRML V3.0 utf8\n', points('wrl'), /line 1: this is no VRML/],
    ['old.wrl', '#VRML V1.0 ascii\nSeparator { Coordinate3 { point [ 0 0 0 ] } }\n', points('wrl'), /there is no IndexedFaceSet/],
    ['deep-old.wrl', `#VRML V1.0 ascii\n${'Separator { '.repeat(5000)}`, points('wrl'), /line 2: nodes within nodes/],
    ['corner.wrl', '#VRML V1.0 ascii\nSeparator { Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] }\nIndexedFaceSet { coordIndex [ 0 1 7 -1 ] } }\n', points('wrl'), /line 3: coordIndex 2 is 7/],
    ['corner.wrl', wrl.replace('coordIndex [ ', 'coordIndex [ 99999999, '), [...points('wrl'), '--up', 'z'], /line \d+: coordIndex 0 is 99999999/],
    ['cut.fbx', fbx.subarray(0, fbx.length >> 1), [], /byte \d+: /],
    ['noise.fbx', fbx.map((x, i) => (i > 400 && i % 997 === 0 ? x ^ 255 : x)), [], /byte \d+: /],
    ['bomb.fbx', bomb, [], /byte \d+: a list of 30 numbers/],
    ['deep.fbx', `; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXVersion: 7400\n}\n${'Objects:  {\n'.repeat(50)}`, [], /fbx/],
    ['none.fbx', 'solid', [], /byte 0: this is no FBX file/],
    ['corner.fbx', textFbx(whole, { meshes: ['eye_l'], shapes: false }).replace(/(PolygonVertexIndex[^]*?a: )\d+/, '$199999999'), [], /cannot be read as FBX|corner \d+ is at no place/],
    ['head.stl', 'solid', [], /"\.stl" is not read/],
  ];
  for (const [name, bytes, words, pattern] of cases) {
    fs.writeFileSync(at(name), bytes);
    const { status, stderr } = faccia('import', at(name), ...words, '-o', at('never.json'));
    assert.equal(status, 1, `${name}: ${stderr}`);
    assert.match(stderr, pattern, name);
    assert.ok(!/\n {4}at /.test(stderr), `${name}: ${stderr}`);
  }
  for (const [name, text, pattern] of [
    ['a.json', '{"fdp": {"2.99": [0, 0, 0]}}', /fdp\.2\.99: there is no such/], ['b.json', '{"fdp": {"2.1": [0, 0]}}', /fdp\.2\.1: must be/],
    ['c.json', '{"fdp": {\n"2.1": }}', /JSON|line 2/], ['d.json', '{"fdp": {"2.1": [0, 0, 0]}}', /are missing/], ['e.fdp', '<xfdp><fdp name="2.1" index="1">\n</xfdp>', /line 2: <\/xfdp> closes nothing/],
    ['f.fdp', '<xfdp>\n<fdp name="2.1" index="x"/></xfdp>', /line 2: index must be/], ['g.json', JSON.stringify({ fdp: { ...JSON.parse(fs.readFileSync(at('obj-points.json'))).fdp, 2.1: 9999999 } }), /fdp\.2\.1: there is no vertex/],
  ]) {
    fs.writeFileSync(at(name), text);
    const { status, stderr } = faccia('import', at('head.obj'), '-p', at(name), '-o', at('never.json'));
    assert.equal(status, 1, name);
    assert.match(stderr, pattern, name);
  }
  assert.ok(!fs.readdirSync(folder).some((name) => name.startsWith('never')));
  assert.equal(faccia('import').status, 2);
  assert.equal(faccia('import', at('head.obj'), '--unit', 'ell').status, 2);
});

/** A GLB of that JSON, with a place for each of three corners in its bytes. */
const triangle = (change) => {
  const bytes = Buffer.alloc(48);
  [0, 0, 0, 1, 0, 0, 0, 1, 0].forEach((x, i) => bytes.writeFloatLE(x, 4 * i));
  const json = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, type: 'VEC3', count: 3 }], bufferViews: [{ buffer: 0, byteLength: 36 }], buffers: [{ byteLength: 48 }],
  };
  change(json);
  return glb(json, bytes);
};

test('rejects small files that demand much before doing the work', async () => {
  const header = (elements, format = 'ascii') => `ply\nformat ${format} 1.0\n${elements.join('\n')}\nend_header\n`;
  const star = Array.from({ length: 20000 }, (_, i) => `v ${(i % 2 ? 1 : 0.5) * Math.cos(i / 3000)} ${(i % 2 ? 1 : 0.5) * Math.sin(i / 3000)} 0`).join('\n');
  const faces = Array.from({ length: 2000 }, (_, i) => `${i} ${i + 1} ${i + 2} -1`).join(' ');
  const again = Array.from({ length: 6 }, (_, k) => `DEF G${k} Group { children [ ${(k ? `USE G${k - 1} ` : 'USE F ').repeat(15)}] }`).join('\n');
  const cases = {
    'nothing.ply': [header(Array.from({ length: 2000 }, () => 'element idle 4000000')), /line \d+: a head has no more than \d+ kinds/],
    'idle.ply': [header(['element x 4000000', ...Array(500).fill('property float nx')]), /the elements need \d+ bytes/],
    'idle-binary.ply': [header(['element x 4000000', 'property double quality'], 'binary_little_endian'), /the elements need 32000000 bytes/],
    'face.obj': [`${star}\nf ${Array.from({ length: 20000 }, (_, i) => i + 1).join(' ')}\n`, /line 20001: .* takes longer/],
    'meshes.obj': [`v 0 0 0\nv 1 0 0\nv 0 1 0\n${Array.from({ length: 2000 }, (_, i) => `o ${i}\nf 1 2 3\n`).join('')}`, /line \d+: more than 512 meshes/],
    'use.wrl': [`#VRML V2.0 utf8\nDEF F Shape { geometry IndexedFaceSet { coord Coordinate { point [ ${'0 0 1, 1 0 0, 0 1 0, '.repeat(700)}] } coordIndex [ ${faces} ] } }\n${again}`, /more than 512 meshes|numbers are wanted|takes longer/],
    'views.glb': [triangle((json) => {
      json.bufferViews = Array.from({ length: 64 }, () => ({ buffer: 0, byteLength: 48e6, extensions: { EXT_meshopt_compression: { buffer: 0, byteLength: 48, byteStride: 12, count: 4e6, mode: 'ATTRIBUTES' } } }));
      json.images = json.bufferViews.map((_, bufferView) => ({ bufferView }));
      json.textures = json.images.map((_, source) => ({ source }));
      json.materials = json.textures.map((_, index) => ({ pbrMetallicRoughness: { baseColorTexture: { index } } }));
    }), /bufferViews\[\d+\]: /],
    'zeros.glb': [triangle((json) => {
      json.accessors.push({ componentType: 5126, type: 'VEC3', count: 3 }, { componentType: 5126, type: 'VEC3', count: 3e6 });
      json.nodes = Array.from({ length: 100 }, () => ({ mesh: 0 }));
      json.scenes = [{ nodes: json.nodes.map((_, i) => i) }];
      json.meshes[0].primitives[0].attributes.POSITION = 2;
    }), /accessors\[2\]: more than \d+ numbers/],
    'points.glb': [triangle((json) => {
      json.nodes = Array.from({ length: 3000 }, () => ({ mesh: 0 }));
      json.scenes = [{ nodes: json.nodes.map((_, i) => i) }];
      json.meshes[0].primitives = Array(3000).fill({ mode: 0, attributes: { POSITION: 0 } });
    }), /meshes\[0\]\.primitives\[\d+\]: .* takes longer/],
  };
  for (const [name, [bytes, says]] of Object.entries(cases)) {
    fs.writeFileSync(at(name), bytes);
    const before = process.memoryUsage().rss;
    await assert.rejects(readScene(at(name)), (error) => {
      assert.match(error.message, says, name);
      return error.constructor.name === 'FileError';
    });
    assert.ok(process.memoryUsage().rss - before < 1e9, `${name}: ${process.memoryUsage().rss - before} bytes more`);
  }
});
