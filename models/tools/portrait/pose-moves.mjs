// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * What a face does in a pose beyond what its head does in it: how much of the pose it is, and by how much each landmark goes elsewhere.
 * Both are seen by the same detector, the head in its own drawing, so that the detector's habits fall out.
 */
import { align, upright } from '../../../web/src/portrait/align.mjs';
import { laid } from '../../../web/src/portrait/fit.mjs';
import { EYES, LIP_CORNERS, LOWER_LIP, UPPER_LIP } from '../../../web/src/portrait/landmarks.mjs';

/** What no pose moves: bridge of the nose, corners of the eyes, temples. */
const STILL = '168 6 197 195 5 4 1 33 263 133 362 188 412 174 399 122 351 196 419 234 454 127 356'.split(' ').map(Number);
const AMOUNT = [0.3, 2.5];
const TREMBLE = 0.5; // mm: what is not much more is the detector's
const MOST = 5; // mm

/** The lips and the margins of the lids go where FAPs say, and nowhere else: so they close. */
export const BOUND = [...UPPER_LIP, ...LOWER_LIP, ...Object.values(LIP_CORNERS), ...Object.values(EYES).flatMap(({ outer, inner, lower, upper }) => [[outer, inner], lower, upper])].flat();
const bound = new Set([...BOUND, ...Object.values(EYES).flatMap(({ iris }) => iris)]);
export const FREE = Array.from({ length: 468 }, (_, i) => i).filter((i) => !bound.has(i));

/** Where the landmarks of a pose go from those of the neutral face, mm; the head may have moved. @returns {number[][]} x and y of each */
export function movesOf(neutral, pose, base) {
  const rest = laid(neutral, base).points;
  const up = upright(pose);
  const { apply } = align(up, rest, STILL);
  return up.map((p, i) => apply(p).slice(0, 2).map((x, k) => x - rest[i][k]));
}

/** The landmark on the other side of each. @param {(number[]|null)[]} at places on a head */
export function mirrorOf(at) {
  return at.map((p, i) => {
    if (!p) return i;
    let [best, least] = [i, Infinity];
    at.forEach((q, k) => {
      const far = q ? Math.hypot(p[0] + q[0], p[1] - q[1], p[2] - q[2]) : Infinity;
      if (far < least) [best, least] = [k, far];
    });
    return best;
  });
}

const mirrored = (moves, mirror) => moves.map((_, i) => [-moves[mirror[i]][0], moves[mirror[i]][1]]);
const between = (a, b) => a.map((p, i) => p.map((x, k) => (x + b[i][k]) / 2));

/** @returns {number} how many times the head's own pose comes nearest to the face's */
function amountOf(face, head) {
  let [both, own] = [0, 0];
  for (let i = 0; i < 468; i++)
    for (let k = 0; k < 2; k++) {
      both += face[i][k] * head[i][k];
      own += head[i][k] ** 2;
    }
  return Math.min(AMOUNT[1], Math.max(AMOUNT[0], both / (own || 1)));
}

/** What trembles is taken out, what cannot be is cut. */
function steadied([x, y]) {
  const size = Math.hypot(x, y);
  if (size <= TREMBLE) return [0, 0];
  const share = (1 - (TREMBLE / size) ** 2) * Math.min(1, MOST / size);
  return [x * share, y * share];
}

/**
 * @param {Map<string, {face: number[][], head: number[][]}>} seen of each pose what face and head do (movesOf)
 * @param {object} table poses.json's poses @param {number[]} mirror of mirrorOf
 * @returns {Map<string, {amount: number, rest: number[][]}>} rest: of each landmark what is left, mm; a pose and its mirror are the same
 */
export function restsOf(seen, table, mirror) {
  const out = new Map();
  for (const [name, { face, head }] of seen) {
    const other = table[name].mirror;
    const twin = other ? seen.get(other) : { face, head };
    const [f, h] = [[face, twin?.face], [head, twin?.head]].map(([own, its]) => (its ? between(own, mirrored(its, mirror)) : own));
    const amount = amountOf(f, h);
    const rest = f.map((p, i) => steadied(p.map((x, k) => x - amount * h[i][k])));
    out.set(name, { amount, rest });
    if (other && !seen.has(other)) out.set(other, { amount, rest: mirrored(rest, mirror) });
  }
  return out;
}
