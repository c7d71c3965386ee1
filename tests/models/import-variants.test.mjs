// SPDX-License-Identifier: GPL-3.0-or-later
// One head in many of the ways in which each format can be written: each time the same surface is read, with the same side out. Also
// colours, mirrored files, other axes and units.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test, { after } from 'node:test';
import zlib from 'node:zlib';
import { PNG } from 'pngjs';
import { findPoints } from '../../models/tools/import/face/find-points.mjs';
import { makeHead } from '../../models/tools/import/make-head.mjs';
import { readScene } from '../../models/tools/import/formats/read-scene.mjs';
import { gatherParts, guessPart, partOf } from '../../models/tools/import/mesh/parts.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { models } from '../lib/built-heads.mjs';
import { violations } from '../lib/schema.mjs';
import { partsOf, writeGlb } from '../lib/foreign-avatars.mjs';
import { newMeshopt, strange, takenApart } from '../lib/strange-avatars.mjs';
import { strip, vrml1Of, vrmlOf, writeGltf, writeObjAs, writePlyAs } from '../lib/file-variants.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-variants-'));
const at = (name) => path.join(folder, name);
after(() => fs.rmSync(folder, { recursive: true }));

const mara = unpack(JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json'), 'utf8')));
const parts = ['skin', 'eye_l', 'eye_r', 'teeth_lower'].map((name) => mara.parts.find((part) => part.name === name)).map(({ name, position, uv, index }) => ({ name, position: [...position], uv: [...uv], index: [...index] }));
const placed = (place) => parts.map((part) => ({ ...part, position: Array.from({ length: part.position.length / 3 }, (_, v) => place(part.position.slice(3 * v, 3 * v + 3))).flat() }));
const toldIn = (place) => ({ frame: 'file', fdp: Object.fromEntries(Object.entries(mara.fdp).map(([name, p]) => [name, place(p)])), parts: {}, influences: [] });

/** Invariants of a surface, independent of vertex order: extent, area, orientation, and signed volume, negative if it is inside out. */
function measure({ position, index }) {
  const p = (v) => [position[3 * v], position[3 * v + 1], position[3 * v + 2]];
  let [area, volume] = [0, 0];
  const normal = [0, 0, 0];
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const v of index) p(v).forEach((x, k) => { low[k] = Math.min(low[k], x); high[k] = Math.max(high[k], x); });
  const middle = low.map((x, k) => (x + high[k]) / 2);
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => p(index[t + k]));
    const [u, v] = [b, c].map((q) => q.map((x, k) => x - a[k]));
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    area += Math.hypot(...n) / 2;
    volume += n.reduce((sum, x, k) => sum + (a[k] - middle[k]) * x, 0) / 6;
    n.forEach((x, k) => { normal[k] += x / 2; });
  }
  return { area, volume, normal, extent: high.map((x, k) => x - low[k]), corners: index.length };
}

/** Meshes of one name are one. */
function fetchOnce(meshes, name) {
  const [position, index] = [[], []];
  for (const mesh of meshes.filter((one) => one.name === name)) {
    const from = position.length / 3;
    for (const x of mesh.position) position.push(x);
    for (const v of mesh.index) index.push(from + v);
  }
  return { position, index };
}

function same(meshes, wanted, what, { triangles = true } = {}) {
  for (const part of wanted) {
    const [one, other] = [measure(fetchOnce(meshes, part.name)), measure(part)];
    if (triangles) assert.equal(one.corners, other.corners, `${what}: triangles of ${part.name}`);
    const size = Math.max(...other.extent);
    assert.ok(one.extent.every((x, k) => Math.abs(x - other.extent[k]) < 1e-3 * size), `${what}: ${part.name} extends ${one.extent}, not ${other.extent}`);
    assert.ok(Math.abs(one.area / other.area - 1) < 1e-3, `${what}: ${part.name} has ${one.area} of surface, not ${other.area}`);
    assert.ok(Math.abs(one.volume / other.volume - 1) < 2e-2, `${what}: ${part.name} holds ${one.volume}, not ${other.volume}`);
  }
}

const metres = placed(([x, y, z]) => [x / 1000, y / 1000, z / 1000]);
const expanded = metres.map((part) => ({ ...part, position: [...part.index].flatMap((v) => part.position.slice(3 * v, 3 * v + 3)), uv: [...part.index].flatMap((v) => part.uv.slice(2 * v, 2 * v + 2)), index: part.index.map((_, i) => i) }));
const mirrored = metres.map((part) => ({ ...part, position: part.position.map((x, i) => (i % 3 ? x : -x)), index: part.index.map((_, i, list) => list[i - (i % 3) + [0, 2, 1][i % 3]]) }));
const half = Math.SQRT1_2;

