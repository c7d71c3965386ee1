// SPDX-License-Identifier: MIT
// Laying points onto others: the similarity (turn, scale, shift) with the least squares. Horn, Closed-form solution of absolute
// orientation using unit quaternions (1987).

/** The eigenvector of the largest eigenvalue of a symmetric 4 x 4 matrix, by turning its off-diagonal away (Jacobi). */
function leading(m) {
  const a = m.map((row) => [...row]);
  const v = [0, 1, 2, 3].map((i) => [0, 1, 2, 3].map((j) => Number(i === j)));
  for (let round = 0; round < 40; round++)
    for (let p = 0; p < 3; p++)
      for (let q = p + 1; q < 4; q++) {
        if (Math.abs(a[p][q]) < 1e-15) continue;
        const angle = 0.5 * Math.atan2(2 * a[p][q], a[q][q] - a[p][p]);
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        for (let k = 0; k < 4; k++) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
        for (let k = 0; k < 4; k++) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
        for (let k = 0; k < 4; k++) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
      }
  const best = [0, 1, 2, 3].reduce((x, i) => (a[i][i] > a[x][x] ? i : x), 0);
  return v.map((row) => row[best]);
}

/**
 * @param {number[][]} from @param {number[][]} to as many points @param {number[]} which of them count
 * @returns {{turn: number[][], scale: number, apply: (point: number[]) => number[]}} rows of the turn: what the new x, y, z
 *   are of the old
 */
export function align(from, to, which) {
  const middle = (points) => [0, 1, 2].map((k) => which.reduce((sum, i) => sum + points[i][k], 0) / which.length);
  const [f, t] = [middle(from), middle(to)];
  const s = [0, 1, 2].map(() => [0, 0, 0]);
  let [size, onto] = [0, 0];
  for (const i of which)
    for (let k = 0; k < 3; k++) {
      size += (from[i][k] - f[k]) ** 2;
      onto += (to[i][k] - t[k]) ** 2;
      for (let l = 0; l < 3; l++) s[k][l] += (from[i][k] - f[k]) * (to[i][l] - t[l]);
    }
  const [w, x, y, z] = leading([
    [s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
    [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
    [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
    [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]],
  ]);
  const turn = [
    [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
  ];
  const scale = Math.sqrt(onto / size);
  const apply = (p) => turn.map((row, k) => t[k] + scale * row.reduce((sum, value, l) => sum + value * (p[l] - f[l]), 0));
  return { turn, scale, apply };
}

/** Pixels with depth, as the detector gives them, in the directions of a head: x to its left, y up, z forward. */
export const upright = (points) => points.map(([u, v, z]) => [u, -v, -z]);
