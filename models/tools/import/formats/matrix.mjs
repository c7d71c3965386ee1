// SPDX-License-Identifier: GPL-3.0-or-later
/** 4 x 4 matrices in column-major order, as in glTF and VRML. */
import { FileError } from '../limits.mjs';

const ONE = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function product(a, b) {
  return ONE.map((_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + a[(i % 4) + 4 * k] * b[k + 4 * Math.floor(i / 4)], 0));
}

/** Makes a matrix from translation, rotation (a quaternion) and scale, or from a matrix. */
export function matrixOf({ matrix, translation = [0, 0, 0], rotation = [0, 0, 0, 1], scale = [1, 1, 1] }, place) {
  const right = (list, count) => Array.isArray(list) && list.length === count && list.every(Number.isFinite);
  if (matrix !== undefined) {
    if (!right(matrix, 16)) throw new FileError(`${place}.matrix`, 'must be 16 numbers');
    return matrix;
  }
  if (!right(translation, 3) || !right(rotation, 4) || !right(scale, 3)) throw new FileError(place, 'translation, rotation and scale must be 3, 4 and 3 numbers');
  const [x, y, z, w] = rotation;
  const axes = [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
  return [...axes.flatMap((axis, k) => [...axis.map((value) => value * scale[k]), 0]), ...translation, 1];
}

/** Tells whether the matrix mirrors, which reverses the winding. */
export function mirrors(m) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) + m[8] * (m[1] * m[6] - m[2] * m[5]) < 0;
}

/** Transforms directions, without the translation. */
export function linear(m, p) {
  const out = new Float64Array(p.length);
  for (let i = 0; i < p.length; i += 3) for (let k = 0; k < 3; k++) out[i + k] = m[k] * p[i] + m[4 + k] * p[i + 1] + m[8 + k] * p[i + 2];
  return out;
}

export function apply(m, p) {
  return linear(m, p).map((value, i) => value + m[12 + (i % 3)]);
}

function turn([x, y, z, angle]) {
  const length = Math.hypot(x, y, z) || 1;
  const s = Math.sin(angle / 2) / length;
  return [x * s, y * s, z * s, Math.cos(angle / 2)];
}

/** T C R SR S -SR -C (ISO/IEC 14772-1, 6.52). @param {object} fields of a Transform @param {string} at its place in the file */
export function vrmlTransform({ translation, center = [0, 0, 0], rotation = [0, 0, 1, 0], scale, scaleOrientation = [0, 0, 1, 0] }, at) {
  const back = ([x, y, z, angle]) => [x, y, z, -angle];
  return [
    { translation }, { translation: center }, { rotation: turn(rotation) }, { rotation: turn(scaleOrientation) }, { scale },
    { rotation: turn(back(scaleOrientation)) }, { translation: center.map((x) => -x) },
  ].map((one) => matrixOf(one, at)).reduce(product);
}
