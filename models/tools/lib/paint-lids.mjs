// SPDX-License-Identifier: GPL-3.0-or-later
/** Colour of the lids: the wet rim, the line of the lashes, the lid's own tone. */
import { hex, mix } from './color.mjs';
import { EYE_MARGIN } from './hm08.mjs';
import { lidMargin } from './neutral.mjs';
import { nearestOnLine, smoothstep } from './zones.mjs';

export function eyeLines(ctx) {
  const { p, topology, eyes } = ctx;
  return ['l', 'r'].map((side) => {
    const { upper } = lidMargin(topology.eye[side], p);
    const line = (ring) => topology.eye[side][ring].map((v) => [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]]);
    return {
      centre: eyes[side],
      radius: eyes.radius,
      margin: line(EYE_MARGIN),
      rim: line(EYE_MARGIN + 2),
      upper: upper.map((u) => [u ? 1 : 0]),
    };
  });
}

export function lidPaint(colour, q, lids, look) {
  for (const eye of lids) {
    const dx = q[0] - eye.centre[0],
      dy = q[1] - eye.centre[1],
      dz = q[2] - eye.centre[2];
    const far = Math.sqrt(dx * dx + dy * dy + dz * dz);
    if (far > eye.radius + look.toneReach + 4) continue;
    const near = nearestOnLine(eye.margin, eye.upper, q, true);
    const upper = near.value[0];
    const inside =
      near.distance < 6 && nearestOnLine(eye.rim, eye.upper, q, true).distance < near.distance * 0.8;
    let c = mix(colour, look.tone, look.toneStrength * smoothstep(look.toneReach, 0.5, near.distance));
    const line = upper > 0.5 ? look.upperLine : look.lowerLine;
    c = mix(c, hex(look.lineColour), line * smoothstep(look.lineWidth, 0.1, near.distance));
    if (inside || far < eye.radius + 0.5) c = mix(c, look.rim, look.rimStrength);
    return c;
  }
  return colour;
}
