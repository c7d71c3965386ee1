// SPDX-License-Identifier: GPL-3.0-or-later
// One avatar of strange-avatars.mjs for each style of other programs.
import { partsOf } from './foreign-avatars.mjs';
import { bodyMesh, joined, newMeshopt, strange } from './strange-avatars.mjs';

const only = (names, rename = (name) => name) => (name) => (names.includes(name) ? rename(name) : null);
const isArkit = (name) => !name.startsWith('viseme_');
const arkit = (rename) => (name) => (isArkit(name) ? rename(name) : null);
const sided = (name, left, right) => name.replace(/Left$/, left).replace(/Right$/, right);
const capital = (name) => name[0].toUpperCase() + name.slice(1);
const snake = (name) => name.replace(/[A-Z]/g, (letter) => `_${letter.toLowerCase()}`);

const MOUTH_AND_LIDS = [
  'jawOpen', 'mouthClose', 'eyeBlinkLeft', 'eyeBlinkRight', 'mouthFunnel', 'mouthPucker', 'mouthLowerDownLeft', 'mouthLowerDownRight',
  'mouthUpperUpLeft', 'mouthUpperUpRight', 'mouthSmileLeft', 'mouthSmileRight', 'mouthPressLeft', 'mouthPressRight',
];

const VOWELS = { viseme_aa: 'A', viseme_I: 'I', viseme_U: 'U', viseme_E: 'E', viseme_O: 'O' };
const VROID = { ...Object.fromEntries(Object.entries(VOWELS).map(([own, vowel]) => [own, `Fcl_MTH_${vowel}`])), eyeBlinkLeft: 'Fcl_EYE_Close_L', eyeBlinkRight: 'Fcl_EYE_Close_R' };
const KANA = { viseme_aa: 'あ', viseme_I: 'い', viseme_U: 'う', viseme_E: 'え', viseme_O: 'お' };

const without = (list, ...names) => list.filter(({ name }) => !names.includes(name));
const mesh = (whole, name) => whole.meshes.find((one) => one.name === name);

/** Colours as written by exporters before 2020, and required extensions that do not affect a face. */
export function oldLook(json) {
  json.extensionsRequired = ['KHR_materials_pbrSpecularGlossiness', 'KHR_lights_punctual', 'KHR_animation_pointer', 'KHR_node_visibility', 'KHR_xmp_json_ld'];
  json.extensionsUsed = json.extensionsRequired;
  json.nodes[0].extensions = { ...json.nodes[0].extensions, KHR_node_visibility: { visible: true } };
  json.materials = (json.materials ?? []).map(({ pbrMetallicRoughness: { baseColorTexture, baseColorFactor = [1, 1, 1, 1] } = {}, ...rest }) =>
    ({ ...rest, extensions: { KHR_materials_pbrSpecularGlossiness: { diffuseFactor: baseColorFactor, glossinessFactor: 0.3, ...(baseColorTexture ? { diffuseTexture: baseColorTexture } : {}) } } }));
}

/** Both lids in one target. */
function bothLids(whole) {
  return whole.meshes.map((one) => {
    const { eyeBlinkLeft: left, eyeBlinkRight: right, ...others } = one.targets;
    return { ...one, targets: left || right ? { ...others, eyeBlink: (left ?? right).map((x, i) => x + (left && right ? right[i] : 0)) } : others };
  });
}

const HEAD = [0, 1.5216, -0.071];
const JAW = [0, 1.524, -0.048];
const skeleton = (jaw) => [
  ['Hips', [0, 0.92, -0.06], null],
  ['Spine', [0, 1.2, -0.06], 'Hips', ({ name }) => Number(name === 'Body')],
  ['Neck', [0, 1.4366, -0.071], 'Spine'],
  ['Head', HEAD, 'Neck', (one, v) => (one.name === 'Body' ? 0 : 1 - (jaw?.(one, v) ?? 0))],
  ...(jaw ? [['Jaw', JAW, 'Head', jaw]] : []),
  ['LeftEye', [0.028, 1.55, 0], 'Head'],
  ['RightEye', [-0.028, 1.55, 0], 'Head'],
];

