// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Cards: narrow strips with a few hairs each. They are added to a part of hair, and share its picture: their hairs are painted
 * in a square of it that the part leaves free.
 */
import { cross, dot, unit } from '../lib/vector.mjs';

const CELLS = 64; // along a side of the picture
const SIDES = [20, 16, 12, 10, 8, 6]; // of a free square, in cells, the largest first
const MARGIN = 1; // cells to what the part shows

export const ROWS = 3; // of a card's vertices, from the root to the tip
export const KINDS = 4; // columns of the square: other hairs in each

/** Numbers of 0..1, the same everywhere. @returns {() => number} */
export function dice(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state >>> 8) / 16777216;
  };
}

/** A square of the texture that no triangle touches. @returns {number[]} u, v of its lower left corner, and its side */
export function freeSquare({ name, uv, index }) {
  const used = new Uint8Array(CELLS * CELLS);
  const cell = (x) => Math.min(CELLS - 1, Math.max(0, Math.floor(x * CELLS)));
  for (let t = 0; t < index.length; t += 3) {
    const [us, vs] = [0, 1].map((k) => [0, 1, 2].map((i) => uv[2 * index[t + i] + k]));
    for (let j = cell(Math.min(...vs)); j <= cell(Math.max(...vs)); j++)
      for (let i = cell(Math.min(...us)); i <= cell(Math.max(...us)); i++) used[j * CELLS + i] = 1;
  }
  const isFree = (x, y, side) => {
    for (let j = Math.max(0, y - MARGIN); j < Math.min(CELLS, y + side + MARGIN); j++)
      for (let i = Math.max(0, x - MARGIN); i < Math.min(CELLS, x + side + MARGIN); i++) if (used[j * CELLS + i]) return false;
    return true;
  };
  for (const side of SIDES)
    for (let y = 0; y + side <= CELLS; y++)
      for (let x = 0; x + side <= CELLS; x++) if (isFree(x, y, side)) return [x / CELLS, y / CELLS, side / CELLS];
  throw new Error(`the texture of "${name}" has no free square for cards`);
}

/**
 * @param {object} part of hair
 * @param {{spine: number[][], across: number[], width: number, refs: number[][], kind: number}[]} cards spine: ROWS points from
 *   the root to the tip; across: a unit vector; refs: of all its vertices
 * @returns {object} the part with them; `square`: where their hairs are to be painted
 */
export function withCards(part, cards) {
  const square = freeSquare(part);
  const [u, v, side] = square;
  const position = Array.from(part.position);
  const out = { ...part, uv: part.uv.slice(), index: part.index.slice(), refs: part.refs.slice(), square };
  for (const { spine, across, width, refs, kind } of cards) {
    const first = position.length / 3;
    spine.forEach((q, row) => {
      for (const [edge, sign] of [[0, -0.5], [1, 0.5]]) {
        position.push(...q.map((x, k) => x + sign * width * across[k]));
        out.uv.push(u + (side * (kind + 0.04 + 0.92 * edge)) / KINDS, v + side * (1 - (0.02 + (0.96 * row) / (ROWS - 1))));
        out.refs.push(refs);
      }
    });
    for (let row = 0; row < ROWS - 1; row++) {
      const a = first + 2 * row;
      out.index.push(a, a + 1, a + 2, a + 1, a + 3, a + 2);
    }
  }
  out.position = Float64Array.from(position);
  if (part.smooth) out.smooth = [...part.smooth, ...Array.from({ length: out.refs.length - part.smooth.length }, (_, i) => part.smooth.length + i)];
  return out;
}

export const along = (v, n) => v.map((x, k) => x - dot(v, n) * n[k]);

/**
 * A card that lies on a round surface and leaves it towards its tip.
 * @param {number[]} root @param {number[]} n unit, outward @param {number[]} direction unit, on the surface
 * @param {{length: number, width: number, lift: number[], radius: number, twist: number}} form lift: mm at root and tip; radius:
 *   of the surface; twist: in radians out of it
 */
export function layCard(root, n, direction, { length, width, lift, radius, twist }) {
  const spine = Array.from({ length: ROWS }, (_, row) => {
    const s = (length * row) / (ROWS - 1);
    const up = lift[0] + (lift[1] - lift[0]) * (row / (ROWS - 1)) ** 2 - (s * s) / (2 * radius);
    return root.map((x, k) => x + s * direction[k] + up * n[k]);
  });
  const flat = cross(direction, n);
  return { spine, width, across: unit(flat.map((x, k) => x * Math.cos(twist) + n[k] * Math.sin(twist))) };
}

/**
 * Points on the triangles of a mesh that are wanted, as many on each mm².
 * @param {{position: ArrayLike<number>, index: number[]}} mesh @param {() => number} roll of dice
 * @param {(middle: number[]) => boolean} wanted
 * @returns {() => {q: number[], v: number, at: {uv: number[], scale: number}}|null} v: the nearest corner; at: its place in the
 *   picture, and the picture's share that a mm is; null: no triangle is wanted
 */
export function scatter({ position: p, uv, index }, roll, wanted = () => true) {
  const kept = [];
  let sum = 0;
  for (let t = 0; t < index.length; t += 3) {
    const v = [0, 1, 2].map((i) => index[t + i]);
    const [a, b, c] = v.map((one) => [0, 1, 2].map((k) => p[3 * one + k]));
    if (!wanted(a.map((x, k) => (x + b[k] + c[k]) / 3))) continue;
    const area = Math.hypot(...cross(b.map((x, k) => x - a[k]), c.map((x, k) => x - a[k]))) / 2;
    const uvs = v.map((one) => [uv[2 * one], uv[2 * one + 1]]);
    const [[u0, v0], [u1, v1], [u2, v2]] = uvs;
    const shown = Math.abs((u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0)) / 2;
    sum += area;
    kept.push({ v, corners: [a, b, c], uvs, scale: Math.sqrt(shown / (area || 1)), sum });
  }
  if (!kept.length) return () => null;
  return () => {
    const at = roll() * sum;
    const { v, corners, uvs, scale } = kept.find((one) => one.sum >= at);
    const [w, x] = [Math.sqrt(roll()), roll()];
    const share = [1 - w, w * (1 - x), w * x];
    const mean = (list, k) => list.reduce((all, one, c) => all + share[c] * one[k], 0);
    return { q: [0, 1, 2].map((k) => mean(corners, k)), v: v[share.indexOf(Math.max(...share))], at: { uv: [0, 1].map((k) => mean(uvs, k)), scale } };
  };
}
