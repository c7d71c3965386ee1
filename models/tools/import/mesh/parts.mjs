// SPDX-License-Identifier: GPL-3.0-or-later
/** Assigns meshes to the parts of a head, in mm, in a head's axes, with the origin between the eyeballs. */
import { FileError } from '../limits.mjs';

const MOST_VERTICES = 65535;
export const NAMES = ['skin', 'hair', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower', 'tongue', 'mouth', 'lashes', 'brows', 'clothes', 'beard', 'glasses'];

/** Matches names of eyes with the letter of a side (eyeL, eye_l, Eye.L.001), but not other words (eyeball, eye cover). */
const sided = (side) => new RegExp(`([Ee]ye|EYE|[Cc]ornea|[Ii]ris|[Ss]clera).*((?<=[_. -])[${side}${side.toLowerCase()}]|(?<=[a-z])${side})(?![A-Za-z])`);

/** The first match applies. */
const WORDS = [
  [/lash|eyeline/i, 'lashes'], [/brow/i, 'brows'], [/glass|spectacle/i, 'glasses'], [/beard|moustache|mustache/i, 'beard'], [/tongue/i, 'tongue'],
  [/(teeth|tooth|gum).*(up|top)|(up|top).*(teeth|tooth|gum)/i, 'teeth_upper'], [/(teeth|tooth|gum).*(low|bot)|(low|bot).*(teeth|tooth|gum)/i, 'teeth_lower'],
  [/teeth|tooth|denture|gum/i, 'teeth'], [/(eye|cornea|iris|sclera).*left|left.*eye|^l[_. -]?eye/i, 'eye_l'], [sided('L'), 'eye_l'], [/(eye|cornea|iris|sclera).*right|right.*eye|^r[_. -]?eye/i, 'eye_r'], [sided('R'), 'eye_r'],
  [/eye|cornea|sclera/i, 'eyes'], [/mouth|oral|cavity/i, 'mouth'], [/hair|scalp/i, 'hair'], [/cloth|shirt|outfit|jacket|dress|collar|suit|top\b/i, 'clothes'], [/skin|head|face|body/i, 'skin'],
];

/** @param {string} text a name @returns {string|undefined} the part that it suggests */
export const guessPart = (text) => (NAMES.includes(text) ? text : WORDS.find(([pattern]) => pattern.test(text))?.[1]);

/**
 * Part of a mesh by its own name, its node's or its material's. A mesh named "head" may be anything, so its material decides.
 * @returns {string|undefined}
 */
export function partOf(mesh, { materials }) {
  const name = guessPart(mesh.name) ?? guessPart(mesh.also ?? '');
  const material = guessPart(materials[mesh.material]?.name ?? mesh.materialName ?? '');
  return name === 'skin' && mesh.name !== 'skin' && material ? material : (name ?? material);
}

/** @param {Record<string, string>} binding from a file: mesh (or material) -> part */
export function nameParts(scene, binding) {
  for (const [from, to] of Object.entries(binding))
    if (!NAMES.includes(to)) throw new FileError(`parts.${from}`, `there is no part "${String(to).slice(0, 40)}": ${NAMES.join(', ')}`);
  scene.meshes.forEach((mesh, i) => {
    const material = scene.materials[mesh.material]?.name ?? mesh.materialName ?? '';
    const numbered = Object.entries(binding).find(([from]) => Number(/_(\d+)$/.exec(from)?.[1]) === i + 1)?.[1];
    mesh.part = binding[mesh.name] ?? binding[material] ?? numbered ?? partOf(mesh, scene) ?? null;
  });
  if (!scene.meshes.some(({ part }) => part === 'skin')) {
    const free = scene.meshes.filter(({ part }) => !part).sort((a, b) => b.index.length - a.index.length)[0];
    if (!free) throw new FileError('', `no mesh is the skin: of ${scene.meshes.map(({ name, part }) => `${name} (${part})`).join(', ')}; name it in "parts"`);
    free.part = 'skin';
  }
  for (const mesh of scene.meshes) mesh.part ??= 'clothes';
}

/** The centre of the ball whose surface the points lie on (least squares), and its radius. */
export function ballOf(position) {
  const n = position.length / 3;
  const mean = [0, 1, 2].map((k) => position.reduce((sum, x, i) => sum + (i % 3 === k ? x : 0), 0) / n);
  const m = Array.from({ length: 4 }, () => new Float64Array(5));
  for (let v = 0; v < n; v++) {
    const q = [0, 1, 2].map((k) => position[3 * v + k] - mean[k]);
    const row = [...q, 1];
    const right = q[0] ** 2 + q[1] ** 2 + q[2] ** 2;
    for (let i = 0; i < 4; i++) {
      for (let j = 0; j < 4; j++) m[i][j] += row[i] * row[j];
      m[i][4] += row[i] * right;
    }
  }
  for (let i = 0; i < 4; i++) {
    const pivot = m.slice(i).reduce((best, row, k) => (Math.abs(row[i]) > Math.abs(m[best][i]) ? i + k : best), i);
    [m[i], m[pivot]] = [m[pivot], m[i]];
    if (Math.abs(m[i][i]) < 1e-12) return null;
    for (let r = 0; r < 4; r++) {
      if (r === i) continue;
      const factor = m[r][i] / m[i][i];
      for (let k = i; k < 5; k++) m[r][k] -= factor * m[i][k];
    }
  }
  const [a, b, c, d] = m.map((row, i) => row[4] / row[i]);
  return { centre: mean.map((x, k) => x + [a, b, c][k] / 2), radius: Math.sqrt(Math.max(0, d + (a * a + b * b + c * c) / 4)) };
}

/** Merges meshes to one. */
function merge(name, meshes) {
  const total = meshes.reduce((sum, { position }) => sum + position.length / 3, 0);
  if (total > MOST_VERTICES) {
    const which = meshes.map((mesh) => `${mesh.name} ${mesh.position.length / 3}`).slice(0, 5).join(', ');
    throw new FileError(name, `has ${total} vertices (${which}), more than ${MOST_VERTICES}: make the mesh coarser`);
  }
  const out = { name, position: new Float64Array(3 * total), uv: new Float64Array(2 * total), index: [], targets: {}, material: meshes[0].material, pieces: [] };
  let at = 0;
  for (const mesh of meshes) {
    const count = mesh.position.length / 3;
    out.position.set(mesh.position, 3 * at);
    if (mesh.uv) out.uv.set(mesh.uv.map((x) => (x < 0 || x > 1 ? x - Math.floor(x) : x)), 2 * at);
    for (const v of mesh.index) out.index.push(at + v);
    for (const [target, deltas] of Object.entries(mesh.targets)) (out.targets[target] ??= new Float64Array(3 * total)).set(deltas, 3 * at);
    out.pieces.push({ mesh, at, count });
    at += count;
  }
  return { ...out, smooth: welded(out.position) };
}

/** Vertex -> the first vertex at the same place (a hundredth of a mm). */
function welded(position) {
  const first = new Map();
  return Array.from({ length: position.length / 3 }, (_, v) => {
    const key = `${Math.round(position[3 * v] * 100)},${Math.round(position[3 * v + 1] * 100)},${Math.round(position[3 * v + 2] * 100)}`;
    if (!first.has(key)) first.set(key, v);
    return first.get(key);
  });
}

/** The part of a mesh whose triangles are chosen. */
export function piece(mesh, wanted) {
  const kept = new Map();
  const index = [];
  for (let t = 0; t < mesh.index.length; t += 3) {
    const corners = [mesh.index[t], mesh.index[t + 1], mesh.index[t + 2]];
    if (!wanted(corners)) continue;
    for (const v of corners) {
      if (!kept.has(v)) kept.set(v, kept.size);
      index.push(kept.get(v));
    }
  }
  if (!index.length) return null;
  const order = [...kept.keys()];
  const gather = (list, width) => {
    if (!list) return null;
    const out = new Float64Array(width * order.length);
    order.forEach((v, i) => { for (let k = 0; k < width; k++) out[width * i + k] = list[width * v + k]; });
    return out;
  };
  return { ...mesh, position: gather(mesh.position, 3), uv: gather(mesh.uv, 2), colors: gather(mesh.colors, 3), index: Uint32Array.from(index), from: order.map((v) => mesh.from?.[v] ?? v), targets: Object.fromEntries(Object.entries(mesh.targets).map(([name, deltas]) => [name, gather(deltas, 3)])) };
}

/** Splits a mesh with both eyes or both rows of teeth by the side of each triangle. */
function cut(mesh, axis, middle, [above, below]) {
  const side = (want) => piece(mesh, (corners) => corners.reduce((sum, v) => sum + mesh.position[3 * v + axis], 0) / 3 > middle === want);
  return [[true, above], [false, below]].flatMap(([want, part]) => {
    const one = side(want);
    return one ? [{ ...one, part }] : [];
  });
}

/** Material of the largest mesh of a part, preferring meshes with a picture (divide.mjs handles further pictures). */
function materialOf(meshes, { materials }) {
  const pictures = new Set(meshes.map(({ material }) => materials[material]?.picture).filter(Boolean));
  const [{ material }] = meshes.filter((mesh) => !pictures.size || materials[mesh.material]?.picture).sort((a, b) => b.index.length - a.index.length);
  return material;
}

/** @returns {object[]} the parts, merged, in the order of NAMES */
export function gatherParts(scene) {
  const meshes = scene.meshes.flatMap((mesh) => {
    if (mesh.part === 'eyes') return cut(mesh, 0, 0, ['eye_l', 'eye_r']);
    if (mesh.part !== 'teeth') return [mesh];
    const heights = Array.from({ length: mesh.position.length / 3 }, (_, v) => mesh.position[3 * v + 1]);
    return cut(mesh, 1, (Math.min(...heights.slice(0, 60000)) + Math.max(...heights.slice(0, 60000))) / 2, ['teeth_upper', 'teeth_lower']);
  });
  return NAMES.flatMap((name) => {
    const own = meshes.filter(({ part }) => part === name);
    return own.length ? [{ ...merge(name, own), material: materialOf(own, scene) }] : [];
  });
}
