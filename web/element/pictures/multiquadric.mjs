// SPDX-License-Identifier: MIT

/**
 * A warp that takes points P to points Q and what lies between along with them: multiquadrics with an affine part,
 * sqrt(d² + r²) for each point, r its distance to the nearest other one (Costa 2009, section 3.5.2, after Ruprecht and Müller
 * 1995).
 * @param {number[][]} from P, at least three that are not on one line
 * @param {number[][][]} to lists of Q: the same system is solved for all of them
 * @returns {(x: number, y: number, out: Float64Array) => void} writes x and y for each list
 */
export function multiquadric(from, to) {
  const count = from.length;
  const size = count + 3;
  const apart = (p, q) => (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2;
  const radii = from.map((p, i) => Math.min(...from.filter((_, j) => j !== i).map((q) => apart(p, q)))); // squared
  const rows = Array.from({ length: size }, (_, i) => {
    const row = new Float64Array(size + 2 * to.length);
    if (i < count) {
      const [x, y] = from[i];
      from.forEach((q, j) => (row[j] = Math.sqrt((x - q[0]) ** 2 + (y - q[1]) ** 2 + radii[j])));
      row.set([1, x, y], count);
      to.forEach((list, k) => row.set(list[i], size + 2 * k));
    } else from.forEach((q, j) => (row[j] = [1, q[0], q[1]][i - count]));
    return row;
  });
  const solved = solve(rows, size);
  const terms = 2 * to.length;
  return (x, y, out) => {
    for (let k = 0; k < terms; k++) out[k] = solved[count][k] + x * solved[count + 1][k] + y * solved[count + 2][k];
    for (let i = 0; i < count; i++) {
      const phi = Math.sqrt((x - from[i][0]) ** 2 + (y - from[i][1]) ** 2 + radii[i]);
      for (let k = 0; k < terms; k++) out[k] += phi * solved[i][k];
    }
  };
}

/**
 * Gauss and Jordan with pivots: the rows hold the matrix and, beside it, the right sides.
 * @returns {Float64Array[]} the solutions, by row
 */
function solve(rows, size) {
  for (let c = 0; c < size; c++) {
    let best = c;
    for (let r = c + 1; r < size; r++) if (Math.abs(rows[r][c]) > Math.abs(rows[best][c])) best = r;
    [rows[c], rows[best]] = [rows[best], rows[c]];
    const pivot = rows[c];
    for (let r = 0; r < size; r++) {
      if (r === c) continue;
      const factor = rows[r][c] / pivot[c];
      if (factor) for (let k = c; k < pivot.length; k++) rows[r][k] -= factor * pivot[k];
    }
  }
  return rows.map((row, i) => row.subarray(size).map((value) => value / row[i]));
}
