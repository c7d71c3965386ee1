// SPDX-License-Identifier: GPL-3.0-or-later
/** Collars come to lie on the neck: cloth about it keeps only a part of its distance to the skin. */
import { smoothstep } from '../lib/zones.mjs';

const FALL = 45; // mm below the highest cloth, over which it goes back to its place
const MOST = 40; // mm: what is farther from the neck stays

/** @param {object} part the clothes @param {{p: Float64Array, inGroup: (name: string) => Uint8Array}} ctx @param {{gap: number, keep: number}} look gap: mm that stay; keep: the share of what is beyond it */
export function layCollar(part, { p, inGroup }, { gap, keep }) {
  const body = inGroup('body');
  let top = -Infinity;
  for (let i = 1; i < part.position.length; i += 3) top = Math.max(top, part.position[i]);
  const neck = [];
  for (let v = 0; v < p.length / 3; v++)
    if (body[v] && p[3 * v + 1] > top - FALL - MOST && p[3 * v + 1] < top + MOST) neck.push([p[3 * v], p[3 * v + 1], p[3 * v + 2]]);
  const position = Float64Array.from(part.position);
  for (let i = 0; i < position.length; i += 3) {
    const q = position.subarray(i, i + 3);
    const share = smoothstep(top - FALL, top - 0.3 * FALL, q[1]);
    if (!share) continue;
    const [skin, far] = nearest(neck, q);
    if (far <= gap || far > MOST) continue;
    const less = share * (1 - keep) * (far - gap) * (1 - smoothstep(0.6 * MOST, MOST, far));
    for (const k of [0, 2]) position[i + k] += (less * (skin[k] - q[k])) / far;
  }
  return { ...part, position };
}

function nearest(points, q) {
  let best = [null, Infinity];
  for (const point of points) {
    const far = Math.hypot(point[0] - q[0], point[1] - q[1], point[2] - q[2]);
    if (far < best[1]) best = [point, far];
  }
  return best;
}
