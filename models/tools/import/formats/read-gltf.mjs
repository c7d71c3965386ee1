// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Reads glTF 2.0 and GLB (Khronos 2021), with KHR_mesh_quantization, EXT_texture_webp, and compression by meshopt, Draco and Basis
 * Universal. Checks every count against the available bytes before use, so that the error for a damaged file names the wrong member.
 */
import { isUsable, NO_PICTURE, pictureOf, readBeside, readIfBeside } from './beside.mjs';
import { FileError, MOST } from '../limits.mjs';
import { pictureAsPng } from '../mesh/png.mjs';
import { MOST_PIXELS, pictureSize } from '../../../../web/element/head/model/picture-size.mjs';
import { MESHOPT, oldMeshopt, plainLook, shapedBy } from '../../../../web/element/avatar/extensions.mjs';
import { readPoints } from './points.mjs';
import { asTriangles, turnedOver } from '../mesh/triangles.mjs';
import { fromLinear } from '../mesh/paint.mjs';
import { isExpression, targetNamer } from './target-names.mjs';
import { textOf } from './text.mjs';
import { apply, linear, matrixOf, mirrors, product } from './matrix.mjs';

const TYPES = { 5120: [Int8Array, 1, 127], 5121: [Uint8Array, 1, 255], 5122: [Int16Array, 2, 32767], 5123: [Uint16Array, 2, 65535], 5125: [Uint32Array, 4, 1], 5126: [Float32Array, 4, 1] };
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };
const DRACO = 'KHR_draco_mesh_compression';
const BASIS = 'KHR_texture_basisu';
const SIDE = 2048; // size in pixels to choose from a packed picture with several sizes
const KNOWN = ['KHR_mesh_quantization', MESHOPT, DRACO, BASIS, 'EXT_texture_webp', 'KHR_texture_transform', 'KHR_materials_unlit', 'KHR_materials_specular', 'KHR_materials_ior', 'KHR_materials_pbrSpecularGlossiness', 'VRMC_vrm', 'VRM'];
const LISTS = ['accessors', 'bufferViews', 'buffers', 'extensionsRequired', 'images', 'materials', 'meshes', 'nodes', 'scenes', 'skins', 'textures'];
const whole = (value) => Number.isInteger(value) && value >= 0;

function chunksOf(bytes) {
  if (bytes.length < 20 || bytes.toString('latin1', 0, 4) !== 'glTF') return { text: textOf(bytes), binary: null };
  if (bytes.readUInt32LE(4) !== 2) throw new FileError('byte 4', `version ${bytes.readUInt32LE(4)} is not known, only 2 is`);
  const length = bytes.readUInt32LE(8); // what follows is of no concern to others either
  if (length > bytes.length) throw new FileError('byte 8', `the file says that it has ${length} bytes, and has ${bytes.length}: it was cut short`);
  const found = {};
  for (let at = 12; at < length; ) {
    if (at + 8 > length) throw new FileError(`byte ${at}`, 'a chunk is cut short');
    const [size, kind] = [bytes.readUInt32LE(at), bytes.readUInt32LE(at + 4)];
    if (at + 8 + size > length) throw new FileError(`byte ${at}`, `a chunk of ${size} bytes goes beyond the end of the file`);
    found[kind] ??= bytes.subarray(at + 8, at + 8 + size);
    at += 8 + size;
  }
  if (!found[0x4e4f534a]) throw new FileError('byte 12', 'there is no JSON chunk');
  return { text: found[0x4e4f534a].toString('utf8'), binary: found[0x004e4942] ?? null };
}

class Gltf {
  constructor(file, json, binary, budget) {
    Object.assign(this, { file, json, binary, budget, notes: [], views: [], buffers: [], pictures: new Map(), nameOf: targetNamer(json) });
  }

  member(list, i, place) {
    const found = whole(i) ? this.json[list]?.[i] : undefined;
    if (typeof found !== 'object' || found === null) throw new FileError(place, `there is no ${list}[${i}]`);
    return found;
  }

