// SPDX-License-Identifier: GPL-3.0-or-later
/** What a breath moves: chest and shoulders rise, the throat and the neck stay. */
import { smoothstep } from '../../lib/zones.mjs';

/**
 * @param {{point: (spec: object) => number[], warp: (q: number[]) => number[]}} ctx
 * @returns {(q: number[]) => number} the share of the breath's shift at a point of skin or clothes
 */
export function breathing({ point, warp }) {
  const notch = point({ group: 'joint-l-clavicle' })[1];
  const shoulder = warp(point({ group: 'joint-l-shoulder' }));
  return ([x, y]) => {
    const chest = smoothstep(notch + 34, notch - 40, y);
    const shoulders = smoothstep(0.42 * shoulder[0], 0.85 * shoulder[0], Math.abs(x)) * smoothstep(notch + 90, notch + 40, y);
    return Math.max(chest, shoulders);
  };
}

/** Gives a part its shares, in 255ths. */
export function applyBreath(part, share) {
  const { position } = part;
  const shares = Array.from({ length: position.length / 3 }, (_, v) => Math.round(255 * share([...position.subarray(3 * v, 3 * v + 3)])));
  const vertices = shares.flatMap((value, v) => (value ? [v] : []));
  if (vertices.length) part.breath = { vertices, weights: vertices.map((v) => shares[v]) };
}
