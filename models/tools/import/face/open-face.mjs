// SPDX-License-Identifier: GPL-3.0-or-later
/** Adds what scans and statues lack: separates lips that are one surface, and inserts eyeballs into eye holes. */
import { partOf } from '../mesh/parts.mjs';
import { pictureAsPng } from '../mesh/png.mjs';

const UPPER = [78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308]; // landmarks of the lips' inner border, from the head's right to its left
const LOWER = [78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308];
const COLUMNS = 64; // along the line between the lips
const VALLEY = 0.06; // of the mouth's width, search range up and down: the line is where the surface is deepest
const SMOOTH = 4; // columns
const APART = 0.02; // mm up and down, because coincident vertices would be welded again
const THICK = 0.3; // of the mouth's width: surfaces farther behind are not lips
const EYES = [
  { part: 'eye_l', pupil: '3.5', lids: [263, 362, 386, 374, 385, 380, 387, 373, 384, 381, 388, 390], middle: [386, 374] },
  { part: 'eye_r', pupil: '3.6', lids: [33, 133, 159, 145, 158, 153, 160, 144, 157, 154, 161, 163], middle: [159, 145] },
];
const RADIUS = 12; // mm, of an eyeball
const NEAR = 2.5; // mm: search radius for a lid around its landmark
const AWAY = 14; // mm before or behind the mean face: not a lid
const HOLLOW = 5; // mm behind the lids: a hole
const WIDE = 20; // mm to each side: maximum half width of an eye hole
const RINGS = 24;

/** Line between the lips in the mesh's axes: x from the head's right to its left, y and z of each column. */
function lineOf({ view, marks }) {
  const inner = UPPER.map((up, i) => [0, 1].map((k) => (marks[up][k] + marks[LOWER[i]][k]) / 2));
  const [from, to] = [inner[0][0], inner.at(-1)[0]];
  const wide = to - from;
  const rows = [];
  for (let c = 0; c <= COLUMNS; c++) {
    const u = from + (wide * c) / COLUMNS;
    const i = Math.max(1, inner.findIndex(([x], k) => k && x >= u));
    const share = (u - inner[i - 1][0]) / (inner[i][0] - inner[i - 1][0] || 1);
    const v = inner[i - 1][1] + share * (inner[i][1] - inner[i - 1][1]);
    let [best, deepest] = [v, Infinity];
    for (let row = Math.round(v - VALLEY * wide); row <= v + VALLEY * wide; row++) {
      const here = view.at(u, row);
      if (here && here.point[2] < deepest) [best, deepest] = [row, here.point[2]];
    }
    rows.push(best);
  }
  const at = (c) => rows[Math.max(0, Math.min(COLUMNS, c))];
  return rows.map((_, c) => {
    let sum = 0;
    for (let k = -SMOOTH; k <= SMOOTH; k++) sum += at(c + k) / (2 * SMOOTH + 1);
    const [x, y] = view.place(from + (wide * c) / COLUMNS, sum);
    return { x, y, z: view.at(from + (wide * c) / COLUMNS, sum)?.point[2] ?? null };
  });
}

/**
 * Separates the lips. Adds vertices on the line for each lip; the cut ends at a shared vertex on each side.
 * @param {object} mesh of the skin, changed in place @param {{view: object, marks: number[][]}} seen from the front
 * @param {number} mm in the mesh's unit @returns {boolean} whether anything was cut
 */
