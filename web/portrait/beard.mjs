// SPDX-License-Identifier: MIT
// A beard in a picture ends where the picture does, in the middle of a cheek or on the chin, and what is even about it would
// be taken for a shadow. So the skin there is the base's, up to where the beard begins.
import { LIP_CORNERS, LOWER_LIP, UPPER_LIP } from './landmarks.mjs';
import { inside, ramp, smoothOver } from './surface.mjs';

const DARK = [0.4, 0.65]; // of the skin's brightness: from certainly hair to certainly none
const PALE = [0.2, 0.45]; // less red than the skin by (logarithms): from no grey hair to certainly grey hair
// Below the mouth: the middle of the brightness, that of the darkest quarter, and the share of vertices that are as pale. Else
// it is a shadow, or hair that hardly differs from its skin. Of drawn faces without a beard none was below 0.52, 0.39 and above
// 0; with one, at least one figure lay beyond its bound on each of six.
const HAIRY = { bright: 0.34, quarter: 0.2, pale: 0.06 };
const UNLIKE = [0.1, 0.24]; // of a beard that is known of: less red, or darker, than the skin by (logarithms)
const LIPS = 1.5; // mm about them that are theirs
const BEGINS = 2; // rounds by which it extends beyond the dark area, where hair is thin


/**
 * @param {import('./fit.mjs').Points} base @param {object} part its skin @param {number[]} seen vertices that the picture shows
 * @param {(vertex: number) => number} brightness there, relative to the face's skin
 * @param {(vertex: number) => number} paleness there: how much less red than the face's skin (a difference of logarithms)
 * @param {boolean} [known] whether there is a beard, of whatever colour
 * @returns {Float32Array|null} the beard's share of each vertex, 0 to 1; null: no beard
 */
export function beardOf({ at }, part, seen, brightness, paleness, known = false) {
  const { position, vertices } = part;
  const lips = [LIP_CORNERS.right[0], ...UPPER_LIP[0], LIP_CORNERS.left[0], ...[...LOWER_LIP[0]].reverse()];
  const ring = lips.map((i) => at[i]).filter(Boolean);
  const [nose, mouth] = [at[2]?.[1], at[LOWER_LIP[0][4]]?.[1]];
  if (ring.length < 8 || nose === undefined || mouth === undefined) return null;
  const hair = new Float32Array(vertices);
  const chin = [];
  let pales = 0;
  for (const v of seen) {
    const [x, y] = position.subarray(3 * v, 3 * v + 2);
    if (y > nose || inside(ring, x, y) > -LIPS) continue;
    const [bright, pale] = [brightness(v), ramp(PALE, paleness(v))];
    hair[v] = Math.max(1 - ramp(DARK, bright), pale, known ? ramp(UNLIKE, -Math.log(bright + 0.01) / 2) : 0);
    if (y > mouth) continue;
    chin.push(bright);
    if (pale > 0.5) pales++;
  }
  chin.sort((a, b) => a - b);
  const isDark = chin[chin.length >> 1] <= HAIRY.bright || chin[chin.length >> 2] <= HAIRY.quarter;
  if (!chin.length || !(known || isDark || pales >= HAIRY.pale * chin.length)) return null;
  return smoothOver(part, hair, BEGINS).map((share, v) => Math.min(1, 2 * Math.max(hair[v] / 2, share)));
}