test('glTF: reads every byte layout and index type, strips, nested nodes and mirrored ones', async () => {
  for (const [what, file, list, how] of [
    ['32-bit indices', 'a.glb', metres, {}],
    ['16-bit indices', 'b.glb', metres, { index: Uint16Array }],
    ['no indices', 'c.glb', expanded, { index: 'none' }],
    ['a strip', 'd.glb', metres, { mode: 5, cornersOf: strip }],
    ['several meshes', 'e.glb', metres, { cut: 3 }],
    ['woven', 'f.glb', metres, { layout: 'woven' }],
    ['quantised', 'g.glb', metres, { layout: 'short' }],
    ['sparse', 'h.glb', metres, { layout: 'sparse' }],
    ['bytes within the text, with a mark before it', 'i.gltf', metres, {}],
    ['no texture coordinates', 'j.glb', metres, { uv: false }],
    ['a mirrored node', 'k.glb', mirrored, { node: { scale: [-1, 1, 1] } }],
    ['mirrored by a matrix', 'l.glb', mirrored, { node: { matrix: [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] } }],
    ['mirrored twice', 'm.glb', metres, { node: { scale: [-1, 1, 1] }, above: [{ scale: [-1, 1, 1] }] }],
    ['nodes within nodes', 'n.glb', metres, { above: [{ rotation: [half, 0, 0, half], scale: [2, 2, 2] }, { rotation: [-half, 0, 0, half], translation: [0, 4, 1], scale: [0.5, 0.5, 0.5] }] }],
  ]) {
    writeGltf(at(file), list, how);
    same((await readScene(at(file))).meshes, metres, what);
  }
  fs.writeFileSync(at('tail.glb'), Buffer.concat([fs.readFileSync(at('a.glb')), Buffer.alloc(77, 9)]));
  same((await readScene(at('tail.glb'))).meshes, metres, 'bytes after the end');
});

