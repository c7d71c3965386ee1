// SPDX-License-Identifier: MIT
// Checks a GLB's references before use: every index refers to something that exists, all data lies within the file's bytes,
// and the total size is plausible for a head.
import { MESHOPT } from './extensions.mjs';
import { AvatarProblem } from './problem.mjs';

const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16 };
const SIZES = { 5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4 };
const MOST_NUMBERS = 1 << 26; // in all accessors together
const MOST_UNPACKED = 4 * MOST_NUMBERS; // bytes, of all views together: a view of a few bytes may unpack to millions
const MOST_VERTICES = 1 << 22; // as drawn, counted for each instance
const MOST_DEEP = 500; // nodes within nodes
const MOST_NODES = 20000;
const LISTS = ['accessors', 'bufferViews', 'buffers', 'images', 'materials', 'meshes', 'nodes', 'samplers', 'scenes', 'skins', 'textures'];
const TRANSFORMS = { translation: 3, rotation: 4, scale: 3, matrix: 16 };
const DRACO = 'KHR_draco_mesh_compression';

const damaged = (place, what) => new AvatarProblem('damaged', `${place}: ${what}`);
const tooLarge = (place, what) => new AvatarProblem('too-large', `${place}: ${what}`);
const isWhole = (value) => Number.isInteger(value) && value >= 0;
const isObject = (value) => value !== null && typeof value === 'object' && !Array.isArray(value);

