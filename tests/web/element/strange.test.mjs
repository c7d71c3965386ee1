// SPDX-License-Identifier: GPL-3.0-or-later
// Third-party avatars, also malicious ones: an accepted avatar is placed like a head, and opens and closes its lips and lids; a refused
// one is reported by one error with its position.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { modelOf } from '../../../web/element/avatar/avatar.mjs';
import { readMap } from '../../../web/element/avatar/map.mjs';
import { faceValues } from '../../../web/element/face/face-mixer.mjs';
import { Vector3 } from '../../../web/node_modules/three/build/three.module.js';
import { models } from '../../lib/built-heads.mjs';
import { partsOf, writeGlb } from '../../lib/foreign-avatars.mjs';
import { METRES, strange, takenApart } from '../../lib/strange-avatars.mjs';
import { strangeCases } from '../../lib/strange-cases.mjs';

globalThis.createImageBitmap ??= async () => ({ width: 1, height: 1, close() {} }); // nothing is drawn here

const own = fs.readFileSync(path.join(models, 'heads/mara.glb'));
const { fdp } = JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json')));
const whole = takenApart(own);
const skin = whole.meshes.find(({ name }) => name === 'skin');
const POINTS = ['2.1', '2.2', '2.3', '2.6', '2.7', '2.8', '2.9', '3.1', '3.2', '3.3', '3.4', '9.3'];

const placeOf = (v) => [0, 1, 2].map((k) => 1000 * (skin.position[3 * v + k] - (k === 1 ? METRES : 0)));
const vertices = Object.fromEntries(POINTS.map((point) => {
  let [best, least] = [0, Infinity];
  for (let v = 0; v < skin.position.length / 3; v++) {
    const far = Math.hypot(...placeOf(v).map((x, k) => x - fdp[point][k]));
    if (far < least) [best, least] = [v, far];
  }
  return [point, best];
}));

const read = (bytes, file = 'a.glb') => modelOf(new Uint8Array(bytes), readMap(null), file);

/** Positions of its skin points at FAPs, mm, relative to the eyes of a head. */
function lookAt(head) {
  const mesh = head.meshes.find(({ name }) => name.startsWith('skin'));
  return (faps) => {
    head.setFaps(faceValues(faps));
    head.group.updateMatrixWorld(true);
    mesh.skeleton?.update();
    return Object.fromEntries(POINTS.map((point) => [point, mesh.getVertexPosition(vertices[point], new Vector3()).applyMatrix4(mesh.matrixWorld).toArray()]));
  };
}

const LIPS = [['2.2', '2.3'], ['2.6', '2.8'], ['2.7', '2.9']];
const LIDS = [['3.1', '3.3'], ['3.2', '3.4']];

for (const [name, { bytes, lids = true, wink = true }] of Object.entries(strangeCases(whole)))
  test(`${name}: stands upright, lips meet and part, lids close`, async (t) => {
    const { head } = await read(await bytes());
    const at = lookAt(head);
    const rest = at({});
    const apart = (now, [upper, lower]) => now[upper][1] - now[lower][1];
    const gaps = (now) => LIPS.map((pair) => apart(now, pair) - apart(rest, pair));
    const shares = (now) => LIDS.map((pair) => apart(now, pair) / apart(rest, pair));
    const off = Math.max(...['9.3', '2.1', '2.2', '3.1', '3.2'].map((point) => Math.hypot(...rest[point].map((x, k) => x - placeOf(vertices[point])[k]))));
    const shut = [{ 3: 300 }, { 3: 200, 6: -100, 7: -100, 12: -50, 13: -50 }].flatMap((faps) => gaps(at(faps)));
    const open = at({ 3: 400, 4: -80, 5: -400, 8: -70, 9: -70, 10: -330, 11: -330 });
    const [opened] = gaps(open);
    const chin = open['2.1'][1] - rest['2.1'][1];
    const [blink, left] = [{ 19: 940, 20: 940, 21: 84, 22: 84 }, { 19: 940, 21: 84 }].map((faps) => shares(at(faps)));
    t.diagnostic(`off ${off.toFixed(1)} mm; closed ${Math.max(...shut).toFixed(2)}; open ${opened.toFixed(1)}, chin ${chin.toFixed(1)}; lids ${blink.map((x) => x.toFixed(2))}, left alone ${left.map((x) => x.toFixed(2))}`);
    assert.ok(off < 20, `${off} mm from where a head is`); // eyes without bones are taken to be where the lids are
    assert.ok(Math.max(...shut) < 0.3 && Math.min(...shut) > -2, `lips ${shut}`);
    assert.ok(opened > 4 && chin < -3, `opened ${opened}, chin ${chin}`);
    if (lids) assert.ok(blink.every((share) => Math.abs(share) < 0.1), `lids ${blink}`);
    if (lids && wink) assert.ok(Math.abs(left[0]) < 0.1 && left[1] > 0.9, `left lid ${left}`);
    for (const mesh of head.meshes) {
      const { position } = mesh.geometry.attributes;
      for (const attribute of [position, ...(mesh.geometry.morphAttributes.position ?? [])])
        for (let v = 0; v < attribute.count; v++) assert.ok(Number.isFinite(attribute.getX(v) + attribute.getY(v) + attribute.getZ(v)), mesh.name);
    }
  });

