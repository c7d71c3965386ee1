// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Tendons, collar bones, the hollow between them and the larynx: what is too fine for the mesh is painted as lit on an upright neck.
 */
import { diffuse } from '../../lib/shading.mjs';
import { MODELLED, neckRelief, neckShare } from '../body/neck.mjs';

const REACH = [0.75, 0.6, 0.8, 0.4]; // of sky and lamps, about the share that enters an open collar
const HOLLOW = 0.05; // darkening per mm of depth
const STEP = 0.5; // mm

/**
 * @param {object} ctx @param {{tendons?: number, collar?: number, larynx?: number}|undefined} spec relief in mm
 * @param {number} subsurface of the skin
 * @returns {(colour: number[], q: number[], normal: number[]) => number[]}
 */
export function neckPaint(ctx, spec, subsurface) {
  if (!spec) return (colour) => colour;
  const height = neckRelief(ctx, spec);
  const top = ctx.fdp['2.1'][1] - 12;
  return (colour, [x, y], n) => {
    if (y > top || n[2] < 0.05) return colour;
    const here = height(x, y);
    const slope = [height(x + STEP, y) - here, height(x, y + STEP) - here].map((rise) => rise / STEP);
    if (Math.abs(here) < 0.01 && Math.hypot(...slope) < 0.003) return colour;
    const bent = [n[0] - slope[0], n[1] - slope[1], n[2]];
    const length = Math.hypot(...bent);
    const [before, after] = [n, bent.map((value) => value / length)].map((normal) => diffuse('skin', subsurface, normal, REACH));
    const share = neckShare(ctx, y, n[2]);
    const deep = 1 + share * HOLLOW * Math.min(0, here);
    return colour.map((value, k) => value * deep * (1 + (1 - MODELLED) * share * ((after[k] / before[k]) ** (1 / 2.2) - 1)));
  };
}