  buffer(i, place) {
    return (this.buffers[i] ??= this.readBuffer(i, place));
  }

  readBuffer(i, place) {
    const { uri, byteLength } = this.member('buffers', i, place);
    const bytes = typeof uri === 'string' ? readBeside(this.file, uri, `buffers[${i}].uri`) : i === 0 ? this.binary : null;
    if (!bytes) throw new FileError(`buffers[${i}]`, 'its bytes are missing');
    this.budget.keep(bytes === this.binary ? 0 : bytes.length / 8, `buffers[${i}]`);
    if (!whole(byteLength) || byteLength > bytes.length) throw new FileError(`buffers[${i}].byteLength`, `${byteLength} bytes are wanted, ${bytes.length} are there`);
    return bytes;
  }

  async prepare() {
    const { json } = this;
    const used = (json.bufferViews ?? []).some((view) => view?.extensions?.[MESHOPT]);
    if (used) {
      this.meshopt = (await import('../../../../web/node_modules/meshoptimizer/meshopt_decoder.mjs')).MeshoptDecoder;
      await this.meshopt.ready;
    }
    if ((json.meshes ?? []).some((mesh) => mesh?.primitives?.some?.((primitive) => primitive?.extensions?.[DRACO])))
      this.draco = await (await import('../../../../web/element/avatar/packed/draco.mjs')).openDraco();
    if ((json.textures ?? []).some((texture) => texture?.extensions?.[BASIS])) this.basis = await (await import('../../../../web/element/avatar/packed/basis.mjs')).openBasis();
    for (const name of json.extensionsRequired ?? [])
      if (!KNOWN.includes(name)) this.passOver(String(name));
  }

  /** A required extension that does not affect the shape is ignored. */
  passOver(name) {
    const place = shapedBy(this.json, name);
    if (place) throw new FileError(place, `${name.slice(0, 60)} is not read: save the model without it`);
    this.notes.push(`extensionsRequired: ${name.slice(0, 60)} is not acted on`);
  }

  view(i, place) {
    return (this.views[i] ??= this.readView(i, place));
  }

  readView(i, place) {
    const view = this.member('bufferViews', i, place);
    const at = `bufferViews[${i}]`;
    const packed = view.extensions?.[MESHOPT];
    const { buffer, byteOffset = 0, byteLength } = packed ?? view;
    const bytes = this.buffer(buffer, at);
    if (!whole(byteOffset) || !whole(byteLength) || byteOffset + byteLength > bytes.length) throw new FileError(at, `goes beyond its buffer of ${bytes.length} bytes`);
    const piece = bytes.subarray(byteOffset, byteOffset + byteLength);
    if (!packed) return piece;
    const { count, byteStride, mode, filter } = packed;
    if (!whole(count) || !whole(byteStride)) throw new FileError(at, 'count and byteStride must be whole numbers');
    this.budget.keep((count * byteStride) / 8, at); // of all packed data together
    const out = new Uint8Array(count * byteStride);
    try {
      this.meshopt.decodeGltfBuffer(out, count, byteStride, piece, mode, filter);
    } catch (error) {
      throw new FileError(at, `cannot be unpacked: ${error.message}`);
    }
    return Buffer.from(out.buffer);
  }

