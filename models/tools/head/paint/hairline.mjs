// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Hairlines: where a sheet of hair ends on the skin, its picture fades out in strands, so that it does not end like a cap.
 */
import { smoothstep } from '../../lib/zones.mjs';
import { eachTexel } from './bake.mjs';
import { noise } from './noise.mjs';

const STEP = 1; // mm between samples of the border
const STRAND = 0.9; // mm along the border
const LEAST_PIECE = 1200; // mm² of a sheet; smaller pieces are strands, which have ends of their own

/**
 * Multiplies the picture's opacity.
 * @param {{size: number, data: Float32Array}} image of the hair
 * @param {object} part the hair @param {{position: ArrayLike<number>}} skin
 * @param {{fade: number, near: number}} look mm over which hair fades, and how near to the skin a border is a hairline
 */
export function fadeHairline(image, part, skin, { fade, near }) {
  const samples = sampled(part, hairline(part, skin, near));
  if (!samples.size) return;
  const p = part.position;
  eachTexel(part, image.size, (texel, a, b, c, wa, wb, wc) => {
    const q = [0, 1, 2].map((k) => wa * p[a * 3 + k] + wb * p[b * 3 + k] + wc * p[c * 3 + k]);
    const [far, along] = nearest(samples, q, fade);
    if (far >= fade) return;
    const strand = 0.5 + 0.5 * noise(along / STRAND, far / (4 * fade), 3.7);
    const lock = 0.5 + 0.5 * noise(along / (6 * STRAND), 1.3, 8.1);
    const start = fade * (0.6 * strand + 0.25 * lock);
    image.data[texel * 4 + 3] *= smoothstep(start - 0.15 * fade, start + 0.15 * fade, far);
  });
}

const keyOf = (p, v) => [0, 1, 2].map((k) => Math.round(p[v * 3 + k] * 20)).join('/');

/** Edges of a single triangle, in one piece with much hair, near the skin. @returns {number[][]} pairs of vertices */
function hairline({ position: p, index }, skin, near) {
  const first = new Map();
  const place = Array.from({ length: p.length / 3 }, (_, v) => {
    const key = keyOf(p, v);
    if (!first.has(key)) first.set(key, v);
    return first.get(key);
  });
  const edges = new Map();
  const piece = Array.from(place, (_, v) => v);
  const root = (v) => {
    while (piece[v] !== v) v = piece[v] = piece[piece[v]];
    return v;
  };
  const area = new Float64Array(place.length);
  for (let t = 0; t < index.length; t += 3) {
    const v = [0, 1, 2].map((i) => place[index[t + i]]);
    v.forEach((one, i) => {
      const other = v[(i + 1) % 3];
      const key = one < other ? `${one}/${other}` : `${other}/${one}`;
      edges.set(key, { pair: [one, other], count: (edges.get(key)?.count ?? 0) + 1 });
      piece[root(one)] = root(other);
    });
  }
  for (let t = 0; t < index.length; t += 3) area[root(place[index[t]])] += areaOf(p, place, index, t);
  const touches = nearSkin(p, skin.position, near);
  return [...edges.values()]
    .filter(({ pair, count }) => count === 1 && area[root(pair[0])] > LEAST_PIECE && pair.every(touches))
    .map(({ pair }) => pair);
}

function areaOf(p, place, index, t) {
  const [a, b, c] = [0, 1, 2].map((i) => place[index[t + i]]);
  const [u, v] = [b, c].map((one) => [0, 1, 2].map((k) => p[one * 3 + k] - p[a * 3 + k]));
  return Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
}

function nearSkin(p, skin, near) {
  return (v) => {
    for (let i = 0; i < skin.length; i += 3)
      if (Math.hypot(skin[i] - p[v * 3], skin[i + 1] - p[v * 3 + 1], skin[i + 2] - p[v * 3 + 2]) < near) return true;
    return false;
  };
}

/** Points along the border in cells of a grid, each with its place along it. */
function sampled({ position: p }, edges) {
  const cells = new Map();
  let along = 0;
  for (const [a, b] of edges) {
    const length = Math.hypot(...[0, 1, 2].map((k) => p[b * 3 + k] - p[a * 3 + k]));
    const n = Math.max(1, Math.ceil(length / STEP));
    for (let i = 0; i < n; i++) {
      const q = [0, 1, 2].map((k) => p[a * 3 + k] + ((p[b * 3 + k] - p[a * 3 + k]) * (i + 0.5)) / n);
      const cell = cellOf(q);
      cells.set(cell, [...(cells.get(cell) ?? []), [...q, along + (length * (i + 0.5)) / n]]);
    }
    along += length;
  }
  return cells;
}

const CELL = 16; // mm, at least as long as any fade
const cellOf = (q) => q.map((x) => Math.floor(x / CELL)).join('/');

/** @returns {number[]} mm to the nearest sample, and its place along the border */
function nearest(cells, q, most) {
  let best = [most, 0];
  for (const i of [-1, 0, 1])
    for (const j of [-1, 0, 1])
      for (const k of [-1, 0, 1])
        for (const [x, y, z, along] of cells.get(cellOf([q[0] + i * CELL, q[1] + j * CELL, q[2] + k * CELL])) ?? []) {
          const far = Math.hypot(x - q[0], y - q[1], z - q[2]);
          if (far < best[0]) best = [far, along];
        }
  return best;
}