test('covers of the eyes, and helpers for other programs, are left out', async () => {
  for (const name of ['CC_Base_EyeOcclusion', 'M_LacrimalFluid', 'tear_line', 'Eyeshell_mesh']) {
    writeObjAs(at('covered.obj'), [...parts, { ...parts[1], name }]);
    const { meshes, notes } = await readScene(at('covered.obj'));
    assert.deepEqual(meshes.map((mesh) => mesh.name), parts.map((part) => part.name));
    assert.match(notes.join(), /covers of the eyes.*: 1/);
  }
  writeObjAs(at('helped.obj'), [...parts, ...['joint-l-eye', 'helper-tights', 'helper-hair', 'helper-l-eye'].map((name) => ({ ...parts[1], name }))]);
  const { meshes, notes } = await readScene(at('helped.obj'));
  assert.deepEqual(meshes.map((mesh) => mesh.name), [...parts.map((part) => part.name), 'helper-l-eye']);
  assert.match(notes.join(), /MakeHuman's helpers are left out: 3/);
  writeObjAs(at('alone.obj'), [{ ...parts[1], name: 'EyeOcclusion' }]);
  assert.equal((await readScene(at('alone.obj'))).meshes.length, 1);
});

const comb = { name: 'comb', position: [0, 0, 0, 8, 0, 0, 8, 6, 0, 6, 6, 0, 6, 2, 0, 5, 2, 0, 5, 6, 0, 3, 6, 0, 3, 2, 0, 2, 2, 0, 2, 6, 0, 0, 6, 0], uv: Array(24).fill(0.5) };

test('reads faces with many corners, concave ones too, in any rotation and orientation', async () => {
  const turns = [([x, y, z]) => [x, y, z], ([x, y, z]) => [z, x, y], ([x, y, z]) => [-x, 0.6 * y - 0.8 * z, -0.8 * y - 0.6 * z]];
  for (const [t, turn] of turns.entries())
    for (let first = 0; first < 12; first++) {
      const place = Array.from({ length: 12 }, (_, v) => turn(comb.position.slice(3 * v, 3 * v + 3)));
      const face = Array.from({ length: 12 }, (_, v) => (v + first) % 12);
      const part = { ...comb, position: place.flat(), faces: [face] };
      const name = `comb${t}-${first}`;
      writeObjAs(at(`${name}.obj`), [part]);
      writePlyAs(at(`${name}.ply`), [part]);
      fs.writeFileSync(at(`${name}.wrl`), vrmlOf([part], { fields: 'convex FALSE' }));
      for (const kind of ['obj', 'ply', 'wrl']) {
        const { meshes } = await readScene(at(`${name}.${kind}`));
        const { area, normal } = measure(meshes[0]);
        assert.ok(Math.abs(area - 40) < 1e-3, `${name}.${kind}: ${area}`);
        assert.ok(turn([0, 0, 1]).every((x, k) => Math.abs(40 * x - normal[k]) < 1e-3), `${name}.${kind}: it looks to ${normal}`);
      }
    }
});

const shade = ([, y]) => (y > 0 ? [1, 0.5, 0.25] : [0.25, 0.5, 1]);

test('OBJ and PLY: reads all line ends, byte order marks, negative indices, continued lines, strips, missing pictures', async () => {
  const [, ...small] = parts;
  const skin = small.slice(0, 1);
  const one = (list) => list.map((part) => ({ ...part, name: 'mesh' }));
  for (const [what, file, list, write] of [
    ['CR LF', 'a.obj', small, (f) => writeObjAs(f, small, { end: '\r\n' })],
    ['CR', 'b.obj', small, (f) => writeObjAs(f, small, { end: '\r' })],
    ['a mark before the text', 'c.obj', small, (f) => writeObjAs(f, small, { before: '\uFEFF' })],
    ['counted back', 'd.obj', small, (f) => writeObjAs(f, small, { back: true })],
    ['lines that go on', 'e.obj', small, (f) => writeObjAs(f, small, { goesOn: true })],
    ['no texture coordinates', 'f.obj', small, (f) => writeObjAs(f, small, { uv: false })],
    ['a library that is gone', 'g.obj', small, (f) => writeObjAs(f, small, { library: 'gone.mtl' })],
    ['CR LF', 'a.ply', one(skin), (f) => writePlyAs(f, skin, { end: '\r\n' })],
    ['CR', 'b.ply', one(skin), (f) => writePlyAs(f, skin, { end: '\r' })],
    ['a strip', 'c.ply', one(skin), (f) => writePlyAs(f, skin, { strips: strip(skin[0].index) })],
    ['places on the texture for each corner', 'd.ply', one(skin), (f) => writePlyAs(f, skin, { wedges: true })],
    ['normals that are no numbers', 'e.ply', one(skin), (f) => writePlyAs(f, skin, { noNormals: true })],
  ]) {
    write(at(file));
    const scene = await readScene(at(file));
    same(scene.meshes, list, `${file}: ${what}`);
    if (file === 'g.obj') assert.match(scene.notes.join('\n'), /line 1: there is no file "gone\.mtl" beside it: left out/);
    if (file === 'd.ply') {
      assert.match(scene.notes.join('\n'), /gone\.png/);
      const { uv, from } = scene.meshes[0];
      assert.ok(from.every((v, i) => [0, 1].every((k) => Math.abs(uv[2 * i + k] - skin[0].uv[2 * v + k]) < 1e-5)), 'each where it was');
    }
  }
});

test('OBJ: finds a map with options, blanks and a foreign absolute path next to the file', async () => {
  fs.writeFileSync(at('her skin.png'), PNG.sync.write(new PNG({ width: 2, height: 2 })));
  for (const words of ['her skin.png', '-s 1 1 1 -o 0.5 her skin.png', '-bm 0.3 -clamp on her skin.png', 'C:\\Users\\she\\her skin.png', '/home/she/her skin.png']) {
    fs.writeFileSync(at('map.mtl'), `newmtl eye_l\r\nmap_Kd ${words}\r\n`);
    writeObjAs(at('map.obj'), parts.slice(1, 2), { library: 'map.mtl' });
    const { materials, notes } = await readScene(at('map.obj'));
    assert.equal(materials[0].picture?.width, 2, `${words}: ${notes}`);
  }
});

test('VRML97: reads its many forms', async () => {
  const eyes = parts.slice(1, 3);
  const far = eyes.map((part) => ({ ...part, position: part.position.map((x, i) => x / 10 - [1, 2, 3][i % 3]) }));
  const back = eyes.map((part) => ({ ...part, position: part.position.map((x, i) => (i % 3 ? x : -x)), index: part.index.map((_, i, list) => list[i - (i % 3) + [0, 2, 1][i % 3]]) }));
  const behind = (face) => [...face].reverse();
  const inTransform = (fields) => (shape, { name }) => `DEF ${name} Transform { ${fields} children [ ${shape} ] }`;
  const named = inTransform('');
  for (const [what, list, how] of [
    ['no commas', eyes, { wrap: named }],
    ['commas', eyes, { comma: ', ', wrap: named }],
    ['CR', eyes, { end: '\r', wrap: named }],
    ['ccw FALSE', eyes, { fields: 'ccw FALSE', faceOf: behind, wrap: named }],
    ['solid and creaseAngle', eyes, { fields: 'solid FALSE creaseAngle 1.57 normalPerVertex TRUE', wrap: named }],
    ['scale and shift', far, { wrap: inTransform('translation 10 20 30 scale 10 10 10') }],
    ['turned there and back', eyes, { wrap: (shape, { name }) => `DEF ${name} Transform { rotation 1 0 0 1.5708 center 1 2 3 children Transform { rotation -1 0 0 1.5708 center 1 2 3 children ${shape} } }` }],
    ['a mirror', back, { wrap: inTransform('scale -1 1 1') }],
    ['a mirror, ccw FALSE', back, { wrap: inTransform('scale -1 1 1'), fields: 'ccw FALSE', faceOf: behind }],
    ['the nearest of some', eyes, { wrap: (shape, { name }) => `DEF ${name} LOD { range [ 10 ] level [ ${shape} Shape { geometry Box { } } ] }` }],
    ['what is chosen', eyes, { wrap: (shape, { name }) => `DEF ${name} Switch { whichChoice 1 choice [ Group { } ${shape} ] }` }],
    ['routes', eyes, { wrap: named, tail: 'DEF T TimeSensor { cycleInterval 2 loop TRUE }\nROUTE T.fraction_changed TO T.set_x\n', head: 'NavigationInfo { type [ "EXAMINE" "ANY" ] speed 1.0 } Viewpoint { position 0 0 10 }' }],
  ]) {
    fs.writeFileSync(at('way.wrl'), vrmlOf(list, how));
    const scene = await readScene(at('way.wrl'));
    same(scene.meshes, eyes, what);
    if (what.startsWith('solid')) assert.ok(scene.materials.every(({ double_sided }) => double_sided));
  }
  const [eye] = eyes;
  const twice = `${vrmlOf([eye], { wrap: (shape) => `DEF eye_l Transform { children [ DEF S ${shape} ] }` })}\nDEF eye_r Transform { translation -60 0 0 children [ USE S ] }`;
  fs.writeFileSync(at('use.wrz'), zlib.gzipSync(`\uFEFF${twice}`));
  const { meshes } = await readScene(at('use.wrz'));
  same(meshes, [fetchOnce([eye, { ...eye, position: eye.position.map((x, i) => (i % 3 ? x : x - 60)) }].map((one) => ({ ...one, name: 'S' })), 'S')].map((one) => ({ ...one, name: 'S' })), 'USE, packed');
  fs.writeFileSync(at('cut.wrz'), zlib.gzipSync(twice).subarray(0, 4000));
  await assert.rejects(readScene(at('cut.wrz')), /cannot be unpacked/);
});

test("VRML 1.0: reads its many forms, LUCIA's among them", async () => {
  const eyes = parts.slice(1, 3);
  const far = eyes.map((part) => ({ ...part, position: part.position.map((x, i) => x / 10 - [1, 2, 3][i % 3]) }));
  const behind = (face) => [...face].reverse();
  const within = (before, after = '') => (nodes, { name }) => `DEF ${name} Separator { ${before} ${nodes} ${after} }`;
  for (const [what, list, how] of [
    ['a Separator each', eyes, {}],
    ["LUCIA's header", eyes, { header: '#VRML V2.0 ascii' }],
    ['clockwise', eyes, { fields: 'ShapeHints { vertexOrdering CLOCKWISE shapeType SOLID }', faceOf: behind }],
    ['a Transform', far, { wrap: within('Transform { translation 10 20 30 scaleFactor 10 10 10 }') }],
    ['a scale and a shift', far, { wrap: within('Translation { translation 10 20 30 } Scale { scaleFactor 10 10 10 }') }],
    ['a matrix', far, { wrap: within('MatrixTransform { matrix 10 0 0 0  0 10 0 0  0 0 10 0  10 20 30 1 }') }],
    ['turned there and back', eyes, { wrap: within('Rotation { rotation 1 0 0 1.5708 } Rotation { rotation -1 0 0 1.5708 }') }],
    ['a place that ends with its TransformSeparator', eyes, { wrap: within('TransformSeparator { Translation { translation 5 5 5 } }') }],
    ['what is chosen', eyes, { wrap: (nodes, { name }) => `Switch { whichChild 1 Cube { } DEF ${name} Separator { ${nodes} } }` }],
    ['the nearest of some', eyes, { wrap: (nodes, { name }) => `LOD { range [ 10 ] DEF ${name} Separator { ${nodes} } Cube { } }` }],
    ['words and masks', eyes, { wrap: within('Cylinder { parts (SIDES | TOP) radius 2 } FontStyle { family SERIF style (BOLD|ITALIC) } PerspectiveCamera { position 0 0 10 }') }],
  ]) {
    fs.writeFileSync(at('old.wrl'), vrml1Of(list, how));
    same((await readScene(at('old.wrl'))).meshes, eyes, what);
  }
  // a face set after the Separator of its points, as the thesis prints it; a node used twice; colours and a texture
  const [eye] = eyes;
  fs.writeFileSync(at('after.wrl'), vrml1Of([eye], { wrap: (nodes) => nodes.replace(/IndexedFaceSet.*/s, ''), last: vrml1Of([eye]).match(/IndexedFaceSet[^}]*}/)[0] }));
  same((await readScene(at('after.wrl'))).meshes.map((mesh) => ({ ...mesh, name: eye.name })), [eye], 'after its Separator');
  const quad = 'Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }';
  fs.writeFileSync(at('red.wrl'), `#VRML V1.0 ascii
Separator { Material { diffuseColor [ 1 0 0, 0 1 0, 0 0 1, 1 1 1 ] } MaterialBinding { value PER_VERTEX_INDEXED } ${quad}
  DEF Q IndexedFaceSet { coordIndex [ 0 1 2 3 -1 ] materialIndex [ 3 2 1 0 -1 ] } Translation { translation 0 0 5 } USE Q
  Texture2 { filename "gone.jpg" } TextureCoordinate2 { point [ 0 0, 1 0, 1 1, 0 1 ] } MaterialBinding { value OVERALL } IndexedFaceSet { coordIndex [ 0 1 2 3 -1 ] } }`);
  const { meshes, notes } = await readScene(at('red.wrl'));
  assert.equal(meshes.length, 3);
  assert.deepEqual([...meshes[0].colors.slice(0, 3)], [1, 1, 1]);
  assert.deepEqual([meshes[0], meshes[1]].map(({ position }) => position[2]), [0, 5]);
  assert.deepEqual([...meshes[2].uv], [0, 0, 1, 0, 1, 1, 0, 1]);
  assert.equal(meshes[2].colors, null);
  assert.match(notes.join(), /gone\.jpg/);
});

