// SPDX-License-Identifier: GPL-3.0-or-later
/** A beard of a day or two, painted: single short hairs, and the shade of those below the skin. */
import { hex, mix } from '../../lib/color.mjs';
import { smoothstep } from '../../lib/zones.mjs';
import { along } from '../hair/skull.mjs';
import { noise } from './noise.mjs';

const SOFT = 8; // mm in which it ends
const SOFT_ABOVE = [2.5, 14]; // mm, under the nose and on the cheeks
const UNEVEN = 4; // mm
const UNDER_CHIN = 34; // mm on the neck
const THIN = 0.5; // its share on the cheeks, of that on chin and upper lip
const SHADE = 0.5; // of its strength, between hairs

/**
 * @param {Record<string, number[]>} fdp @param {{colour: string, strength: number}|undefined} look
 * @returns {(colour: number[], q: number[], lip: number) => number[]} lip: 1 on the outer contour of the lips
 */
export function stubblePaint(fdp, look) {
  if (!look) return (colour) => colour;
  const hair = hex(look.colour);
  const [corner, ear] = [fdp['8.3'], fdp['10.5']];
  const top = [[0, fdp['9.15'][1] + 1], [corner[0] * 0.6, fdp['9.15'][1]], [corner[0] + 3, corner[1] + 9], [corner[0] + 22, corner[1] + 8], [ear[0], ear[1] + 18]];
  const low = fdp['2.10'][1] - UNDER_CHIN;
  return (colour, q, lip) => {
    const [x, y, z] = q;
    if (z < ear[2]) return colour;
    const blur = UNEVEN * noise(x / 6, y / 6, z / 6);
    const fade = along([[corner[0] * 0.6, SOFT_ABOVE[0]], [corner[0] + 12, SOFT_ABOVE[1]]], Math.abs(x));
    const inside = smoothstep(0, fade, along(top, Math.abs(x)) - y + (blur * fade) / SOFT) * smoothstep(0, 2 * SOFT, y - low + blur) * smoothstep(0, SOFT, z - ear[2] + blur);
    const share = inside * smoothstep(1.03, 1.2, lip);
    if (!share) return colour;
    const dense = 1 - (1 - THIN) * smoothstep(corner[0] - 6, corner[0] + 14, Math.abs(x));
    const strand = smoothstep(0.05, 0.6, noise(x / 0.5, y / 0.9, z / 0.7));
    return mix(colour, hair, look.strength * share * dense * (SHADE + (1 - SHADE) * strand));
  };
}