test('reads target names in any place and number', async () => {
  const ways = {
    'beside the primitive': (mesh) => (mesh.primitives[0].extras = mesh.extras) && delete mesh.extras,
    'too few': (mesh) => mesh.extras?.targetNames.pop(),
    'too many': (mesh) => mesh.extras?.targetNames.push('more'),
  };
  for (const [way, change] of Object.entries(ways)) {
    const bytes = strange(whole, { rename: (name) => (/^(jawOpen|eyeBlink|mouthPucker)/.test(name) ? name : null), add: ({ meshes }) => meshes.forEach(change) });
    const { head } = await read(bytes);
    assert.ok(head.solver.names.includes('jawOpen'), way);
  }
});

const changed = (change) => {
  const parts = partsOf(own);
  change(parts.json, parts);
  return writeGlb(parts);
};
const png = (width, height) => {
  const bytes = Buffer.alloc(64);
  Buffer.from('89504e470d0a1a0a0000000d49484452', 'hex').copy(bytes);
  bytes.writeUInt32BE(width, 16);
  bytes.writeUInt32BE(height, 20);
  return bytes;
};
const withPicture = (data) => changed((json, parts) => {
  json.bufferViews.push({ buffer: 0, byteOffset: parts.binary.length, byteLength: data.length });
  parts.binary = Buffer.concat([parts.binary, data]);
  json.buffers[0].byteLength = parts.binary.length;
  json.images[0].bufferView = json.bufferViews.length - 1;
});