export function cutLips(mesh, seen, mm) {
  const line = lineOf(seen);
  const [first, last] = [line[0].x, line.at(-1).x];
  const wide = last - first;
  const depths = line.flatMap(({ z }) => (z === null ? [] : [z]));
  if (!(wide > 0) || depths.length < COLUMNS / 2) return false;
  const back = Math.min(...depths) - THICK * wide;
  const lineAt = (x) => {
    const c = Math.max(0, Math.min(COLUMNS - 1e-9, ((x - first) / wide) * COLUMNS));
    const i = Math.floor(c);
    return line[i].y + (c - i) * (line[i + 1].y - line[i].y);
  };
  const p = (v, k) => mesh.position[3 * v + k];
  const over = (v) => p(v, 1) - lineAt(p(v, 0)) || 1e-9;
  const lists = [['position', 3, mesh.position], ...(mesh.uv ? [['uv', 2, mesh.uv]] : []), ...Object.entries(mesh.targets).map(([name, list]) => [name, 3, list])]
    .map(([name, width, list]) => ({ name, width, list: [...list] }));
  let count = mesh.position.length / 3;
  const cuts = new Map();
  /** The two new vertices where an edge crosses the line, or null. */
  const cut = (a, b) => {
    const key = a < b ? `${a} ${b}` : `${b} ${a}`;
    if (cuts.has(key)) return cuts.get(key);
    const [low, high] = [over(a), over(b)];
    let found = null;
    if (low > 0 !== high > 0 && Math.max(p(a, 2), p(b, 2)) > back) {
      const share = low / (low - high);
      const x = p(a, 0) + share * (p(b, 0) - p(a, 0));
      if (x > first && x < last && p(a, 2) + share * (p(b, 2) - p(a, 2)) > back) {
        for (const side of [1, -1])
          for (const { name, width, list } of lists)
            for (let k = 0; k < width; k++) list.push(list[width * a + k] + share * (list[width * b + k] - list[width * a + k]) + (name === 'position' && k === 1 ? side * mm * APART : 0));
        found = { upper: count, lower: count + 1 };
        count += 2;
      }
    }
    cuts.set(key, found);
    return found;
  };
  const index = [];
  for (let t = 0; t < mesh.index.length; t += 3) {
    const corners = [mesh.index[t], mesh.index[t + 1], mesh.index[t + 2]];
    const met = corners.map((v, i) => cut(v, corners[(i + 1) % 3]));
    const number = met.filter(Boolean).length;
    if (!number) index.push(...corners);
    else if (number === 1) {
      // end of the cut: from the crossed edge to the opposite corner
      const i = met.findIndex(Boolean);
      const [a, b, c] = [0, 1, 2].map((k) => corners[(i + k) % 3]);
      const { upper, lower } = met[i];
      index.push(a, over(a) > 0 ? upper : lower, c, over(b) > 0 ? upper : lower, b, c);
    } else {
      // one corner is alone on its side of the line
      const i = met.findIndex((one, k) => one && met[(k + 2) % 3]);
      const [a, b, c] = [0, 1, 2].map((k) => corners[(i + k) % 3]);
      const own = over(a) > 0 ? 'upper' : 'lower';
      const other = over(a) > 0 ? 'lower' : 'upper';
      const [ab, ca] = [met[i], met[(i + 2) % 3]];
      index.push(a, ab[own], ca[own], ab[other], b, c, ab[other], c, ca[other]);
    }
  }
  if (!cuts.size || count === mesh.position.length / 3) return false;
  for (const { name, list } of lists) {
    if (name === 'position' || name === 'uv') mesh[name] = Float64Array.from(list);
    else mesh.targets[name] = Float64Array.from(list);
  }
  mesh.index = Uint32Array.from(index);
  if (mesh.from) mesh.from = Array.from({ length: count }, (_, v) => mesh.from[v] ?? -1);
  return true;
}

/** Makes an eyeball with its picture projected from the front. */
function eyeball(name, centre, radius, material) {
  const [position, uv, index] = [[], [], []];
  const columns = 2 * RINGS;
  for (let r = 0; r <= RINGS; r++)
    for (let c = 0; c <= columns; c++) {
      const [down, around] = [(Math.PI * r) / RINGS, (2 * Math.PI * c) / columns];
      const n = [Math.sin(down) * Math.cos(around), Math.sin(down) * Math.sin(around), Math.cos(down)];
      position.push(...n.map((x, k) => centre[k] + radius * x));
      uv.push(0.5 + n[0] / 2, 0.5 + n[1] / 2);
      if (r === RINGS || c === columns) continue;
      const [a, b] = [r * (columns + 1) + c, (r + 1) * (columns + 1) + c];
      if (r) index.push(a, b, a + 1);
      if (r < RINGS - 1) index.push(a + 1, b, b + 1);
    }
  return { name, material, position: Float64Array.from(position), uv: Float64Array.from(uv), index: Uint32Array.from(index), targets: {}, ball: { centre, radius } };
}

/** Draws the picture of an eye: white, a brown iris, lighter inwards, with a dark border, and the pupil. */
function irisPicture() {
  const size = 256;
  const data = new Uint8ClampedArray(4 * size * size);
  const smooth = (from, to, x) => Math.min(1, Math.max(0, (x - from) / (to - from)));
  const mix = (a, b, share) => a.map((x, k) => x + share * (b[k] - x));
  for (let y = 0; y < size; y++)
    for (let x = 0; x < size; x++) {
      const [u, v] = [(2 * (x + 0.5)) / size - 1, (2 * (y + 0.5)) / size - 1];
      const off = Math.hypot(u, v);
      const ray = 0.5 + 0.5 * Math.sin(31 * Math.atan2(v, u)) * Math.sin(13 * Math.atan2(v, u) + 9 * off);
      const iris = mix(mix([118, 82, 52], [78, 52, 34], ray), [40, 27, 20], smooth(0.36, 0.48, off));
      const colour = mix(mix([18, 14, 13], iris, smooth(0.17, 0.2, off)), mix([232, 226, 221], [205, 178, 168], smooth(0.6, 1, off)), smooth(0.46, 0.5, off));
      data.set([...colour, 255], 4 * (y * size + x));
    }
  return pictureAsPng({ width: size, height: size, data });
}

