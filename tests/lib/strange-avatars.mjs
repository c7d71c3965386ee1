// SPDX-License-Identifier: GPL-3.0-or-later
// Avatars in the styles of many programs: takes a faccia avatar apart and writes it with other names, bones, axes, units and encodings. The mesh
// `skin` keeps the order of its vertices, which tests rely on.
import { readGlb } from './glb.mjs';
import { writeGlb } from './foreign-avatars.mjs';

const METRES = 1.55; // height of the eyes in faccia's exports

/** @param {Buffer} bytes exported by faccia @returns {{meshes: object[], json: object, pictures: object[]}} with all targets dense */
export function takenApart(bytes) {
  const { json, numbers } = readGlb(bytes);
  const binary = bytes.subarray(28 + bytes.readUInt32LE(12));
  const meshes = json.meshes.filter(({ name }) => name !== 'stand').map(({ name, primitives: [primitive], extras }) => ({
    name,
    material: primitive.material,
    position: Float32Array.from(numbers(primitive.attributes.POSITION)),
    normal: Float32Array.from(numbers(primitive.attributes.NORMAL)),
    uv: Float32Array.from(numbers(primitive.attributes.TEXCOORD_0)),
    index: Uint32Array.from(numbers(primitive.indices)),
    targets: Object.fromEntries((extras?.targetNames ?? []).map((target, i) => [target, Float32Array.from(numbers(primitive.targets[i].POSITION))])),
  }));
  const pictures = json.images.map(({ bufferView, ...image }) => {
    const { byteOffset = 0, byteLength } = json.bufferViews[bufferView];
    return { ...image, data: binary.subarray(byteOffset, byteOffset + byteLength) };
  });
  return { meshes, json, pictures };
}

/** Encodes vertices in meshopt's format (codec 0, all groups uncompressed): no smaller, but valid for decoders. */
export function meshopt(data, stride) {
  const count = data.length / stride;
  const most = Math.min(256, Math.floor(8192 / stride) & ~15);
  const out = [0xa0];
  const last = [...data.subarray(0, stride)];
  for (let from = 0; from < count; from += most) {
    const block = Math.min(most, count - from);
    for (let k = 0; k < stride; k++) {
      const groups = Math.ceil(block / 16);
      out.push(...Array(Math.ceil(groups / 4)).fill(255));
      for (let i = 0; i < 16 * groups; i++) {
        const value = i < block ? data[(from + i) * stride + k] : last[k];
        const delta = ((value - last[k]) << 24) >> 24;
        out.push(((delta >> 7) ^ (delta << 1)) & 255);
        last[k] = value;
      }
    }
  }
  return Buffer.from([...out, ...Array(Math.max(0, 32 - stride)).fill(0), ...data.subarray(0, stride)]);
}

const CODES = { Float32Array: 5126, Int16Array: 5122, Uint16Array: 5123, Uint32Array: 5125, Uint8Array: 5121 };
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };

/** Has meshopt's views named as Khronos does, their streams of version 1 and by its own encoder. @param {{json: object, binary: Buffer}} glb with views packed as `meshopt` does */
export async function newMeshopt({ json, binary }) {
  const [{ MeshoptEncoder }, { MeshoptDecoder }] = await Promise.all([import('../../web/node_modules/meshoptimizer/meshopt_encoder.js'), import('../../web/node_modules/meshoptimizer/meshopt_decoder.mjs')]);
  await Promise.all([MeshoptEncoder.ready, MeshoptDecoder.ready]);
  const pieces = [binary];
  let size = binary.length;
  for (const one of [...json.buffers, ...json.bufferViews]) {
    const { EXT_meshopt_compression: packed, ...extensions } = one.extensions ?? {};
    if (!packed) continue;
    const { count, byteStride, byteOffset, byteLength, mode } = packed;
    one.extensions = { ...extensions, KHR_meshopt_compression: packed };
    if (packed.fallback) continue;
    const plain = new Uint8Array(count * byteStride);
    MeshoptDecoder.decodeGltfBuffer(plain, count, byteStride, binary.subarray(byteOffset, byteOffset + byteLength), mode);
    const bytes = MeshoptEncoder.encodeGltfBuffer(plain, count, byteStride, mode, 1);
    Object.assign(packed, { byteOffset: size, byteLength: bytes.length });
    pieces.push(bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4));
    size += bytes.length + pieces.at(-1).length;
  }
  json.buffers[0].byteLength = size;
  for (const name of ['extensionsUsed', 'extensionsRequired']) json[name] = json[name].map((one) => one.replace('EXT_meshopt', 'KHR_meshopt'));
  return writeGlb({ json, binary: Buffer.concat(pieces) });
}

/** Builds a GLB. */
class Writer {
  constructor({ json, pictures }) {
    const { materials, textures, samplers } = json;
    this.json = { asset: { version: '2.0', generator: 'somebody' }, scene: 0, scenes: [{ nodes: [] }], nodes: [], meshes: [], accessors: [], bufferViews: [], materials, textures, samplers };
    this.blocks = [];
    this.size = 0;
    this.fallback = 0; // bytes of the uncompressed fallback buffer
    this.json.images = pictures.map(({ data, ...image }) => ({ ...image, bufferView: this.view(data) }));
  }