test('turns vertex colours into a picture of the skin', async (t) => {
  const skin = parts.slice(0, 1);
  const linear = (p) => shade(p).map((x) => ((x + 0.055) / 1.055) ** 2.4);
  const metric = placed(([x, y, z]) => [x / 1000, y / 1000, z / 1000]).slice(0, 1);
  fs.writeFileSync(at('c.wrl'), vrmlOf(skin, { color: shade }));
  writePlyAs(at('c.ply'), skin, { color: shade });
  writeObjAs(at('c.obj'), skin, { color: shade });
  writeGltf(at('c.glb'), metric, { color: linear });
  for (const file of ['c.ply', 'c.obj', 'c.wrl', 'c.glb']) {
    const scene = await readScene(at(file));
    const [{ colors, position: places }] = scene.meshes;
    for (let v = 0; v < places.length / 3; v++) assert.ok(shade([0, places[3 * v + 1]]).every((c, k) => Math.abs(colors[3 * v + k] - c) < 0.01), `${file}: vertex ${v}`);
    if (file !== 'c.ply') continue;
    const { head, notes } = makeHead(scene, toldIn((p) => p), { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] });
    assert.match(notes.join('\n'), /skin: the colours of its vertices were painted/, file);
    const { width, data } = PNG.sync.read(Buffer.from(head.textures.skin.data, 'base64'));
    const { position, uv } = unpack(head).parts.find(({ name }) => name === 'skin');
    let [right, front] = [0, 0];
    for (let v = 0; v < uv.length / 2; v++) {
      if (position[3 * v + 2] < -20 || Math.abs(position[3 * v + 1]) < 3) continue;
      const x = Math.min(width - 1, Math.floor(uv[2 * v] * width));
      const y = Math.min(width - 1, Math.floor((1 - uv[2 * v + 1]) * width));
      const wanted = shade([0, position[3 * v + 1]]);
      front++;
      if (wanted.every((c, k) => Math.abs(255 * c - data[4 * (y * width + x) + k]) < 8)) right++;
    }
    t.diagnostic(`${file}: ${right} of ${front} vertices of the face have their colour`);
    assert.ok(right > 0.97 * front && front > 2000, `${file}: ${right} of ${front}`);
  }
});

