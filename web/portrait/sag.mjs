// SPDX-License-Identifier: MIT
// What age does to the form of a face and one picture from the front does not tell: upper lids and cheeks sink, folds deepen
// from the nose to the mouth and from there to the chin, jowls and bags under the eyes stand out, temples are hollow, and skin
// hangs under the chin. Small moves at landmarks, which fade with the distance; their sizes were set by eye on old faces.
import { EYES, LIP_CORNERS, LOWER_LIP, OPPOSITE, UPPER_LIP } from './landmarks.mjs';
import { apartFrom, ramp } from './surface.mjs';

const BEGINS = 56; // years
const WHOLE = 80; // years from which faces sink no more
const MOST = 5; // mm by which any place moves
const REACH = 3; // standard deviations: beyond it nothing moves
const MARGIN = [1.5, 5.5]; // mm from margins of lids and lips, which keep their form, so that they still close
const CHIN = 152;

/**
 * Moves on the right side: between which landmarks (and how far from the first), mm outward, up and forward, and standard
 * deviation, mm.
 */
const RIGHT = [
  // upper lids
  { at: [223, 223, 0], by: [0, -2.2, 1], wide: 4 },
  { at: [224, 224, 0], by: [0, -2.7, 1.2], wide: 4 },
  { at: [225, 113, 0.4], by: [0, -3, 1.1], wide: 4.5 },
  // bags, and the grooves below them
  { at: [230, 119, 0.3], by: [0, -0.6, 1.7], wide: 3.6 },
  { at: [229, 118, 0.3], by: [0, -0.6, 1.4], wide: 3.6 },
  { at: [120, 120, 0], by: [0, 0, -1.4], wide: 3 },
  { at: [119, 118, 0.4], by: [0, 0, -1.4], wide: 3 },
  // cheeks, and folds beside nose and mouth
  { at: [205, 205, 0], by: [0, -2.2, 2], wide: 7 },
  { at: [207, 207, 0], by: [0.6, -2, 1.8], wide: 6 },
  { at: [129, 203, 0.6], by: [0, 0, -1.7], wide: 2.6 },
  { at: [203, 206, 0.4], by: [0, 0, -2], wide: 2.6 },
  { at: [206, 216, 0.3], by: [0, 0, -2], wide: 2.8 },
  { at: [216, 212, 0.3], by: [0, 0, -1.7], wide: 2.8 },
  { at: [43, 202, 0.6], by: [0, 0, -1.7], wide: 2.6 },
  { at: [204, 210, 0.5], by: [0, 0, -2], wide: 3 },
  // jowls, and the jaw between them and the chin
  { at: [136, 150, 0.4], by: [2.4, -4, 0.8], wide: 7 },
  { at: [210, 169, 0.5], by: [1.1, -1.6, 1.6], wide: 6 },
  { at: [149, 176, 0.5], by: [-0.8, 1.6, -1.9], wide: 4.5 },
  { at: [139, 71, 0.4], by: [-3, 0, -1.3], wide: 9 }, // temples
];
const THROAT = { from: [0, -24, -24], by: [0, -3, 4], wide: 11 }; // mm from the chin

/** How far a face has sunk, 0 to 1. @param {number|null} years */
export const sunk = (years) => Math.min(1, Math.max(0, ((years ?? 0) - BEGINS) / (WHOLE - BEGINS)));

/** @param {(number[]|null)[]} places of landmarks on the base head */
function movesOn(places) {
  const sides = [1, -1].flatMap((side) => RIGHT.map(({ at: [a, b, share], by, wide }) => {
    const [from, to] = [a, b].map((i) => places[side > 0 ? i : OPPOSITE[i]]);
    const at = from && to && from.map((x, k) => x + share * (to[k] - x));
    return { at, by: [-side * by[0], by[1], by[2]], wide }; // the right side is that of x < 0
  }));
  const chin = places[CHIN];
  const throat = { at: chin && chin.map((x, k) => x + THROAT.from[k]), by: THROAT.by, wide: THROAT.wide };
  return [...sides, throat].filter(({ at }) => at);
}

/** The landmarks of all margins that close. */
const MARGINS = [
  ...Object.values(EYES).flatMap(({ outer, inner, lower, upper }) => [outer, inner, ...lower, ...upper]),
  ...UPPER_LIP.flat(), ...LOWER_LIP.flat(), ...Object.values(LIP_CORNERS).flat(),
];

/**
 * How age moves places of a base head.
 * @param {import('./fit.mjs').Points} base @param {number|null} years
 * @returns {((positions: Float32Array) => Float32Array)|null} mm along the axes by which each moves; null: it does not
 */
export function sagging({ at }, years) {
  const share = sunk(years);
  if (!share) return null;
  const moves = movesOn(at);
  const margins = MARGINS.map((i) => at[i]).filter(Boolean);
  return (positions) => {
    const out = new Float32Array(positions.length);
    for (let v = 0; v < positions.length / 3; v++) {
      const sum = [0, 0, 0];
      for (const { at: middle, by, wide } of moves) {
        const far = Math.hypot(...middle.map((x, k) => positions[3 * v + k] - x)) / wide;
        if (far < REACH) for (let k = 0; k < 3; k++) sum[k] += by[k] * Math.exp(-0.5 * far * far);
      }
      const length = Math.hypot(...sum);
      if (!length) continue;
      const much = share * Math.min(1, MOST / length) * ramp(MARGIN, apartFrom(margins, positions, v));
      for (let k = 0; k < 3; k++) out[3 * v + k] = much * sum[k];
    }
    return out;
  };
}
