// SPDX-License-Identifier: MIT
import { turned } from './influences.mjs';

/**
 * The deformation of protocol/head-model.md without a GPU: what the vertex shader does, for all vertices of a part.
 * @param {import('../model/model.mjs').Part} part
 * @param {ReturnType<import('./influences.mjs').influencesOf>} influences
 * @param {import('./influences.mjs').Drive} drive with the FAPs set
 * @returns {{position: Float32Array, normal: Float32Array}}
 */
export function deform(part, { normals, moves, turns }, { slotValues, angles, turns: axes, firstHeadTurn }) {
  const position = new Float32Array(part.position.length);
  const normal = new Float32Array(part.position.length);
  const flat = axes.map(({ axis }) => ({ axis, pivot: [0, 0, 0] }));
  for (let v = 0; v < part.vertices; v++) {
    const rest = part.position.subarray(3 * v, 3 * v + 3);
    const up = normals.subarray(3 * v, 3 * v + 3);
    let p = [...rest];
    let n = [...up];
    for (const { slot, delta, normal: change } of moves[v])
      for (let k = 0; k < 3; k++) {
        p[k] += slotValues[slot] * delta[k];
        n[k] += slotValues[slot] * change[k];
      }
    for (const { turn, weight } of turns[v]) {
      const angle = angles[turn] * weight;
      if (!angle) continue;
      if (turn < firstHeadTurn) {
        turned(rest, axes[turn], angle).forEach((value, k) => (p[k] += value - rest[k]));
        turned(up, flat[turn], angle).forEach((value, k) => (n[k] += value - up[k]));
      } else {
        p = turned(p, axes[turn], angle);
        n = turned(n, flat[turn], angle);
      }
    }
    position.set(p, 3 * v);
    const length = Math.hypot(...n) || 1;
    for (let k = 0; k < 3; k++) normal[3 * v + k] = n[k] / length;
  }
  return { position, normal };
}
