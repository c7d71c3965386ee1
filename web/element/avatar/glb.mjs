// SPDX-License-Identifier: MIT
import { shapedBy } from './extensions.mjs';
import { mended } from './mend.mjs';
import { AvatarProblem } from './problem.mjs';
import { checkReferences } from './references.mjs';

const MAGIC = 0x46546c67; // glTF
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;

/** Supported extensions. An avatar that requires others for its shapes is refused. */
const READ = [
  'EXT_meshopt_compression', 'KHR_draco_mesh_compression', 'KHR_texture_basisu', 'EXT_texture_webp', 'EXT_texture_avif', 'KHR_mesh_quantization', 'KHR_texture_transform', 'KHR_materials_unlit',
  'KHR_materials_specular', 'KHR_materials_ior', 'KHR_materials_clearcoat', 'KHR_materials_sheen', 'KHR_materials_transmission',
  'KHR_materials_volume', 'KHR_materials_emissive_strength', 'KHR_materials_iridescence', 'KHR_materials_anisotropy', 'VRM', 'VRMC_vrm',
  'VRMC_materials_mtoon', 'VRMC_springBone', 'VRMC_node_constraint', 'VRMC_materials_hdr_emissiveMultiplier',
];

const PACKED = ['KHR_texture_basisu', 'EXT_texture_webp', 'EXT_texture_avif'];

const damaged = (what) => new AvatarProblem('damaged', what);

/**
 * The parts of a GLB (glTF 2.0, 4.4).
 * @param {Uint8Array} bytes @returns {{json: object, binary: Uint8Array|null}}
 */
export function splitGlb(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || view.getUint32(0, true) !== MAGIC) throw new AvatarProblem('not-glb', 'it is no GLB: a .gltf has to be packed into one');
  if (view.getUint32(4, true) !== 2) throw new AvatarProblem('not-glb', `it is a GLB of version ${view.getUint32(4, true)}, not 2`);
  const end = view.getUint32(8, true);
  if (end > bytes.length) throw damaged(`it ends at byte ${bytes.length} of ${end}`);
  const chunks = new Map();
  for (let at = 12; at + 8 <= end; ) {
    const [length, type] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
    if (at + 8 + length > end) throw damaged(`byte ${at}: a chunk goes beyond the end`);
    if (!chunks.has(type)) chunks.set(type, bytes.subarray(at + 8, at + 8 + length));
    at += 8 + length;
  }
  let json;
  try {
    json = JSON.parse(new TextDecoder().decode(chunks.get(JSON_CHUNK)));
  } catch (error) {
    throw damaged(`its JSON cannot be read: ${error.message}`);
  }
  if (!json || typeof json !== 'object') throw damaged('its JSON is no object');
  return { json, binary: chunks.get(BINARY_CHUNK) ?? null };
}

/** @returns {ArrayBuffer} a GLB of those parts */
export function joinGlb({ json, binary }) {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const round = (length) => (length + 3) & ~3;
  const [first, second] = [round(text.length), binary ? round(binary.length) : 0];
  const bytes = new Uint8Array(20 + first + (binary ? 8 + second : 0)).fill(32, 20, 20 + first);
  const view = new DataView(bytes.buffer);
  [MAGIC, 2, bytes.length, first, JSON_CHUNK].forEach((value, i) => view.setUint32(4 * i, value, true));
  bytes.set(text, 20);
  if (!binary) return bytes.buffer;
  view.setUint32(20 + first, second, true);
  view.setUint32(24 + first, BINARY_CHUNK, true);
  bytes.set(binary, 28 + first);
  return bytes.buffer;
}

/** Names of targets where GLTFLoader looks for them; some write them beside each primitive, or at the targets' own numbers. */
function named(mesh, accessors) {
  const [first] = mesh.primitives;
  const count = first.targets?.length ?? 0;
  const lists = [mesh.extras?.targetNames, first.extras?.targetNames];
  const told = lists.find(Array.isArray) ?? first.targets?.map(({ POSITION }) => accessors[POSITION]?.name);
  if (!count || !told?.some((name) => typeof name === 'string')) return mesh;
  const names = Array.from({ length: count }, (_, i) => (typeof told[i] === 'string' && told[i] ? told[i] : String(i)));
  const extras = { ...mesh.extras, targetNames: names.map((name, i) => (names.indexOf(name) === i ? name : String(i))) };
  return { ...mesh, extras };
}

/**
 * Refuses what would cost a reader too much, or reach out of the file; takes out what a face has no use for.
 * @param {{json: object, binary: Uint8Array|null}} glb @returns {object} its JSON
 */
export function checkGlb({ json: told, binary }) {
  const json = mended(told);
  const names = (value) => (Array.isArray(value) ? value : []);
  const unread = names(json.extensionsRequired).filter((name) => !READ.includes(name) && shapedBy(json, name));
  if (unread.length) throw new AvatarProblem('unsupported', `it needs ${unread.join(', ')}, which is not read here`);
  checkReferences(json);
  for (const [i, { uri, byteLength, extensions }] of (json.buffers ?? []).entries()) {
    if (uri !== undefined) throw new AvatarProblem('unsupported', `buffers[${i}]: it has to be in the file itself`);
    if (i === 0 && !extensions && !(byteLength <= (binary?.length ?? 0))) throw damaged(`buffers[0]: there are no ${byteLength} bytes`);
  }
  for (const [i, { uri }] of (json.images ?? []).entries())
    if (uri !== undefined) throw new AvatarProblem('unsupported', `images[${i}]: it has to be in the file itself`);
  const bare = (node) => ({ ...node, camera: undefined, extensions: { ...node.extensions, KHR_lights_punctual: undefined } });
  // a picture is our own reader's matter, however it is packed: GLTFLoader's would take those for themselves
  const flat = (texture) => {
    const packed = PACKED.map((extension) => texture.extensions?.[extension]?.source).find((one) => one !== undefined);
    return { ...texture, source: packed ?? texture.source, extensions: undefined };
  };
  const left = { animations: undefined, cameras: undefined, extensionsRequired: undefined };
  const meshes = json.meshes?.map((mesh) => named(mesh, json.accessors ?? []));
  return { ...json, ...left, meshes, nodes: json.nodes?.map(bare), textures: (json.textures ?? []).map(flat) };
}