  /** @returns {Float64Array|Uint32Array} all numbers of an accessor; loose: replaces values that are not numbers with 0, with a note */
  accessor(i, width, place, numbers = true, loose = false) {
    const accessor = this.member('accessors', i, place);
    const at = `accessors[${i}]`;
    const { count, componentType, type, byteOffset = 0, normalized, sparse } = accessor;
    const [Type, size, full] = TYPES[componentType] ?? [];
    if (!Type || WIDTHS[type] !== width) throw new FileError(at, `must be ${Object.keys(WIDTHS).find((name) => WIDTHS[name] === width)} of a known type`);
    if (!whole(count) || !count) throw new FileError(at, 'count must be a whole number above 0');
    if (count * width > MOST.numbers) throw new FileError(at, `${count} elements are too many for a head`);
    this.budget.keep(count * width, at); // counted for each reference
    this.budget.work(4 * count * width, at);
    const out = numbers ? new Float64Array(count * width) : new Uint32Array(count);
    const value = (data, offset) => new Type(data.buffer.slice(data.byteOffset + offset, data.byteOffset + offset + size))[0];
    const scaled = (x) => (normalized && Type !== Float32Array ? Math.max(-1, x / full) : x);
    if (accessor.bufferView !== undefined) {
      const data = this.view(accessor.bufferView, at);
      const packed = this.json.bufferViews[accessor.bufferView].extensions?.[MESHOPT];
      const stride = (packed ?? this.json.bufferViews[accessor.bufferView]).byteStride ?? width * size;
      if (!whole(byteOffset) || !whole(stride) || stride < width * size || byteOffset + stride * (count - 1) + width * size > data.length)
        throw new FileError(at, `${count} elements go beyond the ${data.length} bytes of bufferViews[${accessor.bufferView}]`);
      const read = new DataView(data.buffer, data.byteOffset, data.length);
      const get = { 5120: 'getInt8', 5121: 'getUint8', 5122: 'getInt16', 5123: 'getUint16', 5125: 'getUint32', 5126: 'getFloat32' }[componentType];
      for (let e = 0; e < count; e++) for (let k = 0; k < width; k++) out[e * width + k] = scaled(read[get](byteOffset + stride * e + k * size, true));
    }
    if (sparse) this.overwrite(out, sparse, { at, count, width, size, value, scaled });
    const wrong = out.findIndex((x) => !Number.isFinite(x));
    if (wrong < 0) return out;
    if (!loose) throw new FileError(at, `element ${Math.floor(wrong / width)} is not a number`);
    this.notes.push(`${at}: element ${Math.floor(wrong / width)} and others are not numbers: they move nothing`);
    return out.map((x) => (Number.isFinite(x) ? x : 0));
  }

  overwrite(out, sparse, { at, count, width, size, value, scaled }) {
    const where = `${at}.sparse`;
    const n = sparse.count;
    const [Index, indexSize] = TYPES[sparse.indices?.componentType] ?? [];
    if (!whole(n) || n > count || !Index) throw new FileError(where, 'must have a count, indices and values');
    const places = this.view(sparse.indices.bufferView, `${where}.indices`);
    const values = this.view(sparse.values?.bufferView, `${where}.values`);
    const [from, first] = [sparse.indices.byteOffset ?? 0, sparse.values.byteOffset ?? 0];
    if (from + n * indexSize > places.length || first + n * width * size > values.length) throw new FileError(where, 'goes beyond its bytes');
    for (let e = 0; e < n; e++) {
      const start = places.byteOffset + from + e * indexSize;
      const v = new Index(places.buffer.slice(start, start + indexSize))[0];
      if (v >= count) throw new FileError(`${where}.indices`, `element ${e} is ${v}, but there are ${count}`);
      for (let k = 0; k < width; k++) out[v * width + k] = scaled(value(values, first + (e * width + k) * size));
    }
  }

  /** Returns the attributes of a primitive compressed with Draco: positions, texture coordinates, indices. */
  unpack({ extensions, attributes = {}, indices }, at) {
    const { bufferView, attributes: ids = {} } = extensions[DRACO];
    const where = `${at}.extensions.${DRACO}`;
    const most = (i) => Math.min(this.budget.left, i === undefined ? Infinity : this.member('accessors', i, at).count);
    const wanted = Object.fromEntries(['POSITION', 'TEXCOORD_0'].filter((name) => whole(ids[name])).map((name) => [name, { id: ids[name], type: 'Float32Array' }]));
    try {
      const { index, count, attributes: own } = this.draco.decode(this.view(bufferView, where), wanted, { points: most(attributes.POSITION), corners: most(indices) });
      this.budget.keep(5 * count + index.length, where);
      if (own.POSITION?.width !== 3 || (own.TEXCOORD_0?.width ?? 2) !== 2) throw new Error('its places must have 3 numbers, its texture coordinates 2');
      if (!own.POSITION.array.every(Number.isFinite)) throw new Error('its places are no numbers');
      return { index, position: Float64Array.from(own.POSITION.array), uv: own.TEXCOORD_0 && Float64Array.from(own.TEXCOORD_0.array) };
    } catch (error) {
      throw error instanceof FileError ? error : new FileError(where, error.message);
    }
  }

