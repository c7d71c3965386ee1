// SPDX-License-Identifier: MIT
// Skin on which a base head wore glasses that the face does not: the shadows of their sides, where no picture is laid over
// them, give way to the colours about them.
import { eachTexel, smoothOver } from './surface.mjs';

const NEAR = [10, 15]; // mm: what is so near has their shadow, what is farther has not
const TEMPLE = [1, 5]; // mm outward of the eyes: lids keep what is painted on them
const ROUNDS = 24; // rounds of smoothing by which surrounding colours fill in
const LEAST = 1e-5;

/**
 * @param {Float32Array} position of the skin @param {Float32Array[]} worn positions @param {number} outer mm of the eyes' outer
 *   corners from the middle @returns {Float32Array} of each vertex 0 to 1
 */
export function underWorn(position, worn, outer) {
  const share = new Float32Array(position.length / 3);
  const points = worn.flatMap((list) => [...list]);
  for (let v = 0; v < share.length; v++) {
    let least = NEAR[1] ** 2;
    for (let i = 0; i < points.length; i += 3) {
      const dx = points[i] - position[3 * v];
      if (dx * dx >= least) continue;
      const [dy, dz] = [points[i + 1] - position[3 * v + 1], points[i + 2] - position[3 * v + 2]];
      least = Math.min(least, dx * dx + dy * dy + dz * dz);
    }
    const near = Math.min(1, Math.max(0, (NEAR[1] - Math.sqrt(least)) / (NEAR[1] - NEAR[0])));
    const aside = (Math.abs(position[3 * v]) - outer - TEMPLE[0]) / (TEMPLE[1] - TEMPLE[0]);
    share[v] = near * Math.min(1, Math.max(0, aside));
  }
  return share;
}

/** Colours of the vertices, as those about them have it where it was worn. @returns {Float32Array} */
export function bareColours(part, colours, share) {
  const known = Float32Array.from(share, (x) => (1 - x) ** 4);
  const all = smoothOver(part, known, ROUNDS);
  const mixed = [0, 1, 2].map((k) => smoothOver(part, known.map((w, v) => w * colours[3 * v + k]), ROUNDS));
  return colours.map((x, i) => {
    const v = Math.floor(i / 3);
    return share[v] && all[v] > LEAST ? x + share[v] * (mixed[i % 3][v] / all[v] - x) : x;
  });
}

/** The same in the texture. @param {Float32Array} bare of bareColours @param {(x: number) => number} coded of a linear value */
export function paintBare(part, { share, bare }, size, data, coded) {
  eachTexel(part, size, (corners) => corners.some((v) => share[v] > 0), (texel, corners, w) => {
    const of = (list, stride, k) => corners.reduce((sum, v, c) => sum + w[c] * list[stride * v + k], 0);
    const much = of(share, 1, 0);
    for (let k = 0; k < 3; k++) data[4 * texel + k] += much * (coded(of(bare, 3, k)) - data[4 * texel + k]);
  });
}