const HOSTILE = {
  'a circle of nodes': [(json) => json.nodes[1].children.push(0), 'damaged', /nodes\[/],
  'nodes a thousand deep': [(json) => { for (let i = 0; i < 1000; i++) json.nodes.push({ children: [json.nodes.length + 1] }); json.nodes.push({}); }, 'damaged', /nodes\[\d+\]: is within \d+ others/],
  'a node within two': [(json) => json.nodes[0].children.push(json.nodes[0].children[0]), 'damaged', /nodes\[0\]\.children/],
  'a mesh that is not there': [(json) => (json.nodes[19].mesh = 99), 'damaged', /nodes\[19\]\.mesh: there is no meshes\[99\]/],
  'a place that is no number': [(json) => (json.nodes[3].translation = [0, 'x', 0]), 'damaged', /nodes\[3\]\.translation/],
  'a joint that is not there': [(json) => (json.skins[0].joints[2] = 4000), 'damaged', /skins\[0\]\.joints\[2\]/],
  'too few matrices': [(json) => json.skins[0].joints.push(1, 2, 3), 'damaged', /skins\[0\]\.inverseBindMatrices/],
  'fewer joints than vertices hang on': [(json) => (json.skins[0].joints.length = 1), 'damaged', /joint \d+, and there are 1/],
  'a corner that is not there': [(json, { binary }) => {
    const { bufferView, byteOffset = 0 } = json.accessors[json.meshes[0].primitives[0].indices];
    binary.writeUInt16LE(60000, json.bufferViews[bufferView].byteOffset + byteOffset + 30);
  }, 'damaged', /mesh "skin": a triangle has vertex 60000/],
  'a target of another mesh': [(json) => (json.meshes[0].primitives[0].targets[0].POSITION = json.meshes[1].primitives[0].attributes.POSITION), 'damaged', /meshes\[0\]\.primitives\[0\]\.targets\[0\]\.POSITION/],
  'a view beyond its buffer': [(json) => (json.bufferViews[9].byteLength = 2 ** 31), 'damaged', /bufferViews\[9\]/],
  'a buffer of 2 GB': [(json) => (json.buffers[0].byteLength = 2 ** 31), 'damaged', /buffers\[0\]/],
  'an accessor of 2 GB': [(json) => json.accessors.push({ componentType: 5126, type: 'VEC4', count: 2 ** 27 }), 'too-large', /accessors\[\d+\]/],
  'many views of a few bytes that unpack to 48 MB each': [(json) => {
    const fallback = json.buffers.push({ byteLength: 48e6, extensions: { EXT_meshopt_compression: { fallback: true } } }) - 1;
    json.extensionsUsed = [...(json.extensionsUsed ?? []), 'EXT_meshopt_compression'];
    for (let i = 0; i < 64; i++)
      json.bufferViews.push({ buffer: fallback, byteLength: 48e6, extensions: { EXT_meshopt_compression: { buffer: 0, byteLength: 48, byteStride: 12, count: 4e6, mode: 'ATTRIBUTES' } } });
  }, 'too-large', /bufferViews\[\d+\]: more than \d+ bytes up to here/],
  'a sparse one beyond its bytes': [(json) => (json.accessors.find(({ sparse }) => sparse).sparse.count = 7000), 'damaged', /sparse/],
  'a type that there is not': [(json) => (json.accessors[2].type = 'VEC9'), 'damaged', /accessors\[2\]/],
  'a mesh drawn ten thousand times': [(json) => { for (let i = 0; i < 10000; i++) json.scenes[0].nodes.push(json.nodes.push({ mesh: 0 }) - 1); }, 'too-large', /vertices/],
  'a list that is none': [(json) => (json.meshes = { length: 3 }), 'damaged', /meshes: is no list/],
  'a scene that is not there': [(json) => (json.scene = 5), 'damaged', /scene: there is no scenes\[5\]/],
  'a texture that is not there': [(json) => (json.materials[1].pbrMetallicRoughness.baseColorTexture.index = 77), 'damaged', /materials\[1\]\.pbrMetallicRoughness\.baseColorTexture: there is no textures\[77\]/],
};

test('reports malicious files by one error with its position', async (t) => {
  const cases = Object.entries(HOSTILE).map(([name, [change, reason, says]]) => [name, changed(change), reason, says]);
  cases.push(['a picture of 60000 x 60000', withPicture(png(60000, 60000)), 'too-large', /images\[0\]: 60000 x 60000/]);
  cases.push(['a picture that is none', withPicture(Buffer.alloc(64, 7)), 'damaged', /images\[0\]/]);
  for (const share of [0, 0.0001, 0.01, 0.5, 0.999]) cases.push([`${share} of it`, own.subarray(0, Math.floor(share * own.length)), share < 1e-5 ? 'not-glb' : 'damaged', /./]);
  for (const [name, bytes, reason, says] of cases)
    await assert.rejects(read(bytes), (error) => {
      t.diagnostic(`${name}: ${error.reason}: ${error.message}`);
      assert.equal(error.reason, reason, `${name}: ${error.stack}`);
      assert.match(error.message, says, name);
      return true;
    }, name);
});

test('omits a texture whose picture format is unknown', async () => {
  const { head } = await read(changed((json) => (json.textures[0] = { extensions: { EXT_texture_unheard: { source: 0 } } })));
  assert.equal(head.meshes.find(({ name }) => name === 'skin').material.map, null);
});

/** Lips and lids of the skin as strangers' are looked at. */
async function actsAsOurs(bytes, message) {
  const { head } = await read(bytes);
  const at = lookAt(head);
  const apart = (now, [upper, lower]) => now[upper][1] - now[lower][1];
  const [plain, open, blink] = [{}, { 3: 400, 4: -80, 5: -400, 8: -70, 9: -70, 10: -330, 11: -330 }, { 19: 940, 20: 940, 21: 84, 22: 84 }].map(at);
  const flat = lookAt((await read(own)).head)({});
  for (const pair of LIPS) {
    assert.ok(Math.abs(apart(plain, pair) - apart(flat, pair)) < 0.3, `${message}: lips at rest ${apart(plain, pair)}`);
    assert.ok(Math.abs(apart(at({ 3: 300 }), pair) - apart(flat, pair)) < 0.5, `${message}: closed lips ${apart(at({ 3: 300 }), pair)}`);
  }
  assert.ok(apart(open, LIPS[0]) - apart(plain, LIPS[0]) > 4, `${message}: opened ${apart(open, LIPS[0])}`);
  for (const pair of LIDS) {
    assert.ok(Math.abs(apart(plain, pair) / apart(flat, pair) - 1) < 0.05, `${message}: lids at rest`);
    assert.ok(Math.abs(apart(blink, pair) / apart(plain, pair)) < 0.1, `${message}: lids ${apart(blink, pair)}`);
  }
  return head;
}

const weighed = (weights) => (json) => {
  for (const mesh of json.meshes) if (mesh.extras?.targetNames) mesh.weights = mesh.extras.targetNames.map((name) => weights[name] ?? 0);
};

test('removes the shape weights stored in a file: lips and lids meet as without them', async () => {
  await actsAsOurs(changed(weighed({ jawOpen: 0.3, eyeBlinkLeft: 1, eyeBlinkRight: 1, mouthFunnel: 0.4 })), 'weights of meshes');
  await actsAsOurs(changed((json) => {
    for (const node of json.nodes) {
      const names = json.meshes[node.mesh]?.extras?.targetNames;
      if (names) node.weights = names.map((name) => ({ jawOpen: 0.5, mouthClose: 0.5, viseme_aa: 0.7 })[name] ?? 0);
    }
  }), 'weights of nodes');
});

test('prefers a shape that moves something over one that does not', async () => {
  const head = await actsAsOurs(changed((json) => {
    const empty = new Map();
    for (const mesh of json.meshes) {
      const names = mesh.extras?.targetNames;
      if (!names) continue;
      // the plain name is empty, and what moves has it with something before
      for (const name of ['jawOpen', 'eyeBlinkLeft', 'eyeBlinkRight', 'mouthClose']) {
        const i = names.indexOf(name);
        if (i < 0) continue;
        names[i] = `Face.M_F00_${name}_01`;
        for (const { attributes, targets } of mesh.primitives) {
          const { count } = json.accessors[attributes.POSITION];
          if (!empty.has(count)) empty.set(count, json.accessors.push({ componentType: 5126, type: 'VEC3', count }) - 1);
          targets.push({ POSITION: empty.get(count) });
        }
        names.push(name);
      }
      mesh.weights = names.map(() => 0);
    }
  }), 'empty shapes');
  assert.ok(head.solver.names.includes('jawOpen'));
});

const ODD = {
  'TANGENT: -1': (json) => json.meshes.forEach(({ primitives }) => primitives.forEach(({ attributes }) => (attributes.TANGENT = -1))),
  'attributes that are nowhere': (json) => json.meshes.forEach(({ primitives }) => primitives.forEach(({ attributes }) => Object.assign(attributes, { COLOR_0: 9999, TEXCOORD_3: null, _BATCH: 9999 }))),
  'tangents of targets that are nowhere': (json) => json.meshes.forEach(({ primitives }) => primitives.forEach(({ targets }) => targets?.forEach((target) => (target.TANGENT = -1)))),
  'a target without places': (json) => json.meshes.forEach((mesh) => {
    if (!mesh.extras?.targetNames) return;
    for (const { targets } of mesh.primitives) targets.push({}, { POSITION: -1 });
    mesh.extras.targetNames.push('jawForward', 'nothing');
    delete mesh.weights;
  }),
  'normals for some targets': (json) => json.meshes.forEach(({ primitives }) => primitives.forEach(({ attributes, targets }) => targets && (targets[0].NORMAL = attributes.NORMAL))),
  'presets and groups that are null': (json) => {
    json.extensions = { ...json.extensions, VRMC_vrm: { ...json.extensions?.VRMC_vrm, expressions: { preset: { happy: null, aa: null }, custom: { x: null } } }, VRM: null };
  },
  'no scenes': (json) => {
    delete json.scene;
    delete json.scenes;
  },
  'a scene with nothing in it': (json) => {
    json.scene = 0;
    json.scenes = [{ name: 'Scene' }];
  },
  '-1 and null for none': (json) => {
    json.nodes.forEach((node) => Object.assign(node, { mesh: node.mesh ?? -1, skin: node.skin ?? -1, camera: -1, children: node.children ?? null, weights: null }));
    json.meshes.forEach(({ primitives }) => primitives.forEach((one) => (one.material ??= -1)));
    json.textures.forEach((texture) => (texture.sampler ??= -1));
  },
  'weights of another length': (json) => json.meshes.forEach((mesh) => (mesh.weights = [0, null, 'x'])),
  'names that are numbers': (json) => json.nodes.forEach((node, i) => node.mesh === undefined && !json.skins?.some(({ joints }) => joints.includes(i)) && (node.name = i)),
};

for (const [name, change] of Object.entries(ODD)) test(`accepts quirks of real exporters: ${name}`, () => actsAsOurs(changed(change), name));
