// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Lays out the texture of a head cut from a whole body: every connected island of texture coordinates in use gets its own rectangle, so that the
 * face fills the picture instead of a corner of the body's texture.
 */

/**
 * @param {{uv: number[], index: number[]}} part its `uv` is replaced, the old one kept as `sourceUv`
 * @param {{at: number[], box: number[], turn: boolean}[]} layout for each island the texture coordinate `at`
 *   that lies in its old rectangle (or the `area`, u0, u1, v0, v1, that small islands lie in, where clothes cut one up), its new rectangle `box`
 * (x, y, width, height), whether it is turned by a
 *   quarter, and optionally a `focus` (place `at`, `width`, `gain`, each for x and y, in shares of the
 *   rectangle) that gets more room than the rest
 */
export function layOut(part, layout) {
  part.sourceUv = part.uv;
  const uv = part.uv.slice();
  const range = (vertices) => {
    const box = [Infinity, -Infinity, Infinity, -Infinity];
    for (const v of vertices)
      for (const k of [0, 1]) {
        box[2 * k] = Math.min(box[2 * k], part.uv[v * 2 + k]);
        box[2 * k + 1] = Math.max(box[2 * k + 1], part.uv[v * 2 + k]);
      }
    return box;
  };
  const inside = ([u, v], [u0, u1, v0, v1]) => u >= u0 && u <= u1 && v >= v0 && v <= v1;
  const places = new Map();
  for (const island of islands(part)) {
    const box = range(island);
    const [u0, u1, v0, v1] = box;
    const target =
      layout.find(({ at }) => inside(at, box)) ??
      layout.find(({ area }) => area && inside([(u0 + u1) / 2, (v0 + v1) / 2], area));
    if (!target) throw new Error(`the atlas has no place for the island u ${u0}..${u1}, v ${v0}..${v1}`);
    places.set(target, (places.get(target) ?? []).concat(island));
  }
  for (const [target, island] of places) {
    const [u0, u1, v0, v1] = range(island);
    const [x, y, w, h] = target.box;
    const stretch = [0, 1].map((k) => (target.focus ? focused(target.focus, k) : (t) => t));
    for (const v of island) {
      const a = (part.uv[v * 2] - u0) / (u1 - u0),
        b = (part.uv[v * 2 + 1] - v0) / (v1 - v0);
      uv[v * 2] = x + w * stretch[0](target.turn ? 1 - b : a);
      uv[v * 2 + 1] = y + h * stretch[1](target.turn ? 1 - a : b);
    }
  }
  part.uv = uv;
}

/** A monotone map of 0..1 to itself, steepest at the focus: the integral of 1 + gain * bell. */
function focused({ at, width, gain }, k) {
  const steps = 512;
  const table = [0];
  for (let i = 0; i < steps; i++) {
    const d = ((i + 0.5) / steps - at[k]) / width[k];
    table.push(table[i] + 1 + gain[k] * Math.exp(-d * d));
  }
  return (t) => {
    const i = Math.min(steps - 1, Math.floor(t * steps));
    return (table[i] + (table[i + 1] - table[i]) * (t * steps - i)) / table[steps];
  };
}

function islands({ uv, index }) {
  const parent = Array.from({ length: uv.length / 2 }, (_, i) => i);
  const find = (i) => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (let t = 0; t < index.length; t += 3) {
    parent[find(index[t])] = find(index[t + 1]);
    parent[find(index[t + 1])] = find(index[t + 2]);
  }
  const out = new Map();
  parent.forEach((_, i) => (out.get(find(i)) ?? out.set(find(i), []).get(find(i))).push(i));
  return [...out.values()];
}

/**
 * Lays out a texture that is painted on the surface: all islands at one scale in millimetres, on shelves, as large as possible. Removed faces take no room.
 * @param {{uv: number[], index: number[], position: ArrayLike<number>}} part its `uv` is replaced; its `side` becomes that of the texture in mm
 */
export function packIslands(part) {
  const used = new Set(part.index);
  const flat = islands(part)
    .map((island) => island.filter((v) => used.has(v)))
    .filter((island) => island.length)
    .map((island) => flatten(part, island))
    .sort((a, b) => b.height - a.height);
  let side = Math.sqrt(flat.reduce((sum, { width, height }) => sum + width * height, 0));
  while (!shelved(flat, side)) side *= 1.04;
  const uv = part.uv.slice();
  for (const { island, place, x, y } of flat)
    island.forEach((v, i) => {
      uv[v * 2] = (x + place[i][0]) / side;
      uv[v * 2 + 1] = (y + place[i][1]) / side;
    });
  part.uv = uv;
  part.side = side;
}

const GUTTER = 4; // mm

/** An island in mm, in the orientation of its texture coordinates. */
function flatten({ uv, index, position: p }, island) {
  const mine = new Set(island);
  let surface = 0,
    picture = 0;
  for (let t = 0; t < index.length; t += 3) {
    if (!mine.has(index[t])) continue;
    const [a, b, c] = [index[t], index[t + 1], index[t + 2]];
    const d = (list, stride, from, to) => Array.from({ length: stride }, (_, k) => list[to * stride + k] - list[from * stride + k]);
    const [e, f] = [d(p, 3, a, b), d(p, 3, a, c)];
    surface += Math.hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]);
    const [g, h] = [d(uv, 2, a, b), d(uv, 2, a, c)];
    picture += Math.abs(g[0] * h[1] - g[1] * h[0]);
  }
  const scale = Math.sqrt(surface / (picture || 1));
  const [left, low] = [0, 1].map((k) => Math.min(...island.map((v) => uv[v * 2 + k])));
  const place = island.map((v) => [(uv[v * 2] - left) * scale + GUTTER, (uv[v * 2 + 1] - low) * scale + GUTTER]);
  const [width, height] = [0, 1].map((k) => Math.max(...place.map((q) => q[k])) + GUTTER);
  return { island, place, width, height, x: 0, y: 0 };
}

/** Puts the islands, the highest first, side by side on shelves. @returns {boolean} whether a square of that side holds them */
function shelved(flat, side) {
  let x = 0,
    y = 0,
    shelf = 0;
  for (const one of flat) {
    if (x && x + one.width > side) {
      x = 0;
      y += shelf;
      shelf = 0;
    }
    if (x + one.width > side || y + one.height > side) return false;
    Object.assign(one, { x, y });
    x += one.width;
    shelf = Math.max(shelf, one.height);
  }
  return true;
}
