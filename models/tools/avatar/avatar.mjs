// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Exports a head as an avatar for other programs: a GLB with ARKit's 52 shapes, the 15 visemes and a breath as morph targets, bones, and the
 * expressions of VRM 1.0. A target is the difference between the head at the FAPs of its definition and the head at rest.
 */
import { breathDeltas } from '../../../web/element/head/model/breath-deltas.mjs';
import { decode } from '../lib/codec.mjs';
import { pose } from '../lib/deform.mjs';
import { openTexture } from '../lib/image.mjs';
import { Glb } from './glb.mjs';
import { ARKIT, VISEMES } from './shapes.mjs';
import { EYE_HEIGHT, JOINTS, bonesOf, humanBones, skinOf, turnOf } from './skeleton.mjs';
import { vrm } from './vrm.mjs';

/** Ignores shorter displacements: m, and components of a normal. */
const LEAST_SHIFT = 2e-6,
  LEAST_TURN = 4e-3;

const ROOT = 'Armature'; // what programs for talking heads look for
export const STAND = 'stand';

export const TARGETS = { ...ARKIT, ...VISEMES };
export const BREATH = 'breath'; // a full one; the element's avatars look for the name, too

/** @param {object} head unpacked @returns {Promise<Buffer>} the GLB */
export async function makeAvatar(head) {
  const glb = new Glb();
  const { json } = glb;
  json.asset = { version: '2.0', generator: 'faccia', copyright: `${head.licence}. ${head.credits.join('; ')}` };
  json.extensionsUsed = ['VRMC_vrm'];
  json.extras = { name: head.name, title: head.title, about: head.about, licence: head.licence, credits: head.credits, fdp: head.fdp, origin: [0, EYE_HEIGHT, 0] };
  const bones = addBones(glb, head);
  await addMaterials(glb, head);
  addSkin(glb, bones);
  json.meshes = [];
  const meshes = head.parts.map((part) => addPart(glb, head, part));
  addStand(glb, bones);
  json.scene = 0;
  json.nodes.push({ name: ROOT, children: [bones.nodes.Hips, ...meshes.map(({ node }) => node)] });
  json.scenes = [{ name: head.title, nodes: [json.nodes.length - 1] }];
  const top = bones.list.find(({ name }) => name === 'Head').at;
  json.extensions = { VRMC_vrm: vrm(head, humanBones(bones.nodes), meshes, [0, EYE_HEIGHT - top[1], -top[2]].map((x) => Math.round(x * 1e6) / 1e6)) };
  return glb.finish();
}

function addBones({ json }, head) {
  const list = bonesOf(head);
  const nodes = Object.fromEntries(list.map(({ name }, i) => [name, i]));
  json.nodes = list.map(({ name, parent, at }) => {
    const from = parent ? list[nodes[parent]].at : [0, 0, 0];
    const [turn, before] = [turnOf(name), turnOf(parent)];
    const back = [-before[0], -before[1], -before[2], before[3]];
    const shift = turnedBy(back, at.map((x, k) => x - from[k])).map((x) => Math.round(x * 1e6) / 1e6);
    const rotation = product(back, turn);
    const children = list.flatMap((bone, i) => (bone.parent === name ? [i] : []));
    return { name, translation: shift, ...(Math.abs(rotation[3]) > 1 - 1e-9 ? {} : { rotation }), ...(children.length ? { children } : {}) };
  });
  // added up after rounding
  for (const bone of list) {
    const { translation } = json.nodes[nodes[bone.name]];
    bone.at = turnedBy(turnOf(bone.parent), translation).map((x, k) => x + (bone.parent ? list[nodes[bone.parent]].at[k] : 0));
  }
  return { list, nodes };
}

/** The product of two quaternions. */
const product = ([a, b, c, d], [e, f, g, h]) => [d * e + a * h + b * g - c * f, d * f - a * g + b * h + c * e, d * g + a * f - b * e + c * h, d * h - a * e - b * f - c * g];

/** A vector turned by a quaternion. */
const turnedBy = (q, v) => product(product(q, [...v, 0]), [-q[0], -q[1], -q[2], q[3]]).slice(0, 3);

function addSkin(glb, bones) {
  const matrices = JOINTS.flatMap((name) => {
    const [x, y, z] = bones.list[bones.nodes[name]].at;
    return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1];
  });
  glb.json.skins = [{ joints: JOINTS.map((name) => bones.nodes[name]), inverseBindMatrices: glb.floats(Float32Array.from(matrices), 'MAT4', 16) }];
}

/** Adds a triangle without area on the floor: programs that stand an avatar on its lowest mesh leave this one, which ends at the chest, at its height. */
function addStand(glb, { list, nodes }) {
  const { json } = glb;
  json.meshes.push({ name: STAND, primitives: [{ attributes: { POSITION: glb.floats(new Float32Array(9), 'VEC3', 3, true) }, indices: glb.indices([0, 1, 2]) }] });
  json.nodes.push({ name: STAND, mesh: json.meshes.length - 1, translation: list[nodes.Hips].at.map((x) => -x) });
  json.nodes[nodes.Hips].children.push(json.nodes.length - 1);
}

/**
 * Hair on cards, in renderers that light a surface as one: their highlight lies on whole cards, and where light comes from all around they turn grey towards their
 * edges. So it is dull.
 */
const STRANDS = { roughness: 0.8, specular: 0.3 };
const SPECULAR = 'KHR_materials_specular';

const ALPHA = { opaque: 'OPAQUE', cutout: 'MASK', blend: 'BLEND' };

