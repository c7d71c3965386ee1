// SPDX-License-Identifier: MIT
// Extensions of glTF 2.0 that a face can do without, even if the file requires them (`extensionsRequired`): lights, sounds,
// animation rules, finer materials. Only extensions that affect the shape must be supported.

const isObject = (value) => value !== null && typeof value === 'object' && !Array.isArray(value);
const PLACES = ['buffers', 'bufferViews', 'accessors', 'meshes'];
const MULTIPLIES = 'EXT_mesh_gpu_instancing'; // the only one that multiplies a node
export const MESHOPT = 'EXT_meshopt_compression';
const NEW_MESHOPT = 'KHR_meshopt_compression'; // the same members; its streams may be of version 1, its filter COLOR, which the decoder knows
const OLD_LOOK = 'KHR_materials_pbrSpecularGlossiness'; // of exporters before 2020
/** Stand at primitives, and change neither places nor corners. */
const MARKS = /^\w+_materials_|^CESIUM_|^EXT_(mesh_features|structural_metadata)$/;

/**
 * @param {object} json of a glTF @param {string} name of an extension
 * @returns {string|null} where a shape is made by it, as in "meshes[0].primitives[1]"; null: nowhere
 */
export function shapedBy(json, name) {
  const has = (one) => isObject(one) && isObject(one.extensions) && one.extensions[name] !== undefined;
  const list = (value) => (Array.isArray(value) ? value : []);
  const find = (all, place) => {
    const i = list(all).findIndex(has);
    return i < 0 ? null : `${place}[${i}]`;
  };
  for (const place of PLACES) {
    const found = find(json[place], place);
    if (found) return found;
  }
  if (name === MULTIPLIES) return find(json.nodes, 'nodes');
  if (MARKS.test(name)) return null;
  for (const [i, mesh] of list(json.meshes).entries()) {
    const found = find(mesh?.primitives, `meshes[${i}].primitives`);
    if (found) return found;
  }
  return null;
}

/**
 * A glTF that names meshopt's compression only as GLTFLoader does.
 * @param {object} json of a glTF, possibly invalid
 */
export function oldMeshopt(json) {
  const renamed = (one) => {
    if (!isObject(one) || !isObject(one.extensions) || one.extensions[NEW_MESHOPT] === undefined) return one;
    const { [NEW_MESHOPT]: packed, ...extensions } = one.extensions;
    return { ...one, extensions: { ...extensions, [MESHOPT]: packed } };
  };
  const out = { ...json };
  for (const name of ['buffers', 'bufferViews']) if (Array.isArray(out[name])) out[name] = out[name].map(renamed);
  for (const name of ['extensionsUsed', 'extensionsRequired'])
    if (Array.isArray(out[name])) out[name] = out[name].map((one) => (one === NEW_MESHOPT ? MESHOPT : one));
  return out;
}

/** A material whose colour and picture stand in the extension of old exporters alone, as glTF 2.0 itself says it. */
export function plainLook(material) {
  const old = isObject(material) && isObject(material.extensions) ? material.extensions[OLD_LOOK] : null;
  if (!isObject(old) || material.pbrMetallicRoughness?.baseColorTexture) return material;
  const { diffuseFactor, diffuseTexture, glossinessFactor } = old;
  const look = {
    metallicFactor: 0,
    ...(Array.isArray(diffuseFactor) ? { baseColorFactor: diffuseFactor } : {}),
    ...(isObject(diffuseTexture) ? { baseColorTexture: diffuseTexture } : {}),
    ...(Number.isFinite(glossinessFactor) ? { roughnessFactor: Math.min(1, Math.max(0, 1 - glossinessFactor)) } : {}),
  };
  const { [OLD_LOOK]: _, ...extensions } = material.extensions;
  return { ...material, pbrMetallicRoughness: look, extensions };
}