test('glTF: adds the form that targets give a person at rest, not expressions; a shape that moves nothing gives way to one that does', async () => {
  const [eye] = parts.slice(1, 2);
  const count = eye.position.length / 3;
  const along = (k) => Float32Array.from({ length: 3 * count }, (_, i) => (i % 3 === k ? 0.001 : 0));
  const targets = { longNose: along(2), jawOpen: new Float32Array(3 * count), mouthOpen: along(1), mouthSmile: along(0) };
  const metric = placed(([x, y, z]) => [x / 1000, y / 1000, z / 1000]).slice(1, 2);
  writeGltf(at('plain.glb'), metric, {});
  const { json, binary } = partsOf(fs.readFileSync(at('plain.glb')));
  const bytes = [binary];
  let from = binary.length;
  const primitive = json.meshes[0].primitives[0];
  primitive.targets = Object.values(targets).map((deltas) => {
    const block = Buffer.from(deltas.buffer);
    bytes.push(block);
    json.bufferViews.push({ buffer: 0, byteOffset: from, byteLength: block.length });
    from += block.length;
    return { POSITION: json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType: 5126, type: 'VEC3', count }) - 1 };
  });
  json.buffers[0].byteLength = from;
  json.meshes[0].extras = { targetNames: Object.keys(targets) };
  const rest = (await readScene(at('plain.glb'))).meshes[0].position;
  const shift = async (change) => {
    const copy = JSON.parse(JSON.stringify(json));
    change(copy);
    fs.writeFileSync(at('formed.glb'), writeGlb({ json: copy, binary: Buffer.concat(bytes) }));
    const [mesh] = (await readScene(at('formed.glb'))).meshes;
    assert.ok(mesh.targets.jawOpen.some((x) => x), 'mouthOpen in place of the jawOpen that moves nothing');
    return [0, 1, 2].map((k) => Math.round(1e6 * (mesh.position[k] - rest[k])) / 1e6);
  };
  const none = [0, 0, 0];
  assert.deepEqual(await shift(() => {}), none);
  const moved = await shift((copy) => (copy.meshes[0].weights = [2, 1, 1, 1]));
  assert.ok(Math.abs(Math.hypot(...moved) - 0.002) < 1e-6, `${moved}`);
  assert.deepEqual(await shift((copy) => (copy.nodes.find((node) => node.mesh === 0).weights = [2, 0, 0, 0])), moved, "the node's weights override the mesh's");
  assert.deepEqual(await shift((copy) => (copy.meshes[0].weights = [0, 0, 0, 1])), none, 'nobody smiles at rest');
});

