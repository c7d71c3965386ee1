// SPDX-License-Identifier: GPL-3.0-or-later
/** The lobes of the ears, whose underside the base mesh cuts off level, become round. */
import { smoothstep } from '../lib/zones.mjs';

const WIDE = 15.5; // mm of a lobe, to which the following belong
const REACH = 20; // mm around a lobe
const HIGH = 14; // mm above its underside, up to which it changes
const RISE = 5; // mm by which it rises at both sides of its lowest place
const LOWEST = 0.5; // of its width, from the head outwards
const SINK = 1.5; // mm by which that place sinks
const ENDS = 2.5; // mm by which it rises in front and behind

/** @param {Float64Array} p all vertices @param {ArrayLike<number>} body flags of those of the skin @param {Record<string, number[]>} fdp */
export function roundLobes(p, body, fdp) {
  for (const [name, side] of [['10.5', 1], ['10.6', -1]]) {
    const lobe = fdp[name];
    const near = [];
    for (let v = 0; v < p.length / 3; v++)
      if (body[v] && Math.hypot(...lobe.map((x, k) => x - p[3 * v + k])) < REACH) near.push(v);
    const under = near.filter((v) => side * (p[3 * v] - lobe[0]) > 3 && p[3 * v + 1] < lobe[1] + 5);
    if (!under.length) continue;
    const width = Math.max(...under.map((v) => side * (p[3 * v] - lobe[0])));
    const zs = under.map((v) => p[3 * v + 2]);
    const [middle, half] = [(Math.min(...zs) + Math.max(...zs)) / 2, (Math.max(...zs) - Math.min(...zs)) / 2];
    for (const v of near) {
      const out = (side * (p[3 * v] - lobe[0])) / width;
      const low = 1 - smoothstep(0, HIGH, p[3 * v + 1] - lobe[1]);
      const across = Math.min(1, (out - LOWEST) / (1 - LOWEST));
      const along = Math.min(1.2, Math.abs(p[3 * v + 2] - middle) / half);
      p[3 * v + 1] += (width / WIDE) * low * smoothstep(-0.1, 0.15, out) * (RISE * across * across + ENDS * along * along - SINK);
    }
  }
}
