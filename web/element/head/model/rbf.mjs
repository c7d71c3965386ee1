// SPDX-License-Identifier: MIT
// Warps of space by radial basis functions: given points move to given targets, and the space between follows.
// The functions and why the system has a solution: Wendland, Scattered Data Approximation (2005), chapters 8 and 9.

export class WarpError extends Error {
  /** @param {number} point its number, or -1 @param {string} what is wrong with it */
  constructor(point, what) {
    super(point < 0 ? what : `point ${point}: ${what}`);
    this.point = point;
  }
}

export const MOST_POINTS = 2048; // the system is dense: n * n numbers, n * n * n / 3 multiplications

const LEAST_APART = 1e-9; // of the points' extent: nearer ones are one point
const LEAST_PIVOT = 1e-12;

/**
 * Kernels of the distance (in extents of the points), signed so that the system is positive definite beside an affine map.
 * biharmonic: smoothest in 3D for its first derivatives, with a kink at each point; triharmonic: no kink, swings further out;
 * thin-plate: between them.
 */
const KERNELS = {
  biharmonic: (r) => -r,
  'thin-plate': (r) => (r > 0 ? r * r * Math.log(r) : 0),
  triharmonic: (r) => r * r * r,
};

/** 1 at 0, 0 from `reach` on, two times differentiable (Wendland's phi 3,1). */
const local = (reach) => (r) => (r < reach ? (1 - r / reach) ** 4 * (4 * (r / reach) + 1) : 0);

/** Solves a x = b in place (rows of `width` numbers), with row pivots. @returns {number} the column that has none, or -1 */
function solve(a, n, b, width) {
  for (let column = 0; column < n; column++) {
    let best = column;
    for (let row = column + 1; row < n; row++)
      if (Math.abs(a[row * n + column]) > Math.abs(a[best * n + column])) best = row;
    if (!(Math.abs(a[best * n + column]) > LEAST_PIVOT)) return column;
    if (best !== column) {
      for (let k = 0; k < n; k++) [a[best * n + k], a[column * n + k]] = [a[column * n + k], a[best * n + k]];
      for (let k = 0; k < width; k++)
        [b[best * width + k], b[column * width + k]] = [b[column * width + k], b[best * width + k]];
    }
    for (let row = column + 1; row < n; row++) {
      const factor = a[row * n + column] / a[column * n + column];
      if (!factor) continue;
      for (let k = column; k < n; k++) a[row * n + k] -= factor * a[column * n + k];
      for (let k = 0; k < width; k++) b[row * width + k] -= factor * b[column * width + k];
    }
  }
  for (let row = n - 1; row >= 0; row--)
    for (let k = 0; k < width; k++) {
      let sum = b[row * width + k];
      for (let column = row + 1; column < n; column++) sum -= a[row * n + column] * b[column * width + k];
      b[row * width + k] = sum / a[row * n + row];
    }
  return -1;
}

function checkPoints(from, to, affine) {
  if (from.length % 3 || from.length !== to.length)
    throw new WarpError(-1, 'there must be three numbers for each point, before and after');
  const count = from.length / 3;
  if (count > MOST_POINTS) throw new WarpError(-1, `there are ${count} points, more than ${MOST_POINTS}`);
  if (count < (affine ? 4 : 1)) throw new WarpError(-1, `there must be at least ${affine ? 4 : 1} points, not ${count}`);
  for (let i = 0; i < from.length; i++)
    if (!Number.isFinite(from[i]) || !Number.isFinite(to[i])) throw new WarpError(Math.floor(i / 3), 'is not three numbers');
  return count;
}

/** The middle of the points, and how far the farthest is from it: the system is solved in these. */
function extent(points, count) {
  const middle = [0, 0, 0];
  for (let i = 0; i < 3 * count; i++) middle[i % 3] += points[i] / count;
  let size = 0;
  for (let i = 0; i < count; i++) size = Math.max(size, Math.hypot(...middle.map((value, k) => points[3 * i + k] - value)));
  return { middle, size: size || 1 };
}