  view(data, packed = 0) {
    const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
    const kept = packed ? meshopt(bytes, packed) : bytes;
    const place = { buffer: 0, byteOffset: this.size, byteLength: kept.length };
    const padded = Buffer.concat([kept, Buffer.alloc((4 - (kept.length % 4)) % 4)]);
    this.blocks.push(padded);
    this.size += padded.length;
    if (!packed) return this.json.bufferViews.push(place) - 1;
    const own = { buffer: 1, byteOffset: this.fallback, byteLength: bytes.length, byteStride: packed };
    this.fallback += bytes.length;
    const extensions = { EXT_meshopt_compression: { ...place, byteStride: packed, mode: 'ATTRIBUTES', count: bytes.length / packed } };
    return this.json.bufferViews.push({ ...own, extensions }) - 1;
  }

  accessor(list, type, { packed = false, normalized, how = 'plain' } = {}) {
    const one = { componentType: CODES[list.constructor.name], type, count: list.length / WIDTHS[type], ...(normalized ? { normalized } : {}) };
    if (how === 'sparse') {
      const at = [];
      for (let v = 0; v < one.count; v++) if (list[3 * v] || list[3 * v + 1] || list[3 * v + 2]) at.push(v);
      if (!at.length) at.push(0);
      const values = list.constructor.from(at.flatMap((v) => [...list.subarray(3 * v, 3 * v + 3)]));
      one.sparse = { count: at.length, indices: { bufferView: this.view(Uint16Array.from(at)), componentType: 5123 }, values: { bufferView: this.view(values) } };
    } else if (list instanceof Int16Array) {
      const wide = Int16Array.from({ length: 4 * one.count }, (_, i) => (i % 4 < 3 ? list[3 * (i >> 2) + (i % 4)] : 0)); // strides are multiples of 4
      one.bufferView = this.view(wide);
      this.json.bufferViews[one.bufferView].byteStride = 8;
    } else one.bufferView = this.view(list, packed ? list.BYTES_PER_ELEMENT * WIDTHS[type] : 0);
    if (type === 'VEC3') {
      const of = (least) => [0, 1, 2].map((k) => list.reduce((best, x, i) => (i % 3 === k && !Number.isNaN(x) ? least(best, x) : best), list[k] || 0));
      Object.assign(one, { min: of((a, b) => Math.min(a, b)), max: of((a, b) => Math.max(a, b)) });
    }
    return this.json.accessors.push(one) - 1;
  }

  node(node) {
    return this.json.nodes.push(node) - 1;
  }

  done() {
    const { json } = this;
    json.buffers = [{ byteLength: this.size }];
    if (this.fallback) {
      json.buffers.push({ byteLength: this.fallback, extensions: { EXT_meshopt_compression: { fallback: true } } });
      json.extensionsUsed = json.extensionsRequired = ['EXT_meshopt_compression'];
    }
    return writeGlb({ json, binary: Buffer.concat(this.blocks) });
  }
}

const BODY = [ // bottom, top, half widths, m
  [[0, 1.3, -0.07], [0, 0.92, -0.06], 0.17, 0.11], [[0.2, 1.34, -0.08], [0.7, 1.34, -0.08], 0.05, 0.05], [[-0.2, 1.34, -0.08], [-0.7, 1.34, -0.08], 0.05, 0.05],
  [[0.09, 0.9, -0.06], [0.09, 0.02, -0.06], 0.08, 0.08], [[-0.09, 0.9, -0.06], [-0.09, 0.02, -0.06], 0.08, 0.08],
];

/** A simple body below the head, as one mesh. */
export function bodyMesh(material) {
  const [position, normal, index] = [[], [], []];
  const sides = 12;
  for (const [from, to, wide, deep] of BODY) {
    const first = position.length / 3;
    const lying = Math.abs(to[0] - from[0]) > 0.3;
    for (const end of [from, to])
      for (let i = 0; i < sides; i++) {
        const [c, s] = [Math.cos((2 * Math.PI * i) / sides), Math.sin((2 * Math.PI * i) / sides)];
        const off = lying ? [0, wide * c, deep * s] : [wide * c, 0, deep * s];
        position.push(...end.map((x, k) => x + off[k]));
        normal.push(...(lying ? [0, c, s] : [c, 0, s]));
      }
    for (let i = 0; i < sides; i++) {
      const [a, b] = [first + i, first + ((i + 1) % sides)];
      index.push(a, b, a + sides, b, b + sides, a + sides);
    }
  }
  return { name: 'Body', material, position: Float32Array.from(position), normal: Float32Array.from(normal), uv: new Float32Array((2 * position.length) / 3), index: Uint32Array.from(index), targets: {} };
}

