// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Turns of the head: FAPs 48, 49 and 50. The weight is 1 above a plane through the throat and the nape, 0
 * some way below.
 */
import { raisedCosine } from '../../lib/zones.mjs';

const TURNS = [
  ['head_pitch', 48, [1, 0, 0]],
  ['head_yaw', 49, [0, 1, 0]],
  ['head_roll', 50, [0, 0, 1]],
];

/**
 * @returns {{turns: object[], weight: (x: number, y: number, z: number) => number}} for every vertex of every
 *   part
 */
export function headTurns(ctx, tuning) {
  const throat = ctx.point(tuning.throat),
    nape = ctx.point(tuning.nape);
  const slope = (nape[1] - throat[1]) / (nape[2] - throat[2]);
  const norm = Math.hypot(1, slope);
  const weight = (x, y, z) => raisedCosine(-(y - throat[1] - slope * (z - throat[2])) / norm / tuning.reach);
  return {
    turns: TURNS.map(([name, fap, axis]) => ({ name, fap, pivot: ctx.fdp['7.1'], axis, radians: 1e-5 })),
    weight,
  };
}
