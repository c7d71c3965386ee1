// SPDX-License-Identifier: MIT

/**
 * How far a full breath moves each of its vertices (protocol/head-model.md, `breath`).
 * @param {ArrayLike<number>} weights 0 to 255, one for each vertex @param {number[]} shift mm, of a vertex with weight 255
 * @returns {number[]} mm, three for each vertex
 */
export const breathDeltas = (weights, shift) =>
  Array.from({ length: 3 * weights.length }, (_, i) => (shift[i % 3] * weights[Math.floor(i / 3)]) / 255);