/**
 * Makes a warp that moves each point of `from` to that of `to`, exactly (1e-6 of their extent) unless it is `smooth`.
 * @param {ArrayLike<number>} from three numbers a point, all different; not all in a plane when the warp is affine
 * @param {ArrayLike<number>} to as many
 * @param {{kernel?: 'biharmonic'|'thin-plate'|'triharmonic', affine?: boolean, smooth?: number, reach?: number}} [options]
 *   affine (true): far away, and where all points agree, it is an affine map; smooth (0 and more): tolerance at the
 *   points in exchange for a smoother surface; reach: distance (in the unit of the points) beyond which nothing moves; it
 *   implies that affine is false
 * @returns {{apply: (points: ArrayLike<number>, out?: Float32Array|Float64Array) => Float32Array|Float64Array,
 *   at: (point: ArrayLike<number>) => number[]}} apply: of many points, into `out` (which may be `points`)
 * @throws {WarpError} too few points, coincident points, points in one plane, values that are not numbers
 */
export function rbf(from, to, { kernel = 'biharmonic', reach, affine = !reach, smooth = 0 } = {}) {
  if (!Object.hasOwn(KERNELS, kernel)) throw new WarpError(-1, `there is no kernel "${kernel}"`);
  if (reach !== undefined && !(reach > 0)) throw new WarpError(-1, 'reach must be above 0');
  if (!(smooth >= 0)) throw new WarpError(-1, 'smooth must be 0 or more');
  if (!reach && !affine) throw new WarpError(-1, 'a warp without reach must be affine');
  const count = checkPoints(from, to, affine);
  const { middle, size } = extent(from, count);
  const phi = reach ? local(reach / size) : KERNELS[kernel];
  const places = Float64Array.from({ length: 3 * count }, (_, i) => (from[i] - middle[i % 3]) / size);
  const n = count + (affine ? 4 : 0);
  const matrix = new Float64Array(n * n);
  const weights = new Float64Array(3 * n);
  for (let i = 0; i < count; i++) {
    for (let j = 0; j < i; j++) {
      const r = Math.hypot(...[0, 1, 2].map((k) => places[3 * i + k] - places[3 * j + k]));
      if (r < LEAST_APART) throw new WarpError(i, `is where point ${j} is`);
      matrix[i * n + j] = matrix[j * n + i] = phi(r);
    }
    matrix[i * n + i] = phi(0) + smooth;
    if (affine)
      for (let k = 0; k < 4; k++)
        matrix[i * n + count + k] = matrix[(count + k) * n + i] = k < 3 ? places[3 * i + k] : 1;
    for (let k = 0; k < 3; k++) weights[3 * i + k] = to[3 * i + k] - from[3 * i + k];
  }
  if (solve(matrix, n, weights, 3) >= 0)
    throw new WarpError(-1, affine ? 'the points lie in one plane, or nearly' : 'the points are too near each other');

  const apply = (points, out = new Float32Array(points.length)) => {
    for (let i = 0; i < points.length; i += 3) {
      const x = (points[i] - middle[0]) / size;
      const y = (points[i + 1] - middle[1]) / size;
      const z = (points[i + 2] - middle[2]) / size;
      const shift = [0, 0, 0];
      for (let j = 0; j < count; j++) {
        const dx = x - places[3 * j];
        const dy = y - places[3 * j + 1];
        const dz = z - places[3 * j + 2];
        const value = phi(Math.sqrt(dx * dx + dy * dy + dz * dz));
        for (let k = 0; k < 3; k++) shift[k] += value * weights[3 * j + k];
      }
      if (affine)
        for (let k = 0, w = 3 * count; k < 3; k++)
          shift[k] += x * weights[w + k] + y * weights[w + 3 + k] + z * weights[w + 6 + k] + weights[w + 9 + k];
      for (let k = 0; k < 3; k++) out[i + k] = points[i + k] + shift[k];
    }
    return out;
  };
  return { apply, at: (point) => [...apply(point, new Float64Array(3))] };
}