test('recognises names of nodes, materials of a head, and words that end like a side', () => {
  for (const [name, part] of [['eyeL', 'eye_l'], ['Eye.R.001', 'eye_r'], ['eye_l_low', 'eye_l'], ['L_eye', 'eye_l'], ['Eyeball', 'eyes'], ['EyeMaterial', 'eyes'], ['Eye Cover', 'eyes'], ['EyeLeft', 'eye_l'], ['FaceEyeline', 'lashes']]) assert.equal(guessPart(name), part, name);
  const materials = [{ name: 'Teeth' }, { name: 'Material.001' }];
  assert.equal(partOf({ name: 'Sphere.003', also: 'Eye_L', material: 1 }, { materials }), 'eye_l');
  assert.equal(partOf({ name: 'Head', also: '', material: 0 }, { materials }), 'teeth');
  assert.equal(partOf({ name: 'Head', also: '', material: 1 }, { materials }), 'skin');
});

test('a part with several materials uses the texture of its largest textured mesh', () => {
  const picture = { type: 'image/png', width: 1, height: 1, data: Buffer.alloc(1) };
  const materials = [{ name: 'plain', picture: null }, { name: 'face', picture }, { name: 'other', picture: null }];
  const [skin, eye] = parts;
  const meshOf = ({ position, index }, material) => ({ name: 'x', part: 'skin', material, position, uv: null, index, targets: {} });
  const [part] = gatherParts({ meshes: [meshOf(eye, 0), meshOf(eye, 1), meshOf(skin, 2)], materials, notes: [] });
  assert.equal(part.material, 1);
});

/** The skin as a face and a body, as programs cut it: by triangles. */
function cutAt(height) {
  const [skin] = parts;
  const half = (above) => {
    const index = skin.index.filter((_, i, list) => {
      const corners = [0, 1, 2].map((k) => list[i - (i % 3) + k]);
      return corners.every((v) => skin.position[3 * v + 1] > height) === above;
    });
    const kept = [...new Set(index)];
    const number = new Map(kept.map((v, n) => [v, n]));
    return { name: above ? 'face' : 'body', position: kept.flatMap((v) => skin.position.slice(3 * v, 3 * v + 3)), uv: kept.flatMap((v) => skin.uv.slice(2 * v, 2 * v + 2)), index: index.map((v) => number.get(v)) };
  };
  return [half(false), half(true)];
}