  /** Returns pictures by texture number; notes those that cannot be shown. */
  picture(i, place) {
    const texture = this.member('textures', i, place);
    const source = texture.extensions?.[BASIS]?.source ?? texture.extensions?.EXT_texture_webp?.source ?? texture.source;
    if (source === undefined) {
      this.notes.push(`textures[${i}] has no picture that can be read`);
      return null;
    }
    const key = `${source} ${Boolean(texture.extensions?.[BASIS])}`;
    if (!this.pictures.has(key)) this.pictures.set(key, this.readPicture(source, texture, `textures[${i}]`)); // several materials may share one
    return this.pictures.get(key);
  }

  readPicture(source, texture, place) {
    const image = this.member('images', source, place);
    const at = `images[${source}]`;
    const bytes = image.bufferView !== undefined ? this.view(image.bufferView, at) : readIfBeside(this.file, String(image.uri ?? ''), `${at}.uri`, this.notes);
    if (!bytes) return null;
    this.budget.keep(bytes.length / 8, at);
    if (texture.extensions?.[BASIS]) return this.transcoded(bytes, at);
    const seen = pictureOf(bytes);
    if (!isUsable(seen, bytes)) {
      this.notes.push(`${at} is ${NO_PICTURE}`);
      return null;
    }
    return { ...seen, data: bytes };
  }

  transcoded(bytes, at) {
    const [width, height] = pictureSize(bytes) ?? [0, 0];
    this.budget.work(64 * Math.min(width * height, SIDE * SIDE), at);
    if (width * height > MOST_PIXELS) throw new FileError(at, `${width} x ${height} points are too many`);
    try {
      return pictureAsPng(this.basis.decode(bytes, SIDE));
    } catch (error) {
      this.notes.push(`${at}: ${error.message}: left out`);
      return null;
    }
  }
}

function materialsOf(gltf) {
  return (gltf.json.materials ?? []).map(plainLook).map((material, i) => {
    const look = material?.pbrMetallicRoughness ?? {};
    const at = `materials[${i}]`;
    const color = Array.isArray(look.baseColorFactor) && look.baseColorFactor.length === 4 && look.baseColorFactor.every(Number.isFinite) ? look.baseColorFactor : [1, 1, 1, 1];
    return {
      name: String(material?.name ?? `material ${i}`),
      color: color.slice(0, 3),
      roughness: Number.isFinite(look.roughnessFactor) ? look.roughnessFactor : 1,
      alpha: { MASK: 'cutout', BLEND: 'blend' }[material?.alphaMode] ?? 'opaque',
      double_sided: Boolean(material?.doubleSided),
      laid: laidOn(look.baseColorTexture, at),
      picture: look.baseColorTexture ? gltf.picture(look.baseColorTexture.index, `${at}.pbrMetallicRoughness.baseColorTexture`) : null,
    };
  });
}

/** Returns the coordinates of a mesh that a texture uses, and their transform. */
function laidOn(texture, at) {
  const change = texture?.extensions?.KHR_texture_transform;
  const { offset = [0, 0], scale = [1, 1], rotation = 0 } = change ?? {};
  if (![...offset, ...scale, rotation].every(Number.isFinite)) throw new FileError(`${at}.pbrMetallicRoughness.baseColorTexture`, 'its KHR_texture_transform must be of numbers');
  const [c, s] = [Math.cos(rotation), Math.sin(rotation)];
  const lay = (list) => list.map((_, i) => {
    const [u, v] = [list[i & ~1] * scale[0], list[i | 1] * scale[1]];
    return i & 1 ? v * c - u * s + offset[1] : u * c + v * s + offset[0];
  });
  return { set: `TEXCOORD_${change?.texCoord ?? texture?.texCoord ?? 0}`, lay: change ? lay : (list) => list };
}