/** Joins meshes to one with the targets of all. */
export function joined(meshes, name) {
  const counts = meshes.map(({ position }) => position.length / 3);
  const all = (key) => Float32Array.from(meshes.flatMap((mesh) => [...mesh[key]]));
  let first = 0;
  const index = meshes.flatMap((mesh, i) => {
    const shifted = [...mesh.index].map((v) => v + first);
    first += counts[i];
    return shifted;
  });
  const names = [...new Set(meshes.flatMap(({ targets }) => Object.keys(targets)))];
  const targets = Object.fromEntries(names.map((target) => {
    const whole = new Float32Array(3 * first);
    let at = 0;
    meshes.forEach(({ targets: { [target]: own } }, i) => {
      if (own) whole.set(own, 3 * at);
      at += counts[i];
    });
    return [target, whole];
  }));
  return { name, material: meshes[0].material, position: all('position'), normal: all('normal'), uv: all('uv'), index: Uint32Array.from(index), targets };
}

/**
 * @param {ReturnType<typeof takenApart>} whole
 * @param {object} [how] rename: new name of a target, null removes it; names: false = omit target names; meshes: those to write; above: parent nodes, innermost
 *   first; turn: transforms each position and displacement; store: 'plain', 'sparse', 'short' (quantised), 'packed' (meshopt); bones: [name, position in m,
 *   parent's name, weight of a vertex: (mesh, vertex) => 0..1]; add: modifies the final JSON
 * @returns {Buffer}
 */
export function strange(whole, { rename = (name) => name, names = true, meshes = whole.meshes, above = [], turn = (p) => p, store = 'plain', bones = [], normals = true, add = () => {} } = {}) {
  const out = new Writer(whole);
  const { json } = out;
  const laid = (list) => {
    const turned = new Float32Array(list.length);
    for (let i = 0; i < list.length; i += 3) turned.set(turn([list[i], list[i + 1], list[i + 2]]), i);
    return turned;
  };
  const packed = store === 'packed';
  const order = bones.map(([name]) => name);
  const most = 32767;
  for (const mesh of meshes) {
    const count = mesh.position.length / 3;
    const position = laid(mesh.position);
    const kept = Object.entries(mesh.targets).flatMap(([name, list]) => (rename(name) === null ? [] : [[rename(name), laid(list)]]));
    const reach = position.reduce((best, x) => Math.max(best, Math.abs(x)), 0);
    const shorts = (list) => Int16Array.from(list, (x) => Math.round((x / reach) * most));
    const place = (list) => (store === 'short' ? out.accessor(shorts(list), 'VEC3', { normalized: true }) : out.accessor(list, 'VEC3', { packed, how: 'plain' }));
    const primitive = { material: mesh.material, indices: out.accessor(mesh.index, 'SCALAR'), attributes: { POSITION: place(position), TEXCOORD_0: out.accessor(mesh.uv, 'VEC2', { packed }) } };
    if (normals) primitive.attributes.NORMAL = out.accessor(laid(mesh.normal), 'VEC3', { packed });
    if (kept.length) primitive.targets = kept.map(([, list]) => ({ POSITION: store === 'sparse' ? out.accessor(list, 'VEC3', { how: 'sparse' }) : place(list) }));
    const node = { name: mesh.name, mesh: json.meshes.length, ...(store === 'short' ? { scale: [reach, reach, reach] } : {}) };
    if (bones.length) {
      const [joints, weights] = [new Uint8Array(4 * count), new Float32Array(4 * count)];
      for (let v = 0; v < count; v++) {
        const shares = bones.map(([, , , share]) => share?.(mesh, v) ?? 0);
        const of = shares.map((share, i) => [share, i]).filter(([share]) => share > 0).sort((a, b) => b[0] - a[0]).slice(0, 4);
        const sum = of.reduce((total, [share]) => total + share, 0);
        of.forEach(([share, i], k) => {
          joints[4 * v + k] = i;
          weights[4 * v + k] = share / sum;
        });
        if (!of.length) weights[4 * v] = 1;
      }
      Object.assign(primitive.attributes, { JOINTS_0: out.accessor(joints, 'VEC4'), WEIGHTS_0: out.accessor(weights, 'VEC4') });
      node.skin = 0;
    }
    json.meshes.push({ name: mesh.name, primitives: [primitive], ...(kept.length && names ? { extras: { targetNames: kept.map(([name]) => name) } } : {}) });
    json.scenes[0].nodes.push(out.node(node));
  }
  if (bones.length) {
    const places = bones.map(([, at]) => turn(at));
    const made = bones.map(([name, , parent], i) => out.node({ name, translation: places[i].map((x, k) => x - (order.includes(parent) ? places[order.indexOf(parent)][k] : 0)) }));
    bones.forEach(([, , parent], i) => {
      const up = order.indexOf(parent);
      if (up < 0) json.scenes[0].nodes.push(made[i]);
      else (json.nodes[made[up]].children ??= []).push(made[i]);
    });
    const back = places.flatMap(([x, y, z]) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1]);
    json.skins = [{ joints: made, inverseBindMatrices: out.accessor(Float32Array.from(back), 'MAT4') }];
  }
  for (const node of above) json.scenes[0].nodes = [out.node({ ...node, children: json.scenes[0].nodes })];
  add(json);
  return out.done();
}

export { METRES };