test('a skin with two pictures becomes two parts, the face first, that move together', async () => {
  const options = { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] };
  for (const [name, side] of [['face', 2], ['body', 4]]) fs.writeFileSync(at(`${name}.png`), PNG.sync.write(new PNG({ width: side, height: side })));
  const halves = [...cutAt(-100), ...parts.slice(1)];
  fs.writeFileSync(at('two.mtl'), halves.map(({ name }) => `newmtl ${name}\nKd 1 1 1\n${['face', 'body'].includes(name) ? `map_Kd ${name}.png\n` : ''}`).join(''));
  writeObjAs(at('two.obj'), halves, { library: 'two.mtl' });
  writeObjAs(at('one.obj'), halves);
  const made = [];
  for (const file of ['two.obj', 'one.obj']) made.push(makeHead(await readScene(at(file)), toldIn((p) => p), options));
  const [{ head, notes }, { head: whole }] = made;
  assert.equal(violations('head-model', head), null);
  assert.match(notes.join('\n'), /skin: its 2 pictures make it skin, skin_2/);
  assert.deepEqual(head.parts.map(({ name }) => name).filter((name) => name.startsWith('skin')), ['skin', 'skin_2']);
  const width = (name) => head.textures[head.materials[head.parts.find((part) => part.name === name).material].texture].width;
  assert.deepEqual([width('skin'), width('skin_2')], [2, 4], 'each has its own picture');
  assert.deepEqual(whole.parts.map(({ name }) => name).filter((name) => name.startsWith('skin')), ['skin']);
  const gone = (json, faps) => {
    const places = new Map();
    const moving = unpack(json);
    for (const part of moving.parts.filter(({ name }) => name.startsWith('skin'))) {
      const posed = pose(moving, part, faps);
      for (let v = 0; v < posed.length; v += 3) {
        const key = [...part.position.slice(v, v + 3)].map((x) => Math.round(10 * x)).join();
        const by = [0, 1, 2].map((k) => posed[v + k] - part.position[v + k]);
        if (places.has(key)) assert.ok(Math.hypot(...by.map((x, k) => x - places.get(key)[k])) < 0.05, `${key} comes apart`);
        places.set(key, by);
      }
    }
    return places;
  };
  for (const faps of [{ 3: 500, 5: -200 }, { 48: 20000, 49: 30000 }, { 12: 300, 59: 300 }]) {
    const [two, one] = [head, whole].map((json) => gone(json, faps));
    let compared = 0;
    for (const [key, by] of two) {
      if (!one.has(key)) continue; // rounded another way
      compared++;
      assert.ok(Math.hypot(...by.map((x, k) => x - one.get(key)[k])) < 0.05, `${JSON.stringify(faps)}: ${key} goes by ${by}, not ${one.get(key)}`);
    }
    assert.ok(compared > 0.5 * one.size, `${compared} of ${one.size}`);
  }
});

test('rejects a part with too many vertices, naming its meshes', async () => {
  const side = 250;
  const grid = { name: 'body', position: [], uv: [], index: [] };
  for (let j = 0; j < side; j++)
    for (let i = 0; i < side; i++) {
      grid.position.push(i, -120 - j, -40);
      grid.uv.push(0, 0);
      if (i && j) grid.index.push(j * side + i, j * side + i - 1, (j - 1) * side + i);
    }
  writeObjAs(at('many.obj'), [...parts, grid]);
  const scene = await readScene(at('many.obj'));
  assert.throws(() => makeHead(scene, toldIn((p) => p), { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] }), { message: /skin.*has \d{5} vertices \(skin \d+, body \d+\), more than 65535/ });
});

test('the portrait shows the chin, however long the face', async () => {
  const shown = [1, 2].map((long) => {
    const place = ([x, y, z]) => [x, y < 0 ? long * y : y, z];
    writeObjAs(at(`long-${long}.obj`), placed(place));
    return readScene(at(`long-${long}.obj`)).then((scene) => makeHead(scene, toldIn(place), { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] }).head);
  });
  for (const { view, fdp } of await Promise.all(shown)) {
    const half = Math.tan((view.fov * Math.PI) / 360) * (view.distance - fdp['2.1'][2]);
    assert.ok(view.target[1] - fdp['2.1'][1] < 0.9 * half, `chin at ${fdp['2.1']}, ${view.distance} mm away`);
  }
});

test('the portrait shows high hair, and of a tower as much as the face leaves', async () => {
  for (const [high, whole] of [[120, true], [165, true], [400, false]]) {
    const hair = { name: 'hair', position: [-40, 60, 0, 40, 60, 0, 0, high, -20], uv: [0, 0, 0, 0, 0, 0], index: [0, 1, 2] };
    writeObjAs(at('high.obj'), [...parts, hair]);
    const { head: { view, fdp } } = makeHead(await readScene(at('high.obj')), toldIn((p) => p), { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] });
    const half = Math.tan((view.fov * Math.PI) / 360);
    assert.equal(view.target[1] + half * view.distance > high, whole, `${high}: ${JSON.stringify(view)}`);
    assert.ok(view.target[1] - fdp['2.1'][1] < 0.9 * half * (view.distance - fdp['2.1'][2]), `${high}: the chin`);
    assert.ok(view.distance < 750, `${high}: ${view.distance} mm away`);
  }
});

