// SPDX-License-Identifier: MIT
// Computes what one FAP does to a part of a head, for code that learns how a face moves.
import { AU, faps } from '../../protocol/fap.mjs';
import { pastOf, turned } from '../element/head/mesh/influences.mjs';

/** x to the head's own left, y up, z forward. */
const DIRECTIONS = { up: [0, 1, 0], down: [0, -1, 0], left: [1, 0, 0], right: [-1, 0, 0], forward: [0, 0, 1] };

/** By number: the feature point that it moves, and whither, and whether it may be negative. */
export const FAPS = Object.fromEntries(faps.flatMap(({ number, fdp, unit, direction, bidirectional }) =>
  (number < 3 ? [] : [[number, { unit, point: fdp.split('/')[0], bidirectional, direction: DIRECTIONS[direction] ?? null }]])));

/** Returns the length of one unit of a FAP, in mm. */
export const unitLength = ({ fapu }, fap) => (FAPS[fap].unit === 'AU' ? AU : fapu[FAPS[fap].unit] / 1024);

/**
 * @param {import('../element/head/model/model.mjs').Part} part
 * @param {import('../element/head/model/model.mjs').Turn[]} turns of its head; those of the whole head are passed over
 * @param {number} fap not one of these @param {number} value of it
 * @param {number} mm that a unit of it means @returns {Float64Array} by how much each vertex goes, mm
 */
export function movedBy(part, turns, fap, value, mm) {
  const out = new Float64Array(part.position.length);
  for (const { fap: of, sign, from, vertices, deltas } of part.moves) {
    const amount = of === fap ? pastOf(value, sign, from) * mm : 0;
    if (!amount) continue;
    vertices.forEach((v, i) => {
      for (let k = 0; k < 3; k++) out[3 * v + k] += amount * deltas[3 * i + k];
    });
  }
  for (const { turn, vertices, weights, weight } of part.turns) {
    if (turns[turn].fap !== fap) continue;
    const by = (v, share) => {
      const p = [...part.position.subarray(3 * v, 3 * v + 3)];
      turned(p, turns[turn], value * turns[turn].radians * share).forEach((x, k) => (out[3 * v + k] += x - p[k]));
    };
    if (vertices) vertices.forEach((v, i) => by(v, weights[i]));
    else for (let v = 0; v < part.vertices; v++) by(v, weight);
  }
  return out;
}