/** Position of a lid's landmark: the point nearest to the camera around it, because the landmark may be just beside the lid, in the hole. */
function lidAt(view, [u, v], reach) {
  let best = null;
  for (let y = -reach; y <= reach; y++)
    for (let x = -reach; x <= reach; x++) {
      const here = view.at(u + x, v + y);
      if (here && (!best || here.point[2] > best[2])) best = here.point;
    }
  const own = view.place(u, v);
  return best && [own[0], own[1], best[2]];
}

/** Finds the connected region that is deeper or empty around a place of the picture. @returns {{middle: number[], wide: number}|null} in the mesh's unit */
function holeAt(view, [u, v], deep, reach) {
  const [column, row] = [Math.round(u), Math.round(v)];
  const open = (x, y) => {
    const here = view.at(x, y);
    return !here || here.point[2] < deep;
  };
  if (!open(column, row)) return null;
  const seen = new Set([`${column} ${row}`]);
  const list = [[column, row]];
  for (const [x, y] of list)
    for (const [a, b] of [[x + 1, y], [x - 1, y], [x, y + 1], [x, y - 1]]) {
      if (seen.has(`${a} ${b}`) || Math.hypot(a - column, b - row) > reach || !open(a, b)) continue;
      seen.add(`${a} ${b}`);
      list.push([a, b]);
    }
  const bounds = [0, 1].map((k) => [Math.min, Math.max].map((pick) => list.reduce((best, one) => pick(best, one[k]), list[0][k])));
  return { middle: view.place(...bounds.map(([a, b]) => (a + b) / 2)), wide: (bounds[0][1] - bounds[0][0]) / view.scale };
}

const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

/**
 * Adds missing eyeballs where there are holes.
 * @param {object} scene in a face's directions; a mesh and a material are added for each
 * @param {{view: object, marks: number[][]}} seen from the front @param {{template: object, onto: object}} mean the mean face, and how it is laid onto this one
 * @returns {string[]} which
 */
export function addEyes(scene, { view, marks }, { template, onto }) {
  const named = scene.meshes.filter((mesh) => /^eye(s|_[lr])$/.test(partOf(mesh, scene) ?? '')); // drawn eyes are no balls
  const found = EYES.flatMap(({ part, pupil, lids, middle }) => {
    const usual = onto.apply(template.fdp[pupil]);
    const isThere = (position, at) => Math.hypot(position[at] - usual[0], position[at + 1] - usual[1]) < RADIUS * onto.scale;
    if (scene.meshes.some(({ ball }) => ball && isThere(ball.centre, 0)) || named.some(({ position }) => position.some((_, i) => i % 3 === 0 && isThere(position, i)))) return [];
    const on = lids.filter((i) => template.at[i]).map((i) => ({ is: lidAt(view, marks[i], Math.round(NEAR * onto.scale * view.scale)), mean: onto.apply(template.at[i]) }));
    const there = on.filter(({ is, mean }) => is && Math.abs(is[2] - mean[2]) < AWAY * onto.scale);
    if (there.length < lids.length / 2) return [];
    const [u, v] = [0, 1].map((k) => (marks[middle[0]][k] + marks[middle[1]][k]) / 2);
    const hole = holeAt(view, [u, v], median(there.map(({ is }) => is[2])) - HOLLOW * onto.scale, WIDE * onto.scale * view.scale);
    return hole ? [{ part, hole, front: usual[2] + median(there.map(({ is, mean }) => is[2] - mean[2])) }] : [];
  });
  if (!found.length) return [];
  // both of the same size, even if the holes differ
  const radius = found.reduce((sum, { hole }) => sum + Math.max(RADIUS * onto.scale, 0.5 * hole.wide) / found.length, 0);
  scene.materials.push({ name: 'eye', color: [1, 1, 1], roughness: 0.12, alpha: 'opaque', double_sided: false, picture: irisPicture() });
  for (const { part, hole, front } of found) scene.meshes.push(eyeball(part, [...hole.middle, front - radius], radius, scene.materials.length - 1));
  return found.map(({ part }) => part);
}
