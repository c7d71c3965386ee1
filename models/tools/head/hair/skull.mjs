// SPDX-License-Identifier: GPL-3.0-or-later
/** The skull that hair grows on: where its surface is, what is outward, and on which side of the hairline a point lies. */
import { unit } from '../../lib/vector.mjs';
import { smoothstep } from '../../lib/zones.mjs';

const MIDDLE = [0, 25, -75]; // mm
const AXES = [76, 92, 98]; // half the skull's width, height and depth: for normals, which are to be smoother than the skin's
const ROUND = 60; // cells of directions, round the skull
const UP = 30; // and up
const FINE = 6; // samples along the sides of a triangle
const SOFTENED = 2; // times that the radii are averaged with their neighbours

/** Degrees round the skull: 0 in front, 90 above an ear, 180 behind. */
export const azimuth = ([x, , z]) => (Math.atan2(Math.abs(x), z - MIDDLE[2]) * 180) / Math.PI;

/** Piecewise linear over a table of [at, value], smoothed within each piece. */
export function along(table, x) {
  if (x <= table[0][0]) return table[0][1];
  for (let i = 1; i < table.length; i++) {
    const [[a, from], [b, to]] = [table[i - 1], table[i]];
    if (x <= b) return from + (to - from) * smoothstep(a, b, x);
  }
  return table.at(-1)[1];
}

/** mm above the hairline; below 0: bare skin. @param {number[][]} line degrees of `azimuth`, height in mm */
export const aboveLine = (line, q) => q[1] - along(line, azimuth(q));

/** @param {{position: ArrayLike<number>, index: ArrayLike<number>}} skin @param {(q: number[]) => boolean} ear what of it is an ear's */
export function skullOf({ position: p, index }, ear) {
  const radii = new Float32Array(ROUND * UP);
  const place = (d) => [((Math.atan2(d[0], d[2]) / Math.PI + 1) / 2) * ROUND, ((Math.asin(Math.max(-1, Math.min(1, d[1]))) / Math.PI) + 0.5) * UP];
  const cell = (i, j) => Math.min(UP - 1, Math.max(0, j)) * ROUND + ((i % ROUND) + ROUND) % ROUND;
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => [0, 1, 2].map((k) => p[3 * index[t + i] + k]));
    for (let i = 0; i <= FINE; i++)
      for (let j = 0; i + j <= FINE; j++) {
        const q = a.map((x, k) => (i * x + j * b[k] + (FINE - i - j) * c[k]) / FINE);
        if (ear(q)) continue;
        const away = q.map((x, k) => x - MIDDLE[k]);
        const far = Math.hypot(...away);
        const [x, y] = place(away.map((value) => value / far)).map(Math.floor);
        radii[cell(x, y)] = Math.max(radii[cell(x, y)], far);
      }
  }
  fill(radii, cell);
  for (let pass = 0; pass < SOFTENED; pass++) soften(radii, cell);
  const radius = (q) => {
    const [x, y] = place(unit(q.map((value, k) => value - MIDDLE[k]))).map((value) => value - 0.5);
    const [i, j] = [x, y].map(Math.floor);
    const [u, v] = [x - i, y - j];
    return (radii[cell(i, j)] * (1 - u) + radii[cell(i + 1, j)] * u) * (1 - v) + (radii[cell(i, j + 1)] * (1 - u) + radii[cell(i + 1, j + 1)] * u) * v;
  };
  return {
    /** mm outside the skin. */
    height: (q) => Math.hypot(...q.map((x, k) => x - MIDDLE[k])) - radius(q),
    /** Moves a point along its radius by mm. */
    lifted: (q, mm) => {
      const away = unit(q.map((x, k) => x - MIDDLE[k]));
      return q.map((x, k) => x + mm * away[k]);
    },
    normal: (q) => unit(q.map((x, k) => (x - MIDDLE[k]) / AXES[k] ** 2)),
  };
}

/** Cells in which there is no skin get the mean of those around that have some. */
function fill(radii, cell) {
  for (let left = true; left; ) {
    left = false;
    const before = radii.slice();
    for (let j = 0; j < UP; j++)
      for (let i = 0; i < ROUND; i++) {
        if (before[cell(i, j)]) continue;
        const near = [[1, 0], [-1, 0], [0, 1], [0, -1]].map(([x, y]) => before[cell(i + x, j + y)]).filter(Boolean);
        if (near.length) radii[cell(i, j)] = near.reduce((sum, x) => sum + x, 0) / near.length;
        else left = true;
      }
  }
}

function soften(radii, cell) {
  const before = radii.slice();
  for (let j = 0; j < UP; j++)
    for (let i = 0; i < ROUND; i++)
      radii[cell(i, j)] = (2 * before[cell(i, j)] + before[cell(i + 1, j)] + before[cell(i - 1, j)] + before[cell(i, j + 1)] + before[cell(i, j - 1)]) / 6;
}
