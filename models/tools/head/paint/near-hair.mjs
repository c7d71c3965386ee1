// SPDX-License-Identifier: GPL-3.0-or-later
/** Distance of the skin to hair and beard, so that these begin softly. */

const CELL = 2.5; // mm
const BEHIND = [-1, 0, 1].flatMap((z) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((x) => [x, y, z]))).slice(0, 13);

/**
 * @param {object} part @param {((u: number, v: number) => boolean)|undefined} opaque where its texture is opaque
 * @param {number} most maximum distance in mm @returns {(x: number, y: number, z: number) => number} mm to the part's surface, accurate to about
 *   a cell; more than `most` if farther
 */
export function distanceTo(part, opaque, most) {
  const p = part.position;
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < p.length; i++) {
    low[i % 3] = Math.min(low[i % 3], p[i]);
    high[i % 3] = Math.max(high[i % 3], p[i]);
  }
  const size = low.map((x, k) => Math.ceil((high[k] - x + 2 * most) / CELL) + 3);
  const from = low.map((x) => x - most - CELL);
  const field = new Float32Array(size[0] * size[1] * size[2]).fill(1e3);
  const place = (i, j, k) => (k * size[1] + j) * size[0] + i;
  eachPoint(part, opaque, (q) => (field[place(...q.map((x, k) => Math.floor((x - from[k]) / CELL)))] = 0));
  spread(field, size);
  return (x, y, z) => {
    const [u, v, w] = [x, y, z].map((value, k) => (value - from[k]) / CELL - 0.5);
    const [i, j, k] = [u, v, w].map(Math.floor);
    if (i < 0 || j < 0 || k < 0 || i >= size[0] - 1 || j >= size[1] - 1 || k >= size[2] - 1) return 1e3;
    const [fx, fy, fz] = [u - i, v - j, w - k];
    const row = (at) => field[at] * (1 - fx) + field[at + 1] * fx;
    const sheet = (at) => row(at) * (1 - fy) + row(at + size[0]) * fy;
    const at = place(i, j, k);
    return sheet(at) * (1 - fz) + sheet(at + size[0] * size[1]) * fz;
  };
}

/** Points all over the surface, less than a cell apart. */
function eachPoint({ position: p, index, uv }, opaque, fn) {
  for (let t = 0; t < index.length; t += 3) {
    const v = [index[t], index[t + 1], index[t + 2]];
    const side = (a, b) => Math.hypot(...[0, 1, 2].map((k) => p[a * 3 + k] - p[b * 3 + k]));
    const n = Math.max(1, Math.ceil(Math.max(side(v[0], v[1]), side(v[1], v[2]), side(v[2], v[0])) / (CELL * 0.7)));
    for (let i = 0; i <= n; i++)
      for (let j = 0; i + j <= n; j++) {
        const w = [i / n, j / n, (n - i - j) / n];
        const mean = (list, stride, k) => w.reduce((sum, x, c) => sum + x * list[v[c] * stride + k], 0);
        if (!opaque || opaque(mean(uv, 2, 0), mean(uv, 2, 1))) fn([0, 1, 2].map((k) => mean(p, 3, k)));
      }
  }
}

/** Chamfer distance: a forward and a backward pass, each cell from its predecessors. */
function spread(field, size) {
  const steps = BEHIND.map(([x, y, z]) => ({ x, y, z, mm: CELL * Math.hypot(x, y, z) }));
  for (const sign of [1, -1])
    for (let a = 0; a < size[2]; a++)
      for (let b = 0; b < size[1]; b++)
        for (let c = 0; c < size[0]; c++) {
          const [i, j, k] = sign > 0 ? [c, b, a] : [size[0] - 1 - c, size[1] - 1 - b, size[2] - 1 - a];
          const at = (k * size[1] + j) * size[0] + i;
          let least = field[at];
          for (const { x, y, z, mm } of steps) {
            const [ni, nj, nk] = [i + sign * x, j + sign * y, k + sign * z];
            if (ni < 0 || nj < 0 || nk < 0 || ni >= size[0] || nj >= size[1] || nk >= size[2]) continue;
            least = Math.min(least, field[(nk * size[1] + nj) * size[0] + ni] + mm);
          }
          field[at] = least;
        }
}