/** Returns vertex colours in the encoding of pictures; null if all are equal. */
function colorsOf(gltf, i, count, at, factor = [1, 1, 1]) {
  if (i === undefined) return null;
  const width = WIDTHS[gltf.member('accessors', i, at).type];
  const list = gltf.accessor(i, width === 4 ? 4 : 3, at);
  if (list.length !== width * count) throw new FileError(at, `must have ${count} elements`);
  const colors = Float64Array.from({ length: 3 * count }, (_, k) => fromLinear(factor[k % 3] * list[width * Math.floor(k / 3) + (k % 3)]));
  return colors.some((x, k) => Math.abs(x - colors[k % 3]) > 0.01) ? colors : null;
}

function readPrimitive(gltf, mesh, primitive, at, matrix, look, weights) {
  const { mode = 4 } = primitive;
  if (![4, 5, 6].includes(mode)) {
    gltf.notes.push(`${at} is not of triangles: left out`);
    return null;
  }
  const attributes = primitive.attributes ?? {};
  const unpacked = primitive.extensions?.[DRACO] ? gltf.unpack(primitive, at) : null;
  const raw = unpacked?.position ?? gltf.accessor(attributes.POSITION, 3, `${at}.attributes.POSITION`);
  const count = raw.length / 3;
  const corners = unpacked ? unpacked.index : primitive.indices === undefined ? Uint32Array.from({ length: count }, (_, i) => i) : gltf.accessor(primitive.indices, 1, `${at}.indices`, false);
  const past = corners.findIndex((v) => v >= count);
  if (past >= 0) throw new FileError(`accessors[${primitive.indices}]`, `element ${past} is vertex ${corners[past]}, but there are ${count}`);
  const cut = mode === 4 || unpacked ? corners : asTriangles(mode, corners);
  if (cut.length % 3) throw new FileError(`${at}.indices`, 'there must be three for each triangle');
  const index = mirrors(matrix) ? turnedOver(cut) : cut;
  const set = attributes[look?.laid.set] === undefined ? 'TEXCOORD_0' : look.laid.set;
  const places = unpacked?.uv ?? (attributes[set] === undefined ? null : gltf.accessor(attributes[set], 2, `${at}.attributes.${set}`));
  if (places && places.length !== 2 * count) throw new FileError(`${at}.attributes.${set}`, `must have ${count} elements`);
  const uv = places && (look?.laid.lay(places) ?? places).map((x, i) => (i % 2 ? 1 - x : x));
  const colors = unpacked ? null : colorsOf(gltf, attributes.COLOR_0, count, `${at}.attributes.COLOR_0`, look?.color);
  const names = [mesh.extras?.targetNames, primitive.extras?.targetNames].find(Array.isArray) ?? [];
  const targets = {};
  (primitive.targets ?? []).forEach((target, i) => {
    gltf.budget.work(100 + gltf.json.meshes.length, `${at}.targets[${i}]`);
    if (target.POSITION === undefined) return;
    const deltas = gltf.accessor(target.POSITION, 3, `${at}.targets[${i}].POSITION`, true, true);
    if (deltas.length !== raw.length) throw new FileError(`${at}.targets[${i}].POSITION`, `must have ${count} elements`);
    const name = gltf.nameOf(gltf.json.meshes.indexOf(mesh), i, names[i] === undefined ? undefined : String(names[i]));
    // What a file adds at rest is the person's own form; a face that smiles or blinks at rest is imported without that.
    const weight = Number.isFinite(weights?.[i]) && !isExpression(name) ? weights[i] : 0;
    if (weight) for (let k = 0; k < raw.length; k++) raw[k] += weight * deltas[k];
    targets[name] = linear(matrix, deltas);
  });
  return { position: apply(matrix, raw), index, uv, colors, targets };
}

