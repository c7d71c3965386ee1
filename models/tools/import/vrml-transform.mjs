// SPDX-License-Identifier: GPL-3.0-or-later
import { matrixOf, product } from './matrix.mjs';

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
