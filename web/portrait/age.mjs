// SPDX-License-Identifier: MIT
// Age on a skin: the lines of an old head's skin where the picture does not show the person's own, and the picture's own made
// deeper, which the even light on a head would flatten. How old somebody is, is asked: of retouched photographs neither lines
// nor networks tell it.
import { sweep } from './planes.mjs';

const BEGINS = 45; // years: until then skin is the picture's
const WHOLE = 75; // years from which lines are whole
const MOST = 1.5; // share of an old head's lines
const DEEPER = 0.8; // of the picture's own lines
const BENEATH = 0.65; // share of an old head's lines where the picture shows skin
const RELIEF = 2.4; // of the surface, as the lines of old skin are lit
const BROAD = [1 / 110, 1 / 38]; // of the picture's side: lines, and folds; what is broader is neither
const FOLDS = 0.3; // share of them
const LINE = [0.68, 1.18]; // what a line darkens, or lightens

/** @param {number|null} years @returns {number} how much of it there is, 0 to MOST */
export const ageing = (years) => Math.min(MOST, Math.max(0, ((years ?? 0) - BEGINS) / (WHOLE - BEGINS)));

/** By what a colour is to be multiplied so that its difference from those about it grows. @param {number} share of ageing */
export const deeper = (bright, about, share) =>
  Math.min(LINE[1], Math.max(LINE[0], ((bright + 1e-4) / (about + 1e-4)) ** (DEEPER * share)));

/** The relief of a skin of that age. @param {number} relief of a material */
export const reliefOf = (relief, share) => relief + Math.max(0, RELIEF - relief) * Math.min(1, share);

/** A running mean along rows, then columns. */
function blurred(values, width, height, reach) {
  const [rows, out] = [new Float32Array(values.length), new Float32Array(values.length)];
  sweep(values, rows, width, height, 1, width, reach);
  sweep(rows, out, height, width, width, 1, reach);
  return out;
}

/**
 * The lines of a skin's picture: of each texel the share of the light about it.
 * @param {{width: number, height: number, data: ArrayLike<number>}} texture RGBA @param {ArrayLike<number>} linear of a byte
 * @returns {{width: number, height: number, lines: Float32Array}}
 */
export function linesOf({ width, height, data }, linear) {
  const lights = Float32Array.from({ length: width * height }, (_, i) =>
    0.3 * linear[data[4 * i]] + 0.6 * linear[data[4 * i + 1]] + 0.1 * linear[data[4 * i + 2]]);
  const [near, far] = BROAD.map((share) => blurred(lights, width, height, Math.max(1, Math.round(width * share))));
  const lineAt = (x, i) => ((x + 0.01) / (near[i] + 0.01)) * ((near[i] + 0.01) / (far[i] + 0.01)) ** FOLDS;
  return { width, height, lines: lights.map((x, i) => Math.min(LINE[1], Math.max(LINE[0], lineAt(x, i)))) };
}

/**
 * Draws an old head's lines onto a skin: heads have their skins' pictures laid out alike.
 * @param {{width: number, height: number, data: Uint8ClampedArray}} skin @param {object} lines of linesOf
 * @param {{share: number, shown: Float32Array, bald: Float32Array}} where share: of ageing; shown: of each texel, how much of
 *   it a picture shows; bald: how much of it is scalp, where the old head has roots of hair
 * @param {{linear: ArrayLike<number>, coded: (x: number) => number}} codes
 */
export function drawLines({ width, height, data }, lines, { share, shown, bald }, { linear, coded }) {
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) {
      const from = Math.floor((y * lines.height) / height) * lines.width + Math.floor((x * lines.width) / width);
      const at = y * width + x;
      const factor = lines.lines[from] ** (share * (1 - (1 - BENEATH) * shown[at]) * (1 - bald[at]));
      if (factor !== 1) for (let k = 0; k < 3; k++) data[4 * at + k] = coded(Math.min(1, linear[data[4 * at + k]] * factor));
    }
}
