// SPDX-License-Identifier: MIT
// The tones that a head's skin gets. Cheeks and forehead face the light, the rest of a face mostly turns away from it, and how
// much darker it is depends on the light: hard in one picture, flat in another, and of its own kind on a drawn head. So each
// of the two gets its own.
import { lab, unlab } from './lab.mjs';
import { toneRatio } from './sheen.mjs';
import { apartFrom, ramp } from './surface.mjs';

const LIT = 0.7; // share of cheeks and forehead in a skin's tone
const BRIGHTEST = 0.89; // linear, of its red: skin in an overexposed picture would be drawn white
// CIELAB: eight in ten official portraits are less colourful than `most` at a lightness, darker skin more so; what is more is
// mostly the camera's, or a flash's
const CHROMA = { light: [60, 66], most: [39, 34] };
const HUE = [0.55, 1.05]; // rad in CIELAB: of eight in ten official portraits; beyond it is the light's
const KEPT = { chroma: 0.45, hue: 0.35 }; // of the excess
const HARDER = 1.5; // and as much flatter may light become: a face that is lit from one side keeps no stripe
const NEAR = [9, 24]; // mm from cheeks and forehead: what is so near is lit as they are, what is farther as the rest

/** A tone between the two. @param {{cheeks: number[], face: number[]}} seen linear @returns {number[]} */
export const toneOfBoth = ({ cheeks, face }) => cheeks.map((x, k) => x ** LIT * face[k] ** (1 - LIT));

const pressed = (x, [low, high], kept) => (x > high ? high + (x - high) * kept : x < low ? low + (x - low) * kept : x);

const mostChroma = (light) => CHROMA.most[0] + ramp(CHROMA.light, light) * (CHROMA.most[1] - CHROMA.most[0]);

/** A tone of skin that can be drawn: neither overexposed, nor orange, nor pink or green of the light. */
export function within(tone) {
  const [l, a, b] = lab(tone);
  const [chroma, hue] = [Math.hypot(a, b), Math.atan2(b, a)];
  const [c, h] = [pressed(chroma, [0, mostChroma(l)], KEPT.chroma), pressed(hue, HUE, KEPT.hue)];
  const dull = c === chroma && h === hue ? tone : unlab([l, c * Math.cos(h), c * Math.sin(h)]);
  const most = Math.max(...dull);
  return most > BRIGHTEST ? dull.map((x) => (x * BRIGHTEST) / most) : dull;
}

/**
 * By what a base's skin is multiplied to be drawn as the picture's.
 * @param {{cheeks: number[], face: number[]}} seen linear, in the picture
 * @param {{cheeks: number[], face: number[]}} drawn the same of the base head @param {{was: number, is: number}} specular
 * @param {number} stops by which the skin is lighter than in the picture
 * @returns {{all: number[], lit: number[]}} of all skin, and on top of that of cheeks and forehead
 */
export function ratiosOf(seen, drawn, specular, stops = 0) {
  const [cheeks, face] = ['cheeks', 'face'].map((place) => {
    const tone = within(seen[place].map((x) => x * 2 ** stops));
    return toneRatio(tone, drawn[place], specular);
  });
  const lit = cheeks.map((x, k) => Math.min(HARDER, Math.max(1 / HARDER, x / face[k])));
  return { all: cheeks.map((x, k) => x ** LIT * face[k] ** (1 - LIT) * lit[k] ** -LIT), lit };
}

/**
 * How much each vertex is lit as cheeks and forehead are, 0 to 1.
 * @param {Float32Array} position of the skin @param {number[][]} places of cheeks and forehead
 */
export const litShare = (position, places) =>
  Float32Array.from({ length: position.length / 3 }, (_, v) => 1 - ramp(NEAR, apartFrom(places, position, v)));
