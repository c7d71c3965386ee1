// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Separates the inside of the mouth from the skin as the part `mouth`, because it is lit through the lips and not by the lamps.
 */
import { lipParameter } from './paint/paint-lips.mjs';
import { smoothstep } from '../lib/zones.mjs';

/** mm behind the line where the lips touch: in the middle, and towards the corners, where the cheeks are visible. */
const BEHIND_LIPS = { middle: 9, corner: 2 };

/** @returns {object[]} the skin and the mouth */
export function cutCavity(ctx, skin) {
  const { depth } = lipParameter(ctx);
  const { inMouth, s } = ctx.grid;
  const sum = (refs, of) => refs.reduce((all, [v, w]) => all + w * of(v), 0);
  // Depth of each vertex behind that border.
  const deeper = skin.refs.map((refs) => {
    const corner = smoothstep(0.45, 0.85, Math.abs(sum(refs, (v) => s[v])));
    const border = BEHIND_LIPS.middle + (BEHIND_LIPS.corner - BEHIND_LIPS.middle) * corner;
    return sum(refs, (v) => (inMouth[v] ? depth[v] : 0)) - border;
  });
  const pick = (name, wanted) => {
    const index = [];
    for (let t = 0; t < skin.index.length; t += 3) {
      const three = skin.index.slice(t, t + 3);
      const inside = three.reduce((all, v) => all + deeper[v], 0) > 0;
      if (inside === wanted) index.push(...three);
    }
    return subset(skin, name, index);
  };
  return [pick('skin', false), pick('mouth', true)];
}

/** The vertices that the triangles use. */
function subset(part, name, index) {
  const number = new Map();
  for (const v of index) if (!number.has(v)) number.set(v, number.size);
  const old = [...number.keys()];
  const first = new Map();
  const smooth = part.smooth
    ? old.map((v, i) => {
        const key = part.smooth[v];
        if (!first.has(key)) first.set(key, i);
        return first.get(key);
      })
    : null;
  const pairs = (values) => old.flatMap((v) => [values[v * 2], values[v * 2 + 1]]);
  return {
    ...part,
    name,
    refs: old.map((v) => part.refs[v]),
    position: Float64Array.from(old.flatMap((v) => [0, 1, 2].map((k) => part.position[v * 3 + k]))),
    uv: pairs(part.uv),
    ...(part.sourceUv ? { sourceUv: pairs(part.sourceUv) } : {}),
    index: index.map((v) => number.get(v)),
    smooth: smooth?.some((f, v) => f !== v) ? smooth : null,
    moves: [],
    turns: [],
  };
}
