// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * The neutral head in millimetres: base mesh plus the recipe's morph targets, moved so that the origin lies
 * between the centres of the eyeballs. Everything is kept for all base vertices, helpers included, because the proxies are attached to them.
 */
import { readTarget } from './assets.mjs';
import { groupVertices } from '../lib/mesh.mjs';

const MM_PER_UNIT = 100;

/** @returns {{p: Float64Array, eyes: {l: number[], r: number[], radius: number}}} p is the shape in mm */
export function buildShape(assets, base, recipe) {
  const p = Float64Array.from(base.positions);
  for (const [name, weight] of Object.entries(recipe.shape)) {
    const d = readTarget(assets, name);
    for (let i = 0; i < p.length; i++) p[i] += d[i] * weight;
  }
  for (let i = 0; i < p.length; i++) p[i] *= MM_PER_UNIT;
  const l = fitSphere(p, groupVertices(base, 'helper-l-eye'));
  const r = fitSphere(p, groupVertices(base, 'helper-r-eye'));
  const origin = l.centre.map((x, k) => (x + r.centre[k]) / 2);
  for (let i = 0; i < p.length; i++) p[i] -= origin[i % 3];
  const place = (c) => c.map((x, k) => x - origin[k]);
  return { p, eyes: { l: place(l.centre), r: place(r.centre), radius: (l.radius + r.radius) / 2 } };
}

/** A morph target in mm. */
export function targetInMm(assets, name) {
  return readTarget(assets, name).map((x) => x * MM_PER_UNIT);
}

/**
 * The sphere that fits the points best in the algebraic sense: |q|^2 = 2 c.q + k, linear in c and k = r^2 -
 * |c|^2. The eye helper is a sphere with a bulge for the cornea; the bulge is few points and shifts the
 * centre by a few tenths of a mm.
 */
function fitSphere(p, vertices) {
  const m = Array.from({ length: 4 }, () => new Float64Array(5));
  for (const v of vertices) {
    const q = [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]];
    const row = [2 * q[0], 2 * q[1], 2 * q[2], 1];
    const rhs = q[0] ** 2 + q[1] ** 2 + q[2] ** 2;
    for (let i = 0; i < 4; i++) {
      for (let j = 0; j < 4; j++) m[i][j] += row[i] * row[j];
      m[i][4] += row[i] * rhs;
    }
  }
  const [x, y, z, k] = solve(m);
  return { centre: [x, y, z], radius: Math.sqrt(k + x * x + y * y + z * z) };
}

/** Gauss elimination with pivoting of n rows of n + 1 columns. */
function solve(m) {
  const n = m.length;
  for (let c = 0; c < n; c++) {
    let best = c;
    for (let r = c + 1; r < n; r++) if (Math.abs(m[r][c]) > Math.abs(m[best][c])) best = r;
    [m[c], m[best]] = [m[best], m[c]];
    for (let r = 0; r < n; r++) {
      if (r === c) continue;
      const f = m[r][c] / m[c][c];
      for (let k = c; k <= n; k++) m[r][k] -= f * m[c][k];
    }
  }
  return m.map((row, i) => row[n] / row[i]);
}
