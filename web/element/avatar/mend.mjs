// SPDX-License-Identifier: MIT
// Repairs output of real exporters that glTF 2.0 forbids but whose meaning is clear: -1 or null for "none", no scene, lists
// of unequal length.

import { oldMeshopt, plainLook } from './extensions.mjs';

const isObject = (value) => value !== null && typeof value === 'object' && !Array.isArray(value);
const none = (value) => value === null || value === -1;

/** Numbers of other things that may be missing, by the list whose members have them. */
const MAY_LACK = {
  accessors: ['bufferView', 'sparse'],
  images: ['bufferView', 'uri'],
  meshes: ['weights'],
  nodes: ['mesh', 'skin', 'camera', 'children', 'weights', 'translation', 'rotation', 'scale', 'matrix'],
  skins: ['skeleton', 'inverseBindMatrices'],
  textures: ['sampler', 'source'],
  scenes: ['nodes'],
};
const NEEDED = /^(POSITION|JOINTS_\d+|WEIGHTS_\d+)$/; // without these a primitive is another
const USED = /^(POSITION|NORMAL|TANGENT|TEXCOORD_\d+|COLOR_0|JOINTS_0|WEIGHTS_0)$/;
const DRACO = 'KHR_draco_mesh_compression';

/** Without members that say "none" another way. */
const without = (one, names) =>
  Object.fromEntries(Object.entries(one).filter(([name, value]) => !(names.includes(name) && none(value))));

/** Returns one number per target; replaces NaN and missing values with 0. */
function weightsOf(one, count) {
  if (one.weights === undefined) return one;
  const { weights, ...rest } = one;
  if (!Array.isArray(weights) || !count) return rest;
  return { ...rest, weights: Array.from({ length: count }, (_, i) => (Number.isFinite(weights[i]) ? weights[i] : 0)) };
}

/**
 * @param {object} json of a GLB, possibly invalid @returns {object} a repaired copy for checkReferences
 */
export function mended(json) {
  const out = oldMeshopt(json);
  const each = (name, change) => {
    if (Array.isArray(out[name])) out[name] = out[name].map((one) => (isObject(one) ? change(one) : one));
  };
  for (const [name, members] of Object.entries(MAY_LACK)) each(name, (one) => without(one, members));
  for (const name of ['nodes', 'meshes', 'materials'])
    each(name, (one) => (one.name === undefined || typeof one.name === 'string' ? one : { ...one, name: String(one.name) }));
  each('materials', plainLook);
  if (!isObject(out.extensions)) delete out.extensions;
  if (!Array.isArray(out.extensionsUsed)) delete out.extensionsUsed;
  if (Array.isArray(out.meshes)) {
    out.accessors = [...(Array.isArray(out.accessors) ? out.accessors : [])];
    each('meshes', (mesh) => {
      if (!Array.isArray(mesh.primitives)) return mesh;
      return weightsOf({ ...mesh, primitives: mesh.primitives.map((one) => primitiveOf(one, out.accessors)) }, targetsIn(mesh));
    });
  }
  if (Array.isArray(out.nodes)) {
    each('nodes', (node) => weightsOf(node, targetsIn(out.meshes?.[node.mesh])));
    withScene(out);
  }
  return out;
}

const targetsIn = (mesh) => (Array.isArray(mesh?.primitives?.[0]?.targets) ? mesh.primitives[0].targets.length : 0);

/** Only what is drawn; what points nowhere and can be missing is missing. */
function primitiveOf(primitive, accessors) {
  if (!isObject(primitive)) return primitive;
  const out = without(primitive, ['indices', 'material', 'targets']);
  if (!isObject(out.attributes)) return out;
  const there = (i) => isObject(accessors[i]);
  const { count } = accessors[out.attributes.POSITION] ?? {};
  const fits = ([name, i]) => USED.test(name) && (NEEDED.test(name) || (there(i) && accessors[i].count === count));
  const packed = Boolean(out.extensions?.[DRACO]);
  out.attributes = Object.fromEntries(Object.entries(out.attributes).filter(fits));
  if (!Array.isArray(out.targets) || packed) return out;
  // GLTFLoader takes the mesh itself for what one target lacks and another has
  const normals = out.targets.every((target) => there(target?.NORMAL));
  const some = out.targets.some((target) => isObject(target) && !none(target.POSITION) && target.POSITION !== undefined);
  let still;
  out.targets = out.targets.map((target) => {
    if (target !== null && !isObject(target)) return target;
    const own = {};
    const { POSITION, NORMAL } = target ?? {};
    if (POSITION !== undefined && !none(POSITION)) own.POSITION = POSITION;
    else if (some) own.POSITION = still ??= accessors.push({ componentType: 5126, type: 'VEC3', count }) - 1;
    if (normals) own.NORMAL = NORMAL;
    return own;
  });
  return out;
}

/** Adds a scene of all root nodes to a file with no scene, or an empty one. */
function withScene(json) {
  if (none(json.scene)) delete json.scene;
  const scenes = Array.isArray(json.scenes) ? json.scenes : [];
  const shown = scenes[json.scene ?? 0];
  if (shown !== undefined ? !isObject(shown) || (shown.nodes ?? []).length : json.scene !== undefined && scenes.length) return;
  const inner = new Set(json.nodes.flatMap((node) => (Array.isArray(node?.children) ? node.children : [])));
  const nodes = json.nodes.flatMap((_, i) => (inner.has(i) ? [] : [i]));
  json.scenes = [{ ...(isObject(shown) ? shown : {}), nodes }];
  json.scene = 0;
}
