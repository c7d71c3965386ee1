// SPDX-License-Identifier: GPL-3.0-or-later
/** Colour of the lips and of the inside of the mouth. */
import { hex, mix, ramp } from '../../lib/color.mjs';
import { MOUTH_CONTACT, MOUTH_OUTER } from '../../lib/hm08.mjs';
import { noise } from './noise.mjs';
import { smoothstep } from '../../lib/zones.mjs';

/**
 * For every base vertex `t`: 0 on the line where the lips touch, 1 on the outer contour, more on the skin (2
 * = far), and `depth`: mm behind the line of contact.
 */
export function lipParameter(ctx) {
  const { p, topology } = ctx;
  const t = new Float64Array(p.length / 3).fill(2);
  const depth = new Float64Array(p.length / 3);
  const gap = (a, b) =>
    Math.hypot(p[a * 3] - p[b * 3], p[a * 3 + 1] - p[b * 3 + 1], p[a * 3 + 2] - p[b * 3 + 2]);
  for (const loops of [topology.mouth.l, topology.mouth.r]) {
    for (let c = 0; c < loops[0].length; c++) {
      const column = loops.map((l) => l[c]);
      const arc = [0];
      for (let r = 1; r < column.length; r++) arc.push(arc[r - 1] + gap(column[r], column[r - 1]));
      const width = arc[MOUTH_CONTACT] - arc[MOUTH_OUTER];
      column.forEach((v, r) => {
        t[v] = Math.max(0, (arc[MOUTH_CONTACT] - arc[r]) / width);
        depth[v] = Math.max(0, arc[r] - arc[MOUTH_CONTACT]);
      });
    }
  }
  return { t, depth };
}

export function lipPaint(colour, q, t, depth, s, look) {
  const border = look.border + 0.035 * noise(q[0] / 1.6, q[1] / 1.6, q[2] / 1.6);
  const red = smoothstep(border + look.softness, border - look.softness, t);
  if (red <= 0) return colour;
  const stops = look.ramp.map(([at, text]) => [at, hex(text)]);
  let lip = ramp(stops, t);
  // Furrows run across the lip: noise that is fine along it, long across it.
  const furrow = noise(q[0] / 0.75, q[1] / 6, q[2] / 4) * 0.6 + noise(q[0] / 0.38 + 7, q[1] / 4, 3) * 0.4;
  const k = 1 + furrow * look.furrows * smoothstep(0.05, 0.3, t);
  lip = lip.map((x) => x * k);
  const toSkin = (1 - look.cover) * smoothstep(0.2, 1, t);
  lip = mix(lip, colour, toSkin);
  const inside = smoothstep(look.inside[0], look.inside[1], depth);
  lip = mix(lip, hex(look.insideColour), inside);
  // Towards the corners the red fades on the outside and deepens where the lips meet.
  const corner = smoothstep(0.82, 1, Math.abs(s));
  lip = lip.map((x) => x * (1 - look.cornerShade * corner));
  return mix(colour, lip, red * (1 - corner * smoothstep(0.15, 0.75, t)));
}
