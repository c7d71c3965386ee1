// SPDX-License-Identifier: GPL-3.0-or-later
/** What long hair lies on: skull, ears, neck, shoulders and clothes, as the distance to the nearest point of their surfaces. */
import { normals } from '../../lib/mesh.mjs';
import { unit } from '../../lib/vector.mjs';
import { smoothstep } from '../../lib/zones.mjs';

const CELL = 4; // mm
const FINE = 3; // mm between samples of the surface
const FLAT = 12; // mm: nearer, heights are measured from the tangent plane
const LIES = [8, 20]; // mm above the surface, between which cards cease to lie on it
const LOW = -320; // mm: hair ends above it
const WIDE = 150; // mm at each side
const MIDDLE = [0, 25, -75]; // of the skull, mm
const BEHIND = [-1, 0, 1].flatMap((z) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((x) => [x, y, z]))).slice(0, 13);
const FACING = 0.5; // an ear's inside is left out: of its normals, the share outwards that counts

/**
 * @param {object[]} parts @param {(q: number[]) => boolean} ear what of them is an ear's
 * @returns {{height: Function, lifted: Function, normal: Function}} as skullOf
 */
export function bodyOf(parts, ear) {
  const samples = parts.flatMap((part) => samplesOf(part, ear));
  const field = nearestOf(samples);
  const height = (q) => {
    const at = field(q);
    if (!at) return 1e3;
    const away = q.map((x, k) => x - at.q[k]);
    const far = Math.hypot(...away);
    const above = away[0] * at.n[0] + away[1] * at.n[1] + away[2] * at.n[2];
    return far < FLAT ? above : far * Math.sign(above);
  };
  /** Outwards of the skull, level below it: hair hangs beside the neck like a curtain. */
  const normal = (q) => {
    const [x, y, z] = q.map((value, k) => value - MIDDLE[k]);
    return unit([x / 76 ** 2, (smoothstep(-30, 30, y) * y) / 92 ** 2, z / 98 ** 2]);
  };
  return {
    height,
    lifted: (q, mm) => {
      const at = field(q);
      return at ? q.map((x, k) => x + mm * at.n[k]) : q;
    },
    normal,
    /** That of what a card lies on, as far as it does. */
    lying: (q) => {
      const share = smoothstep(LIES[1], LIES[0], height(q));
      return share ? unit(normal(q).map((x, k) => (1 - share) * x + share * field(q).n[k])) : normal(q);
    },
  };
}

function samplesOf({ position: p, index, smooth }, ear) {
  const ns = normals(p, index, smooth);
  const out = [];
  for (let t = 0; t < index.length; t += 3) {
    const v = [index[t], index[t + 1], index[t + 2]];
    const side = (a, b) => Math.hypot(...[0, 1, 2].map((k) => p[3 * a + k] - p[3 * b + k]));
    const n = Math.max(1, Math.ceil(Math.max(side(v[0], v[1]), side(v[1], v[2]), side(v[2], v[0])) / FINE));
    for (let i = 0; i <= n; i++)
      for (let j = 0; i + j <= n; j++) {
        const w = [i / n, j / n, (n - i - j) / n];
        const mean = (list) => [0, 1, 2].map((k) => w.reduce((sum, x, c) => sum + x * list[3 * v[c] + k], 0));
        const q = mean(p);
        const outward = unit(mean(ns));
        if (q[1] > LOW && Math.abs(q[0]) < WIDE && !(ear(q) && outward[0] * Math.sign(q[0]) < FACING)) out.push({ q, n: outward });
      }
  }
  return out;
}

/** Cells with the nearest of the samples. @returns {(q: number[]) => {q: number[], n: number[]}|undefined} */
function nearestOf(samples) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { q } of samples)
    for (let k = 0; k < 3; k++) [low[k], high[k]] = [Math.min(low[k], q[k]), Math.max(high[k], q[k])];
  const from = low.map((x) => x - 60);
  const size = high.map((x, k) => Math.ceil((x + 60 - from[k]) / CELL) + 1);
  const found = new Int32Array(size[0] * size[1] * size[2]).fill(-1);
  const far = new Float32Array(found.length).fill(Infinity);
  const placeOf = (i, j, k) => (k * size[1] + j) * size[0] + i;
  const middle = (i, k) => from[k] + (i + 0.5) * CELL;
  const offer = (at, x, y, z, sample) => {
    const { q } = samples[sample];
    const mm = Math.hypot(x - q[0], y - q[1], z - q[2]);
    if (mm < far[at]) [far[at], found[at]] = [mm, sample];
  };
  samples.forEach(({ q }, sample) => {
    const [i, j, k] = q.map((x, axis) => Math.floor((x - from[axis]) / CELL));
    offer(placeOf(i, j, k), middle(i, 0), middle(j, 1), middle(k, 2), sample);
  });
  for (const sign of [1, -1])
    for (let a = 0; a < size[2]; a++)
      for (let b = 0; b < size[1]; b++)
        for (let c = 0; c < size[0]; c++) {
          const [i, j, k] = sign > 0 ? [c, b, a] : [size[0] - 1 - c, size[1] - 1 - b, size[2] - 1 - a];
          const at = placeOf(i, j, k);
          for (const [x, y, z] of BEHIND) {
            const [u, v, w] = [i + sign * x, j + sign * y, k + sign * z];
            if (u < 0 || v < 0 || w < 0 || u >= size[0] || v >= size[1] || w >= size[2]) continue;
            const sample = found[placeOf(u, v, w)];
            if (sample >= 0) offer(at, middle(i, 0), middle(j, 1), middle(k, 2), sample);
          }
        }
  return (q) => {
    const [i, j, k] = q.map((x, axis) => Math.floor((x - from[axis]) / CELL));
    if (i < 0 || j < 0 || k < 0 || i >= size[0] || j >= size[1] || k >= size[2]) return undefined;
    return samples[found[placeOf(i, j, k)]];
  };
}