async function addMaterials(glb, head) {
  const { json } = glb;
  Object.assign(json, { materials: [], textures: [], images: [], samplers: [{ magFilter: 9729, minFilter: 9987 }] });
  for (const [name, look] of Object.entries(head.materials)) {
    const texture = look.texture === undefined ? {} : { baseColorTexture: { index: await addTexture(glb, head.textures[look.texture], look) } };
    const strands = look.alpha === 'cutout';
    if (strands && !json.extensionsUsed.includes(SPECULAR)) json.extensionsUsed.push(SPECULAR);
    json.materials.push({
      name,
      pbrMetallicRoughness: { baseColorFactor: [...look.color, 1], metallicFactor: 0, roughnessFactor: strands ? Math.max(STRANDS.roughness, look.roughness) : look.roughness, ...texture },
      ...(strands ? { extensions: { [SPECULAR]: { specularFactor: STRANDS.specular } } } : {}),
      alphaMode: ALPHA[look.alpha],
      doubleSided: look.double_sided,
    });
  }
}

/** Converts to formats that every glTF reader supports: JPEG, or PNG with transparency. */
async function addTexture(glb, { data }, { texture: name, alpha }) {
  const { json } = glb;
  const known = json.images.findIndex((image) => image.name === name);
  if (known >= 0) return known;
  const image = openTexture(data);
  const opaque = alpha === 'opaque';
  const bytes = await (opaque ? image.flatten().jpeg({ quality: 90 }) : image.png({ compressionLevel: 9 })).toBuffer();
  json.images.push({ name, mimeType: opaque ? 'image/jpeg' : 'image/png', bufferView: glb.view(bytes) });
  json.textures.push({ sampler: 0, source: json.images.length - 1 });
  return json.textures.length - 1;
}

const metres = (mm, lift) => Float32Array.from(mm, (x, i) => x / 1000 + (i % 3 === 1 ? lift : 0));

function addPart(glb, head, part) {
  const { json } = glb;
  const rest = pose(head, part, {});
  const normals = normalsOf(part, rest);
  const { joints, weights } = skinOf(head, part);
  const uv = Float32Array.from(part.uv, (x, i) => (i % 2 ? 1 - x : x));
  const moved = movedBy(head, part);
  // the skin has all targets, so that programs find them; other parts have only targets that move them
  const names = Object.keys(TARGETS).filter((name) => part.name === 'skin' || moved(TARGETS[name]));
  const breathed = breathe(head, part, rest);
  const targets = breathed ? [...names, BREATH] : names;
  const posed = (name) => (name === BREATH ? breathed : pose(head, part, TARGETS[name]));
  const primitive = {
    attributes: {
      POSITION: glb.floats(metres(rest, EYE_HEIGHT), 'VEC3', 3, true),
      NORMAL: glb.floats(Float32Array.from(normals), 'VEC3', 3),
      TEXCOORD_0: glb.floats(uv, 'VEC2', 2),
      JOINTS_0: glb.bytes4(joints, false),
      WEIGHTS_0: glb.bytes4(weights, true),
    },
    indices: glb.indices(part.index),
    material: json.materials.findIndex(({ name }) => name === part.material),
    ...(targets.length ? { targets: targets.map((name) => addTarget(glb, part, posed(name), rest, normals)) } : {}),
  };
  json.meshes.push({
    name: part.name,
    primitives: [primitive],
    ...(targets.length ? { weights: targets.map(() => 0), extras: { targetNames: targets } } : {}),
  });
  json.nodes.push({ name: part.name, mesh: json.meshes.length - 1, skin: 0 });
  return { node: json.nodes.length - 1, targets, moving: new Set(names.filter((name) => moved(TARGETS[name]))) };
}

/** Returns whether any of the FAPs moves the part. */
function movedBy(head, part) {
  const faps = new Set([...part.moves.map(({ fap }) => fap), ...part.turns.map(({ turn }) => head.turns.find(({ name }) => name === turn).fap)]);
  return (target) => Object.keys(target).some((fap) => faps.has(Number(fap)));
}

/** @returns {Float64Array|null} the positions with full lungs (protocol/head-model.md); null: as at rest */
function breathe(head, { breath }, rest) {
  if (!breath || !head.breath) return null;
  const deltas = breathDeltas(decode('uint8', breath.weights), head.breath.shift);
  const out = Float64Array.from(rest);
  decode('uint16', breath.vertices).forEach((v, i) => {
    for (let k = 0; k < 3; k++) out[3 * v + k] += deltas[3 * i + k];
  });
  return out;
}

function addTarget(glb, part, posed, rest, normals) {
  const turned = normalsOf(part, posed);
  return {
    POSITION: glb.sparse(posed.map((x, i) => (x - rest[i]) / 1000), LEAST_SHIFT, true),
    NORMAL: glb.sparse(turned.map((x, i) => x - normals[i]), LEAST_TURN, false),
  };
}

/** Computes normals weighted by area, shared across seams. @returns {Float64Array} */
export function normalsOf({ index, smooth }, position) {
  const sums = new Float64Array(position.length);
  const place = (v) => (smooth ? smooth[v] : v);
  for (let t = 0; t < index.length; t += 3) {
    const corners = [index[t], index[t + 1], index[t + 2]];
    const [a, b, c] = corners.map((v) => position.subarray(3 * v, 3 * v + 3));
    const u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]],
      w = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
    const n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
    for (const v of corners) for (let k = 0; k < 3; k++) sums[3 * place(v) + k] += n[k];
  }
  const out = new Float64Array(position.length);
  for (let v = 0; v < position.length / 3; v++) {
    const sum = sums.subarray(3 * place(v), 3 * place(v) + 3);
    const length = Math.hypot(...sum);
    for (let k = 0; k < 3; k++) out[3 * v + k] = length ? sum[k] / length : k === 2 ? 1 : 0;
  }
  return out;
}