/** @param {object} json of a GLB; every list in it becomes one */
export function checkReferences(json) {
  for (const name of LISTS) {
    const list = json[name] ?? [];
    if (!Array.isArray(list)) throw damaged(name, 'is no list');
    list.forEach((one, i) => {
      if (!isObject(one)) throw damaged(`${name}[${i}]`, 'is no object');
    });
  }
  const of = (name) => json[name] ?? [];
  const need = (name, i, place) => {
    if (!isWhole(i) || !of(name)[i]) throw damaged(place, `there is no ${name}[${i}]`);
    return of(name)[i];
  };
  const may = (name, i, place) => (i === undefined ? null : need(name, i, place));

  let unpacked = 0;
  of('bufferViews').forEach((view, i) => {
    const packed = view.extensions?.[MESHOPT];
    for (const [{ buffer, byteOffset = 0, byteLength }, place] of [[view, `bufferViews[${i}]`], ...(packed ? [[packed, `bufferViews[${i}].extensions.${MESHOPT}`]] : [])]) {
      const { byteLength: all } = need('buffers', buffer, `${place}.buffer`);
      if (!isWhole(byteOffset) || !isWhole(byteLength) || byteOffset + byteLength > all) throw damaged(place, `goes beyond the ${all} bytes of buffers[${buffer}]`);
    }
    const { count, byteStride } = packed ?? {};
    if (packed && !(isWhole(count) && isWhole(byteStride) && count * byteStride === view.byteLength))
      throw damaged(`bufferViews[${i}]`, `${count} elements of ${byteStride} bytes are not its ${view.byteLength} bytes`);
    if (packed) unpacked += view.byteLength;
    if (unpacked > MOST_UNPACKED) throw tooLarge(`bufferViews[${i}]`, `more than ${MOST_UNPACKED} bytes up to here when they are unpacked`);
  });

  let numbers = 0;
  of('accessors').forEach((accessor, i) => {
    const place = `accessors[${i}]`;
    const { count, type, componentType, bufferView, byteOffset = 0, sparse } = accessor;
    const [width, size] = [WIDTHS[type], SIZES[componentType]];
    if (!isWhole(count) || !width || !size) throw damaged(place, 'count, type or componentType is wrong');
    numbers += count * width;
    if (numbers > MOST_NUMBERS) throw tooLarge(place, `more than ${MOST_NUMBERS} numbers`);
    const fits = (view, offset, stride, elements, bytes, what) => {
      const { byteLength } = need('bufferViews', view, what);
      if (!isWhole(offset) || (elements && offset + stride * (elements - 1) + bytes > byteLength)) throw damaged(what, `${elements} elements go beyond the ${byteLength} bytes of bufferViews[${view}]`);
    };
    if (bufferView !== undefined) {
      const { byteStride = width * size } = need('bufferViews', bufferView, `${place}.bufferView`);
      fits(bufferView, byteOffset, byteStride, count, width * size, place);
    }
    if (sparse === undefined) return;
    const [indices, values] = [sparse?.indices, sparse?.values];
    if (!isWhole(sparse?.count) || sparse.count > count || ![1, 2, 4].includes(SIZES[indices?.componentType]) || !isObject(values)) throw damaged(`${place}.sparse`, 'count, indices or values are wrong');
    fits(indices.bufferView, indices.byteOffset ?? 0, SIZES[indices.componentType], sparse.count, SIZES[indices.componentType], `${place}.sparse.indices`);
    fits(values.bufferView, values.byteOffset ?? 0, width * size, sparse.count, width * size, `${place}.sparse.values`);
  });

  let targets = 0;
  const sizes = of('meshes').map(({ primitives }, i) => {
    if (!Array.isArray(primitives) || !primitives.length) throw damaged(`meshes[${i}].primitives`, 'is no list, or an empty one');
    return primitives.reduce((sum, primitive, k) => {
      const place = `meshes[${i}].primitives[${k}]`;
      if (!isObject(primitive) || !isObject(primitive.attributes)) throw damaged(place, 'has no attributes');
      const { count, type } = need('accessors', primitive.attributes.POSITION, `${place}.attributes.POSITION`);
      if (type !== 'VEC3') throw damaged(`${place}.attributes.POSITION`, `is of ${type}, not of VEC3`);
      const each = (attributes, where) => {
        if (!isObject(attributes)) throw damaged(where, 'is no object');
        for (const [name, accessor] of Object.entries(attributes)) {
          const one = need('accessors', accessor, `${where}.${name}`);
          if (one.count !== count) throw damaged(`${where}.${name}`, `has ${one.count} elements, and the mesh ${count} vertices`);
        }
      };
      each(primitive.attributes, `${place}.attributes`);
      if (primitive.targets !== undefined && !Array.isArray(primitive.targets)) throw damaged(`${place}.targets`, 'is no list');
      primitive.targets?.forEach((target, t) => each(target, `${place}.targets[${t}]`));
      may('accessors', primitive.indices, `${place}.indices`);
      may('materials', primitive.material, `${place}.material`);
      if (primitive.extensions?.[DRACO]) need('bufferViews', primitive.extensions[DRACO].bufferView, `${place}.extensions.${DRACO}.bufferView`);
      targets += (primitive.targets?.length ?? 0) * count * 3;
      if (targets > MOST_NUMBERS) throw tooLarge(place, `its targets have more than ${MOST_NUMBERS} numbers`);
      return sum + count;
    }, 0);
  });

  let vertices = 0;
  of('nodes').forEach((node, i) => {
    const place = `nodes[${i}]`;
    may('meshes', node.mesh, `${place}.mesh`);
    may('skins', node.skin, `${place}.skin`);
    vertices += sizes[node.mesh] ?? 0;
    if (vertices > MOST_VERTICES) throw tooLarge(place, `more than ${MOST_VERTICES} vertices`);
    for (const [name, width] of Object.entries(TRANSFORMS))
      if (node[name] !== undefined && !(Array.isArray(node[name]) && node[name].length === width && node[name].every(Number.isFinite))) throw damaged(`${place}.${name}`, `is not of ${width} numbers`);
  });
  checkTree(of('nodes'));
  if (json.scene !== undefined) need('scenes', json.scene, 'scene');
  of('scenes').forEach(({ nodes = [] }, i) => {
    if (!Array.isArray(nodes)) throw damaged(`scenes[${i}].nodes`, 'is no list');
    nodes.forEach((node, k) => need('nodes', node, `scenes[${i}].nodes[${k}]`));
  });
  of('skins').forEach(({ joints, inverseBindMatrices }, i) => {
    if (!Array.isArray(joints)) throw damaged(`skins[${i}].joints`, 'is no list');
    joints.forEach((joint, k) => need('nodes', joint, `skins[${i}].joints[${k}]`));
    const matrices = may('accessors', inverseBindMatrices, `skins[${i}].inverseBindMatrices`);
    if (matrices && (matrices.type !== 'MAT4' || matrices.count < joints.length)) throw damaged(`skins[${i}].inverseBindMatrices`, `must have ${joints.length} of MAT4`);
  });
  const texturesOf = (one, place, deep = 0) => {
    for (const [name, value] of Object.entries(one)) {
      if (!isObject(value) || deep > 4) continue;
      if (name.endsWith('Texture') && value.index !== undefined) need('textures', value.index, `${place}.${name}`);
      else texturesOf(value, `${place}.${name}`, deep + 1);
    }
  };
  of('materials').forEach((material, i) => texturesOf(material, `materials[${i}]`));
  of('images').forEach(({ bufferView }, i) => may('bufferViews', bufferView, `images[${i}].bufferView`));
}

/** That the nodes make trees, and no deep ones: a reader would go round in a circle for ever. */
function checkTree(nodes) {
  if (nodes.length > MOST_NODES) throw new AvatarProblem('too-large', `it has ${nodes.length} nodes`);
  const parents = new Map();
  nodes.forEach(({ children = [] }, i) => {
    if (!Array.isArray(children)) throw damaged(`nodes[${i}].children`, 'is no list');
    for (const child of children) {
      if (!nodes[child] || child === i || parents.has(child)) throw damaged(`nodes[${i}].children`, `${child} is not there, or is already within another`);
      parents.set(child, i);
    }
  });
  const deep = new Map();
  for (let i = 0; i < nodes.length; i++) {
    const way = [];
    let at = i;
    for (; at !== undefined && !deep.has(at); at = parents.get(at)) {
      if (way.length > nodes.length) throw damaged(`nodes[${i}]`, 'it is among its own children');
      way.push(at);
    }
    let depth = at === undefined ? 0 : deep.get(at);
    for (const node of way.reverse()) deep.set(node, ++depth);
    if (depth > MOST_DEEP) throw damaged(`nodes[${i}]`, `is within ${depth - 1} others`);
  }
}
