// SPDX-License-Identifier: MIT
// A beard in a picture ends where the picture does, in the middle of a cheek or on the chin, and what is even about it would
// be taken for a shadow. So the skin there is the base's, up to where the beard begins.
import { LIP_CORNERS, LOWER_LIP, UPPER_LIP } from './landmarks.mjs';
import { inside, smoothOver } from './surface.mjs';

const DARK = [0.4, 0.65]; // of the skin's brightness: hair, and what is none
const HAIRY = 0.34; // the middle of it below the mouth: what is brighter is a shadow, or hair that hardly differs from its skin
const LIPS = 1.5; // mm about them that are theirs
const BEGINS = 2; // rounds by which it reaches beyond what is dark: hairs are thin there

/**
 * @param {import('./fit.mjs').Points} base @param {object} part its skin @param {number[]} seen vertices that the picture shows
 * @param {(vertex: number) => number} brightness there, of that of the face's skin
 * @returns {Float32Array|null} of each vertex how much it is the beard's, 0 to 1; null: there is none
 */
export function beardOf({ at }, part, seen, brightness) {
  const { position, vertices } = part;
  const lips = [LIP_CORNERS.right[0], ...UPPER_LIP[0], LIP_CORNERS.left[0], ...[...LOWER_LIP[0]].reverse()];
  const ring = lips.map((i) => at[i]).filter(Boolean);
  const [nose, mouth] = [at[2]?.[1], at[LOWER_LIP[0][4]]?.[1]];
  if (ring.length < 8 || nose === undefined || mouth === undefined) return null;
  const dark = new Float32Array(vertices);
  const chin = [];
  for (const v of seen) {
    const [x, y] = position.subarray(3 * v, 3 * v + 2);
    if (y > nose || inside(ring, x, y) > -LIPS) continue;
    const bright = brightness(v);
    const t = Math.min(1, Math.max(0, (bright - DARK[0]) / (DARK[1] - DARK[0])));
    dark[v] = 1 - t * t * (3 - 2 * t);
    if (y <= mouth) chin.push(bright);
  }
  if (!chin.length || chin.sort((a, b) => a - b)[chin.length >> 1] > HAIRY) return null;
  return smoothOver(part, dark, BEGINS).map((share, v) => Math.min(1, 2 * Math.max(dark[v] / 2, share)));
}
