// SPDX-License-Identifier: MIT
// What frames glasses in a picture have: dark ones are dark below the eyes and across the nose, where skin is bright.
import { lab } from './lab.mjs';
import { sample, toneOf } from './skin.mjs';

const PLACES = [6, 168, 197, 111, 340, 117, 346, 118, 347, 119, 348, 120, 349, 121, 350, 229, 449, 230, 450, 231, 451, 31, 261];
const REACH = 0.05; // of the eyes' distance, about each place
const DARKEST = 0.12; // share of what is seen
const DARK = 0.42; // of the skin's lightness

/** @param {object} picture @param {number[][]} landmarks of a face with glasses @returns {'dark'|'metal'} */
export function framesOf(picture, landmarks) {
  const reach = REACH * Math.hypot(...[0, 1].map((k) => landmarks[33][k] - landmarks[263][k]));
  const steps = [-1, -0.5, 0, 0.5, 1];
  const lights = PLACES.flatMap((i) => steps.flatMap((a) => steps.map((b) =>
    lab(sample(picture, landmarks[i][0] + a * reach, landmarks[i][1] + b * reach, [0, 0, 0]))[0]))).sort((a, b) => a - b);
  return lights[Math.floor(DARKEST * lights.length)] < DARK * lab(toneOf(picture, landmarks))[0] ? 'dark' : 'metal';
}