/** Weight of the jaw bone, by how far jawOpen moves the vertex. */
function byJaw({ targets: { jawOpen }, position }, v) {
  if (!jawOpen) return 0;
  const far = Math.hypot(position[3 * v + 1] - JAW[1], position[3 * v + 2] - JAW[2]) * 0.38;
  const share = Math.min(1, Math.hypot(...jawOpen.subarray(3 * v, 3 * v + 3)) / far);
  return share > 0.01 ? share : 0;
}

const HALF = Math.SQRT1_2;
const FLIP = { matrix: [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] };

/** Swaps left and right in names, for a mirrored avatar. */
const swapped = (name) => sided(name, 'XX', 'Left').replace(/XX$/, 'Right');

/**
 * @param {ReturnType<import('./strange-avatars.mjs').takenApart>} whole
 * @returns {Record<string, {bytes: () => Buffer, lids?: boolean, wink?: boolean}>} lids: it can close its lids; wink: it can close one lid
 */
export const strangeCases = (whole) => ({
  prefixed: { bytes: () => strange(whole, { rename: arkit((name) => `Head_blendShape.${name}`) }) },
  underscored: { bytes: () => strange(whole, { rename: arkit((name) => `ARKit_${sided(name, '_L', '_R')}`) }) },
  capital: { bytes: () => strange(whole, { rename: arkit((name) => capital(name)) }) },
  snake: { bytes: () => strange(whole, { rename: arkit(snake) }) },
  numbered: { bytes: () => strange(whole, { rename: arkit((name) => `AK_${10 + name.length}_${capital(name)}`) }) },
  'side first': { bytes: () => strange(whole, { rename: arkit((name) => name.replace(/^(.*)(Left|Right)$/, (all, stem, side) => (/^(jaw|mouth)$/.test(stem) ? all : `${side[0]}_${stem}`))) }) },
  suffixed: { bytes: () => strange(whole, { rename: arkit((name) => `${name}_Mesh`) }) },
  'prefixed visemes': { bytes: () => strange(whole, { rename: (name) => (isArkit(name) ? (/^eyeBlink/.test(name) ? sided(name, '_L', '_R') : null) : `AA_VI_${10 + name.length}_${name.slice(7)}`) }) },
  visemes: { bytes: () => strange(whole, { rename: (name) => (isArkit(name) ? null : name) }), lids: false },
  vroid: { bytes: () => strange(whole, { rename: only(Object.keys(VROID), (name) => `Face.M_F00_000_00_${VROID[name]}`) }) },
  'bare vowels': { bytes: () => strange(whole, { rename: only(Object.keys(VOWELS), (name) => VOWELS[name]) }), lids: false },
  kana: { bytes: () => strange(whole, { meshes: bothLids(whole), rename: (name) => KANA[name] ?? (name === 'eyeBlink' ? 'まばたき' : null) }), wink: false },
  'jaw bone, smiles': { bytes: () => strange(whole, { rename: only(['mouthSmileLeft', 'mouthSmileRight', 'eyeBlinkLeft', 'eyeBlinkRight']), bones: skeleton(byJaw) }) },
  'jaw bone': { bytes: () => strange(whole, { rename: () => null, bones: skeleton(byJaw) }), lids: false },
  'whole body': { bytes: () => strange(whole, { meshes: [...whole.meshes, bodyMesh(mesh(whole, 'clothes').material)], rename: arkit((name) => name), bones: skeleton() }) },
  'body in one mesh': { bytes: () => strange(whole, { meshes: [joined([mesh(whole, 'skin'), ...without(whole.meshes, 'skin'), bodyMesh(mesh(whole, 'skin').material)], 'skin')], rename: arkit((name) => name) }) },
  'body without bones': { bytes: () => strange(whole, { meshes: [bodyMesh(mesh(whole, 'clothes').material), ...whole.meshes], rename: (name) => (isArkit(name) ? null : name) }), lids: false },
  centimetres: { bytes: () => strange(whole, { turn: ([x, y, z]) => [100 * x, -100 * z, 100 * y], bones: skeleton(), above: [{ name: 'Armature', rotation: [-HALF, 0, 0, HALF], scale: [0.01, 0.01, 0.01] }], rename: arkit((name) => name) }) },
  'z up, untold': { bytes: () => strange(whole, { turn: ([x, y, z]) => [x, -z, y], rename: arkit((name) => name) }) },
  mirrored: { bytes: () => strange(whole, { turn: ([x, y, z]) => [-x, y, z], above: [FLIP], rename: arkit((name) => name) }) },
  'looks back': { bytes: () => strange(whole, { above: [{ rotation: [0, 1, 0, 0] }], rename: arkit((name) => name) }) },
  'looks back, with eyes': { bytes: () => strange(whole, { bones: skeleton(), above: [{ rotation: [0, 1, 0, 0] }], rename: arkit((name) => name) }) },
  'looks aside': { bytes: () => strange(whole, { turn: ([x, y, z]) => [z, y, -x], rename: arkit((name) => name) }) },
  'looks half aside': { bytes: () => strange(whole, { above: [{ rotation: [0, Math.sin(0.25), 0, Math.cos(0.25)] }], rename: arkit((name) => name) }) },
  'half aside, with eyes': { bytes: () => strange(whole, { bones: skeleton(), above: [{ rotation: [0, Math.sin(-0.4), 0, Math.cos(-0.4)] }], rename: arkit((name) => name) }) },
  giant: { bytes: () => strange(whole, { turn: (p) => p.map((x) => 5000 * x), rename: arkit((name) => name) }) },
  dwarf: { bytes: () => strange(whole, { turn: (p) => p.map((x) => x / 5000), rename: arkit((name) => name) }) },
  sparse: { bytes: () => strange(whole, { store: 'sparse', rename: arkit((name) => name) }) },
  quantised: { bytes: () => strange(whole, { store: 'short', rename: arkit((name) => name), add: (json) => (json.extensionsUsed = json.extensionsRequired = ['KHR_mesh_quantization']) }) },
  'extensions that shape nothing': { bytes: () => strange(whole, { rename: arkit((name) => name), add: oldLook }) },
  meshopt: { bytes: () => strange(whole, { store: 'packed', rename: only(MOUTH_AND_LIDS) }) },
  'meshopt as Khronos names it': { bytes: () => newMeshopt(partsOf(strange(whole, { store: 'packed', rename: only(MOUTH_AND_LIDS) }))) },
  'no normals': { bytes: () => strange(whole, { normals: false, rename: arkit((name) => name) }) },
  'NaN in a target': { bytes: () => strange({ ...whole, meshes: whole.meshes.map((one) => ({ ...one, targets: Object.fromEntries(Object.entries(one.targets).map(([name, list]) => [name, /^(mouthSmile|browInner)/.test(name) ? list.map((x, i) => (i % 997 ? x : NaN)) : list])) })) }, { rename: arkit((name) => name) }) },
  'NaN places': { bytes: () => strange({ ...whole, meshes: whole.meshes.map((one) => (one.name === 'hair' ? { ...one, position: one.position.map((x, i) => (i % 997 ? x : NaN)) } : one)) }, { rename: arkit((name) => name) }) },
  'targets of nothing': { bytes: () => strange({ ...whole, meshes: whole.meshes.map((one) => ({ ...one, targets: Object.fromEntries(Object.entries(one.targets).map(([name, list]) => [name, /^(mouth(Left|Right)|cheek|nose)/.test(name) ? list.map(() => 0) : list])) })) }, { rename: arkit((name) => name) }) },
  'few shapes': { bytes: () => strange(whole, { rename: only(['jawOpen', 'eyeBlinkLeft', 'eyeBlinkRight']) }) },
  'mouth open and smile': { bytes: () => strange(whole, { rename: (name) => ({ jawOpen: 'mouthOpen', eyeBlinkLeft: 'Blink_Left', eyeBlinkRight: 'Blink_Right' })[name] ?? null }) },
  'mesh in pieces': { bytes: () => strange(whole, { rename: arkit((name) => name), add: (json) => {
    const skin = json.meshes.find(({ name }) => name === 'skin');
    const [primitive] = skin.primitives;
    const one = json.accessors[primitive.indices];
    const first = 3 * Math.floor(one.count / 6);
    const rest = json.accessors.push({ ...one, byteOffset: 4 * first, count: one.count - first }) - 1;
    one.count = first;
    skin.primitives.push({ ...primitive, indices: rest });
  } }) },
  'teeth that stay': { bytes: () => strange({ ...whole, meshes: whole.meshes.map((one) => (/teeth|tongue|mouth/.test(one.name) ? { ...one, targets: {} } : one)) }, { rename: arkit((name) => name) }) },
  'mirrored names': { bytes: () => strange(whole, { rename: arkit(swapped) }) },
});
