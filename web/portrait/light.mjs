// SPDX-License-Identifier: MIT
// The colour of the light in a picture, by the whites of the eyes and the mean of all its colours. The factors were learnt from
// photographs that were tinted at random (models/README.md). Light that is as good as white is left alone, because estimates of
// it err as much as it is off.
import { EYES } from './landmarks.mjs';
import { luma } from './lab.mjs';
import { coded, linear, sample } from './skin.mjs';

/** Of the logarithms of red and blue by green: factors of the eyes' whites and of the whole picture, and a constant. */
const LEARNT = [[0.265, 0.393, -0.308], [0.397, 0.46, 0.186]];
const WHITE = [0.2, 0.3]; // what is less is no colour: nineteen in twenty untinted photographs
const BETWEEN = [0.35, 0.5, 0.65]; // of the way from the iris to the eye's corner
const EACH = 97; // pixels: one in so many is looked at

/** The whites of the eyes, linear: the brighter half of what lies beside the irises. */
function whiteOf(picture, landmarks) {
  const seen = Object.values(EYES).flatMap(({ outer, inner, iris }) => [outer, inner].flatMap((corner) => {
    const [from, to, rim] = [iris[0], corner, iris[1]].map((i) => landmarks[i]);
    const far = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const radius = Math.hypot(rim[0] - from[0], rim[1] - from[1]);
    return BETWEEN.map((share) => {
      const t = (radius + (far - radius) * share) / far;
      return sample(picture, from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t, [0, 0, 0]).slice();
    });
  })).sort((a, b) => luma(b) - luma(a));
  const bright = seen.slice(0, seen.length >> 1);
  return [0, 1, 2].map((k) => bright.reduce((sum, c) => sum + c[k], 0) / bright.length);
}

const ratios = ([r, g, b]) => [r, b].map((x) => Math.log((x + 1e-4) / (g + 1e-4)));

/**
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture RGBA @param {number[][]} landmarks
 * @returns {number[]} by how much the light raises red, green (1) and blue
 */
export function tintOf(picture, landmarks) {
  const sum = [0, 0, 0];
  for (let i = 0; i + 2 < picture.data.length; i += 4 * EACH) for (let k = 0; k < 3; k++) sum[k] += linear[picture.data[i + k]];
  const [eyes, all] = [whiteOf(picture, landmarks), sum].map(ratios);
  const [red, blue] = LEARNT.map(([a, b, c], k) => {
    const found = a * eyes[k] + b * all[k] + c;
    return Math.exp(Math.sign(found) * Math.max(0, Math.abs(found) - WHITE[k]));
  });
  return [red, 1, blue];
}

const WHITE_LIT = 1e-3; // of a factor: less is nothing

/**
 * A view as white light would show it. @template {{picture: {data: ArrayLike<number>}, landmarks?: number[][]}} View
 * @param {View} view @returns {View} the same if its light is white, or its landmarks are not known
 */
export function inWhiteLight(view) {
  const { picture, landmarks } = view;
  if (!landmarks) return view;
  const tint = tintOf(picture, landmarks);
  if (tint.every((x) => Math.abs(x - 1) < WHITE_LIT)) return view;
  const bright = tint.reduce((sum, x, k) => sum + x * [0.2126, 0.7152, 0.0722][k], 0); // the picture stays as bright
  const tables = tint.map((x) => Uint8ClampedArray.from(linear, (value) => coded(Math.min(1, (value * bright) / x))));
  const data = Uint8ClampedArray.from(picture.data);
  for (let i = 0; i < data.length; i += 4) for (let k = 0; k < 3; k++) data[i + k] = tables[k][data[i + k]];
  return { ...view, picture: { width: picture.width, height: picture.height, data } };
}