test('lips that are a mesh of their own are the face', async () => {
  const { openEye } = await import(path.join(models, 'tools/import/faccia-eye.mjs'));
  const { fdp, fapu } = mara;
  const isLip = ({ position, index }, t) => {
    const [x, y, z] = [0, 1, 2].map((k) => [0, 1, 2].reduce((sum, c) => sum + position[3 * index[t + c] + k], 0) / 3);
    return Math.hypot(x / (0.6 * fapu.MW), (y - fdp['8.4'][1]) / (1.3 * (fdp['8.1'][1] - fdp['8.2'][1]) / 2)) < 1 && z > fdp['8.4'][2] - 4;
  };
  const [skin, ...others] = parts;
  const cut = (name, wanted) => ({ ...skin, name, index: skin.index.filter((_, i) => isLip(skin, i - (i % 3)) === wanted) });
  const lips = cut('Object_7', true);
  assert.ok(lips.index.length > 300, `${lips.index.length / 3} triangles of lips`);
  writeObjAs(at('lips.obj'), [cut('Object_1', false), lips, ...others]);
  const scene = await readScene(at('lips.obj'));
  const { points, notes } = await findPoints(scene, await openEye());
  assert.match(notes.join('\n'), /the lips are a mesh of their own: they were joined/);
  const head = unpack(makeHead(scene, points, { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] }).head);
  const part = head.parts.find(({ name }) => name === 'skin');
  assert.equal(part.index.length, skin.index.length);
  const gap = (faps) => {
    const moved = pose(head, part, faps);
    const [upper, lower] = ['2.2', '2.3'].map((name) => {
      const far = (v) => Math.hypot(...[0, 1, 2].map((k) => part.position[3 * v + k] - head.fdp[name][k]));
      const v = Array.from({ length: part.position.length / 3 }, (_, i) => i).reduce((best, i) => (far(i) < far(best) ? i : best));
      return moved[3 * v + 1];
    });
    return upper - lower;
  };
  assert.ok(gap({ 3: 600, 5: -500, 10: -400, 11: -400 }) - gap({}) > 4, `${gap({ 3: 600, 5: -500, 10: -400, 11: -400 })}, ${gap({})}`);
});

test('finds the face in any unit, axes and orientation, and turns the outside out', async (t) => {
  const { openEye } = await import(path.join(models, 'tools/import/faccia-eye.mjs'));
  const eye = await openEye();
  const turn = (part, over) => (over ? { ...part, index: part.index.map((_, i, list) => list[i - (i % 3) + [0, 2, 1][i % 3]]) } : part);
  for (const [what, place, over, axes, unit] of [
    ['inches, as a camera has it, inside out', ([x, y, z]) => [x / 25.4, -y / 25.4, -z / 25.4 + 16], true, 'y down, looking to -z', 25.4],
    ['lying on its side', ([x, y, z]) => [-y, -x, -z], false, 'x down, looking to -z', 1],
  ]) {
    writeObjAs(at('axes.obj'), placed(place).map((part) => turn(part, over)));
    const scene = await readScene(at('axes.obj'));
    const { points, notes } = await findPoints(scene, eye);
    assert.match(notes[0], new RegExp(`${axes.replace('+', '\\+')}, ${unit} mm a unit`), what);
    const { head, notes: made } = makeHead(scene, points, { name: 'x', title: 'x', licence: 'CC0-1.0', credits: [] });
    assert.equal(made.some((note) => /inside out/.test(note)), over, what);
    const found = unpack(head);
    same(found.parts, parts, what);
    t.diagnostic(`${what}: mouth ${found.fapu.MW.toFixed(1)} for ${mara.fapu.MW.toFixed(1)} mm`);
  }
});

test('glTF: meshopt is unpacked under its old name and its new one', async () => {
  const whole = takenApart(fs.readFileSync(path.join(models, 'heads/mara.glb')));
  const how = { meshes: whole.meshes.filter(({ name }) => ['skin', 'eye_l'].includes(name)), rename: (name) => (name === 'jawOpen' ? name : null) };
  const read = async (name, bytes) => {
    fs.writeFileSync(at(name), bytes);
    return (await readScene(at(name))).meshes;
  };
  const plain = await read('plain.glb', strange(whole, how));
  const packed = strange(whole, { ...how, store: 'packed' });
  for (const meshes of [await read('old.glb', packed), await read('new.glb', await newMeshopt(partsOf(packed)))]) {
    assert.deepEqual(meshes.map(({ name }) => name), plain.map(({ name }) => name));
    meshes.forEach(({ position, targets }, i) => assert.deepEqual([position, targets], [plain[i].position, plain[i].targets]));
  }
});
