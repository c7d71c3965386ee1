// SPDX-License-Identifier: GPL-3.0-or-later
/** Colour of the lids: the wet rim, the line of the lashes, the lid's own tone. */
import { hex, mix } from '../../lib/color.mjs';
import { EYE_MARGIN } from '../../lib/hm08.mjs';
import { lidMargin } from '../neutral.mjs';
import { nearestOnLine, smoothstep } from '../../lib/zones.mjs';

const RIM_SHADE = 0.6; // of the lashes' colour

export function eyeLines(ctx) {
  const { p, topology, eyes } = ctx;
  return ['l', 'r'].map((side) => {
    const { upper } = lidMargin(topology.eye[side], p);
    const line = (ring) => topology.eye[side][ring].map((v) => [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]]);
    return {
      centre: eyes[side],
      radius: eyes.radius,
      margin: line(EYE_MARGIN),
      upper: upper.map((u) => [u ? 1 : 0]),
    };
  });
}

/** Position of each vertex of the base mesh relative to the lids' margin, in pairs of edge rings: 0 on it, 1 behind it, -1 in front of it and elsewhere. */
export function behindMargin({ p, topology }) {
  const out = new Float32Array(p.length / 3).fill(-1);
  for (const loops of Object.values(topology.eye))
    loops.forEach((loop, i) => loop.forEach((v) => (out[v] = Math.min(1, Math.max(-1, (i - EYE_MARGIN) / 2)))));
  return out;
}

/** @param {number} behind of behindMargin: by position alone a deep fold of the lid would be mistaken for its margin or inside */
export function lidPaint(colour, q, behind, lids, look) {
  for (const eye of lids) {
    const dx = q[0] - eye.centre[0],
      dy = q[1] - eye.centre[1],
      dz = q[2] - eye.centre[2];
    const far = Math.sqrt(dx * dx + dy * dy + dz * dz);
    if (far > eye.radius + look.toneReach + 4) continue;
    const near = nearestOnLine(eye.margin, eye.upper, q, true);
    const upper = near.value[0];
    let c = mix(colour, look.tone, look.toneStrength * smoothstep(look.toneReach, 0.5, near.distance));
    const line = (upper > 0.5 ? look.upperLine : look.lowerLine) * smoothstep(-0.5, -0.3, behind);
    c = mix(c, hex(look.lineColour), line * smoothstep(look.lineWidth, 0.1, near.distance));
    // The rim of the upper lid is seen where lids are shut, between its lashes: in their shade.
    const rim = mix(look.rim, hex(look.lineColour), RIM_SHADE * smoothstep(0.3, 0.7, upper));
    return mix(c, rim, look.rimStrength * smoothstep(0.35, 0.65, behind));
  }
  return colour;
}
