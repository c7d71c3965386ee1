// SPDX-License-Identifier: MIT
// A head wears the hair, the beard or the glasses of another: they are laid onto its own skull, and move as they did.
import { readModel } from '../element/head/model/model.mjs';
import { rbf } from '../element/head/model/rbf.mjs';
import { packNumbers, packPositions } from './pack.mjs';

const RAYS = 220;
const DOWN = -0.55; // of a ray's direction: below it is the neck
const EAR = 0.88; // sideways: there is the ear, whose form says nothing of the skull
const RAISED = 35; // mm from the tops of the ears up to where the rays start
const SMOOTH = 0.004;
const APART = 3; // mm: nearer points would conflict
const ASIDE = 9; // mm beyond the corners of the lips, up to which a moustache goes
const INSIDE = /^(3\.[56]|6\.|10\.)/; // feature points of eyes, tongue and ears, which nothing of this rests on

const isOf = (word) => ({ name }) => name.startsWith(word);
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** Directions spread evenly over a sphere (Fibonacci's spiral), without those into the neck and the ears. */
const directions = () => Array.from({ length: RAYS }, (_, i) => {
  const y = 1 - (2 * i + 1) / RAYS;
  const [far, turn] = [Math.sqrt(1 - y * y), i * Math.PI * (3 - Math.sqrt(5))];
  return [far * Math.cos(turn), y, far * Math.sin(turn)];
}).filter(([x, y]) => y > DOWN && Math.abs(x) < EAR);

/** The farthest place of a skin on a ray, or null. */
function outermost({ position: p, index }, from, [dx, dy, dz]) {
  let far = 0;
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const [nx, ny, nz] = [dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx];
    const det = ux * nx + uy * ny + uz * nz;
    if (Math.abs(det) < 1e-9) continue;
    const [sx, sy, sz] = [from[0] - p[a], from[1] - p[a + 1], from[2] - p[a + 2]];
    const u = (sx * nx + sy * ny + sz * nz) / det;
    if (u < 0 || u > 1) continue;
    const [qx, qy, qz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const v = (dx * qx + dy * qy + dz * qz) / det;
    if (v < 0 || u + v > 1) continue;
    far = Math.max(far, (vx * qx + vy * qy + vz * qz) / det);
  }
  return far ? [from[0] + far * dx, from[1] + far * dy, from[2] + far * dz] : null;
}

/** From where a skull is looked at. */
const middleOf = (fdp) => [0, 1, 2].map((k) => (fdp['10.1'][k] + fdp['10.2'][k]) / 2 + (k === 1 ? RAISED : 0));

/** Places of a skull, by ray, and feature points: what hair is laid by. @param {object} model (head/model/model.mjs) */
export function placesOf(model) {
  const skin = model.parts.find(({ name }) => name === 'skin');
  const middle = middleOf(model.fdp);
  return { skull: directions().map((ray) => outermost(skin, middle, ray)), fdp: model.fdp };
}

/** The warp of space from one head's skull and face to another's. */
function between(a, b) {
  const shared = Object.keys(a.fdp).filter((name) => b.fdp[name] && !INSIDE.test(name));
  const pairs = shared.map((name) => [a.fdp[name], b.fdp[name]]);
  a.skull.forEach((place, i) => place && b.skull[i] && pairs.push([place, b.skull[i]]));
  const kept = pairs.filter(([p], i) => !pairs.slice(0, i).some(([q]) => distance(p, q) < APART));
  return rbf(kept.flatMap(([p]) => [...p]), kept.flatMap(([, p]) => [...p]), { kernel: 'biharmonic', smooth: SMOOTH });
}

const CELLS = [72, 36]; // of directions, round the skull and from bottom to top
const FINE = 5; // samples along the sides of a triangle
const CLEAR = 1.4; // mm above the skin, where hair would lie in it
const LOW = 0.15; // of a direction's height: below it are ears and neck

/** Makes a function that moves what lies in the skin of a skull out of it. */
function outOf({ position: p, index }, middle) {
  const [round, up] = CELLS;
  const radii = new Float32Array(round * up);
  const cellOf = ([x, y, z]) => {
    const row = Math.min(up - 1, Math.floor((Math.asin(y) / Math.PI + 0.5) * up));
    return row * round + (Math.floor((Math.atan2(x, z) / Math.PI + 1) * 0.5 * round) % round);
  };
  const from = (q) => {
    const away = q.map((x, k) => x - middle[k]);
    const far = Math.hypot(...away);
    return { far, way: away.map((x) => x / far) };
  };
  for (let t = 0; t < index.length; t += 3) {
    const corners = [0, 1, 2].map((i) => [0, 1, 2].map((k) => p[3 * index[t + i] + k]));
    if (corners.every((q) => q[1] < middle[1])) continue;
    for (let i = 0; i <= FINE; i++)
      for (let j = 0; i + j <= FINE; j++) {
        const [a, b, c] = corners;
        const { far, way } = from([0, 1, 2].map((k) => (i * a[k] + j * b[k] + (FINE - i - j) * c[k]) / FINE));
        const cell = cellOf(way);
        radii[cell] = Math.max(radii[cell], far);
      }
  }
  return (positions) => {
    for (let v = 0; v < positions.length; v += 3) {
      const { far, way } = from([...positions.subarray(v, v + 3)]);
      const least = radii[cellOf(way)] + CLEAR;
      if (way[1] < LOW || Math.abs(way[0]) > EAR || far >= least) continue;
      for (let k = 0; k < 3; k++) positions[v + k] = middle[k] + least * way[k];
    }
    return positions;
  };
}

/** A name that is not taken. */
function free(name, taken) {
  while (Object.hasOwn(taken, name)) name += '_';
  return name;
}

/** @param {object} json a head (protocol/head-model.md) @param {string} word with which names of parts begin */
const undressed = (json, word) => ({ ...json, parts: json.parts.filter((part) => !isOf(word)(part)) });

const SHORT = 0.4; // share of a beard's depth that a short one keeps

/** The nearest point of a list to another. */
function nearest(list, q) {
  let [best, least] = [0, Infinity];
  for (let i = 0; i < list.length; i += 3) {
    const far = (list[i] - q[0]) ** 2 + (list[i + 1] - q[1]) ** 2 + (list[i + 2] - q[2]) ** 2;
    if (far < least) [least, best] = [far, i];
  }
  return list.subarray(best, best + 3);
}

/** The parts of a head's beard, its triangles chosen and its vertices moved. */
function reshaped(json, { isKept = () => true, move = null }) {
  const { parts } = readModel(json);
  return { ...json, parts: json.parts.map((part, i) => {
    if (!isOf('beard')(part)) return part;
    const { index, position } = parts[i];
    const kept = [];
    for (let t = 0; t < index.length; t += 3) {
      const corners = [...index.subarray(t, t + 3)];
      if (corners.every((v) => isKept(position.subarray(3 * v, 3 * v + 3)))) kept.push(...corners);
    }
    const moved = move && packPositions(move(position));
    return { ...part, triangles: kept.length / 3, index: { data: packNumbers(kept) }, ...(moved ? { position: moved } : {}) };
  }) };
}

/**
 * A head whose full beard is another: a moustache is what lies above the corners of the lips, a goatee what lies between them,
 * a short beard is nearer to the skin. @param {object} json a head (protocol/head-model.md) that has a beard
 * @param {'full'|'short'|'goatee'|'moustache'} kind
 */
export function beardOfKind(json, kind) {
  if (kind === 'full') return json;
  const { parts, fdp } = readModel(json);
  const [right, left] = [fdp['8.4'], fdp['8.3']];
  const low = Math.min(right[1], left[1]);
  const isBetween = (p) => p[0] > right[0] - ASIDE && p[0] < left[0] + ASIDE;
  if (kind === 'moustache') return reshaped(json, { isKept: (p) => p[1] > low && isBetween(p) });
  if (kind === 'goatee') return reshaped(json, { isKept: isBetween });
  const skin = parts.find(({ name }) => name === 'skin').position;
  return reshaped(json, { move: (position) => {
    const out = Float32Array.from(position);
    for (let i = 0; i < out.length; i += 3) {
      const root = nearest(skin, position.subarray(i, i + 3));
      for (let k = 0; k < 3; k++) out[i + k] = root[k] + SHORT * (position[i + k] - root[k]);
    }
    return out;
  } });
}

/**
 * @param {object} json a head (protocol/head-model.md) @param {object} from the head whose parts it is to have; or hair alone,
 *   with the places of its `skull` (placesOf)
 * @param {'hair'|'beard'|'glasses'} word with which the names of these parts begin; its own of that name go
 * @returns {object} a new head, in which nothing is shared that could be changed
 */
export function dress(json, from, word) {
  const out = undressed(json, word);
  const source = readModel(from);
  const worn = readModel(json);
  const onto = placesOf(worn);
  const skin = worn.parts.find(({ name }) => name === 'skin');
  const clear = word === 'hair' ? outOf(skin, middleOf(worn.fdp)) : (positions) => positions;
  const warp = between(from.skull ? { skull: from.skull, fdp: from.fdp } : placesOf(source), onto);
  const turns = new Set(json.turns.map(({ name }) => name));
  out.materials = { ...json.materials };
  out.textures = { ...json.textures };
  const [materials, textures] = [new Map(), new Map()];
  const named = (names, name, all, value) => {
    if (!names.has(name)) {
      names.set(name, free(name, all));
      all[names.get(name)] = value;
    }
    return names.get(name);
  };
  const own = from.parts.filter(isOf(word)).map((part) => {
    const look = from.materials[part.material];
    const texture = look.texture && named(textures, look.texture, out.textures, from.textures[look.texture]);
    const material = named(materials, part.material, out.materials, { ...look, ...(texture ? { texture } : {}) });
    const { position } = source.parts.find(({ name }) => name === part.name);
    const known = (part.turns ?? []).filter(({ turn }) => turns.has(turn));
    return { ...part, material, position: packPositions(clear(warp.apply(position))), turns: known };
  });
  return { ...out, parts: [...out.parts, ...own] };
}