/** @param {string} file @param {Buffer} bytes */
export async function readGltf(file, bytes, budget) {
  const { text, binary } = chunksOf(bytes);
  let json;
  try {
    json = JSON.parse(text);
  } catch (error) {
    throw new FileError('JSON', error.message);
  }
  if (!String(json?.asset?.version ?? '').startsWith('2')) throw new FileError('asset.version', 'must be 2.0');
  for (const name of LISTS) if (json[name] !== undefined && !Array.isArray(json[name])) throw new FileError(name, 'must be a list');
  const gltf = new Gltf(file, oldMeshopt(json), binary, budget);
  await gltf.prepare();
  const materials = materialsOf(gltf);
  const world = new Map();
  const meshes = [];
  const walk = (i, above, place, depth) => {
    const node = gltf.member('nodes', i, place);
    if (depth > MOST.depth || world.has(i)) throw new FileError(`nodes[${i}]`, 'stands more than once in the scene');
    world.set(i, product(above, matrixOf(node, `nodes[${i}]`)));
    for (const child of node.children ?? []) walk(child, world.get(i), `nodes[${i}].children`, depth + 1);
  };
  const inOthers = new Set((json.nodes ?? []).flatMap((node) => node?.children ?? []));
  const scene = json.scenes ? gltf.member('scenes', json.scene ?? 0, 'scene').nodes ?? [] : (json.nodes ?? []).map((_, i) => i).filter((i) => !inOthers.has(i));
  for (const i of scene) walk(i, matrixOf({}, ''), 'scenes', 0);
  for (const [i, matrix] of world) {
    const node = json.nodes[i];
    if (node.mesh === undefined) continue;
    const mesh = gltf.member('meshes', node.mesh, `nodes[${i}].mesh`);
    const place = node.skin === undefined ? matrix : skinMatrix(gltf, node.skin, world, `nodes[${i}].skin`);
    (mesh.primitives ?? []).forEach((primitive, k) => {
      budget.work(1000, `meshes[${node.mesh}].primitives[${k}]`);
      if (meshes.length >= MOST.meshes) throw new FileError(`meshes[${node.mesh}]`, `more than ${MOST.meshes} meshes are no head`);
      if (primitive.material !== undefined) gltf.member('materials', primitive.material, `meshes[${node.mesh}].primitives[${k}].material`);
      const read = readPrimitive(gltf, mesh, primitive, `meshes[${node.mesh}].primitives[${k}]`, place, materials[primitive.material], node.weights ?? mesh.weights);
      if (read) meshes.push({ name: String(mesh.name ?? node.name ?? `mesh ${node.mesh}`), also: String(node.name ?? ''), material: primitive.material ?? -1, ...read });
    });
  }
  if (!meshes.length) throw new FileError('scenes', 'there is no mesh in it');
  return { meshes, materials, notes: gltf.notes, unit: 1000, copyright: json.asset.copyright, ...ownPoints(json.extras) };
}

/** A head exported by faccia contains its feature points. */
function ownPoints(extras) {
  if (!extras?.fdp || !Array.isArray(extras.origin) || !extras.origin.every(Number.isFinite)) return {};
  const { licence, credits, origin } = extras;
  const { fdp } = readPoints(JSON.stringify({ fdp: extras.fdp }));
  const texts = Array.isArray(credits) && credits.every((one) => typeof one === 'string');
  return { points: { frame: 'head', fdp, origin, parts: {}, influences: [] }, ...(typeof licence === 'string' ? { licence } : {}), ...(texts ? { credits } : {}) };
}

/** The bones determine the position of a skinned mesh: at rest they all agree. */
function skinMatrix(gltf, i, world, place) {
  const skin = gltf.member('skins', i, place);
  const joint = world.get(skin.joints?.[0]);
  if (!joint) throw new FileError(`skins[${i}].joints`, 'its first bone is not in the scene');
  if (skin.inverseBindMatrices === undefined) return joint;
  return product(joint, [...gltf.accessor(skin.inverseBindMatrices, 16, `skins[${i}].inverseBindMatrices`).subarray(0, 16)]);
}
