// SPDX-License-Identifier: GPL-3.0-or-later
/** Triangles: of polygons, strips and fans, and wound the right way. */

const CLEAR = 0.02; // minimum share of a ball's volume that tells inside from outside

const minus = (a, b) => a.map((x, k) => x - b[k]);

/** Projects the face to a plane, counter-clockwise. @returns {number[][]|null} null if it has no area */
function flat(points) {
  const normal = [0, 0, 0];
  points.forEach((p, i) => {
    const q = points[(i + 1) % points.length];
    for (let k = 0; k < 3; k++) normal[k] += (p[(k + 1) % 3] - q[(k + 1) % 3]) * (p[(k + 2) % 3] + q[(k + 2) % 3]);
  });
  const k = normal.reduce((best, x, i) => (Math.abs(x) > Math.abs(normal[best]) ? i : best), 0);
  if (!normal[k]) return null;
  return points.map((p) => (normal[k] > 0 ? [p[(k + 1) % 3], p[(k + 2) % 3]] : [p[(k + 2) % 3], p[(k + 1) % 3]]));
}

const left = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

/**
 * Triangulates a face as a fan from its first corner or, if that would leave the face, by ear clipping.
 * @param {number[]} corners @param {(corner: number) => number[]} at position of a corner @param {(a: number, b: number, c: number) => void} add
 * @param {(steps: number) => void} work called for each pass over the corners; may throw to stop
 */
export function cutFace(corners, at, add, work) {
  const fan = (list) => {
    for (let i = 2; i < list.length; i++) add(list[0], list[i - 1], list[i]);
  };
  if (corners.length === 3) return fan(corners);
  work(8 * corners.length);
  const first = at(corners[0]);
  const points = flat(corners.map((v) => minus(at(v), first)));
  const around = (list, i) => [list.at(i - 1), list[i], list[(i + 1) % list.length]];
  if (!points || points.every((_, i) => left(...around(points, i)) >= 0)) return fan(corners);
  const rest = corners.map((v, i) => ({ v, p: points[i] }));
  while (rest.length > 3) {
    const ear = rest.findIndex((one, i) => {
      const [a, b, c] = around(rest, i);
      work(1);
      if (left(a.p, b.p, c.p) <= 0) return false;
      work(rest.length);
      const same = (p, q) => p[0] === q[0] && p[1] === q[1];
      return rest.every(({ p }) => [a, b, c].some((q) => same(p, q.p)) || left(a.p, b.p, p) < 0 || left(b.p, c.p, p) < 0 || left(c.p, a.p, p) < 0);
    });
    if (ear < 0) break; // the polygon intersects itself
    add(...around(rest, ear).map(({ v }) => v));
    rest.splice(ear, 1);
  }
  return fan(rest.map(({ v }) => v));
}

/** Converts strips, separated by negative indices; every other triangle is wound the other way. */
export function cutStrip(corners, add) {
  let from = 0;
  corners.forEach((c, i) => {
    if (c < 0) from = i + 1;
    if (c < 0 || i - from < 2) return;
    const [a, b] = (i - from) % 2 ? [corners[i - 1], corners[i - 2]] : [corners[i - 2], corners[i - 1]];
    if (a !== b && b !== c && a !== c) add(a, b, c);
  });
}

/** Converts glTF's modes 5 and 6 (strips, fans) to 4 (triangles). */
export function asTriangles(mode, index) {
  const out = [];
  const add = (...three) => out.push(...three);
  if (mode === 5) cutStrip([...index], add);
  else for (let i = 2; i < index.length; i++) add(index[i - 1], index[i], index[0]);
  return Uint32Array.from(out);
}

/** Reverses the winding. */
export const turnedOver = (index) => index.map((v, i) => (i % 3 === 0 ? v : i % 3 === 1 ? index[i + 1] : index[i - 1]));

/** Signed volume relative to a ball of the same surface area; negative: inside out. */
function held({ position, index }) {
  const middle = [0, 0, 0];
  for (let i = 0; i < position.length; i++) middle[i % 3] += (3 * position[i]) / position.length;
  let [volume, area] = [0, 0];
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => middle.map((m, j) => position[3 * index[t + k] + j] - m));
    const [u, v] = [b, c].map((p) => p.map((x, k) => x - a[k]));
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    volume += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6;
    area += Math.hypot(...n) / 2;
  }
  return volume / ((area / Math.PI) ** 1.5 * (Math.PI / 6) || 1);
}

/** Reverses the winding of the whole scene if its face is inside out: left-handed programs mirror their files, or wind them the other way. @returns {string[]} notes */
export function faceOutward(scene) {
  const skin = scene.meshes.filter(({ part }) => part === 'skin').sort((a, b) => b.index.length - a.index.length)[0];
  if (!skin || held(skin) > -CLEAR) return [];
  for (const mesh of scene.meshes) mesh.index = turnedOver(mesh.index);
  return ['its surfaces were wound inside out: they were turned over'];
}
