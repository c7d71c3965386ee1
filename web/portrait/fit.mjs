// SPDX-License-Identifier: MIT
// Fits the shape of a face to the landmarks in pictures of it: the positions of these landmarks on a head.
//
// A base head is known by the landmarks that the same detector finds in its own portrait, and by the places on its skin
// where they are seen (models/tools/portrait/make-points.mjs). So what the detector always gets wrong is wrong in both and
// falls out of the difference.
import { align, upright } from './align.mjs';
import { EYES, LIP_CORNERS, LOWER_LIP, OPPOSITE, STEADY, UPPER_LIP } from './landmarks.mjs';
import { ramp } from './surface.mjs';

/** The share of a difference in depth that is used: from one picture the detector only guesses it. */
const DEPTH = 0.6;
/**
 * Lips that are further apart than this share of the mouth's width are parted: such a mouth tells little of the one at rest.
 */
export const PARTED = 0.1;
const PARTED_TRUST = 0.45;
const TURNED = 0.3; // rad of yaw: beyond it a picture is one of the side
const ASKEW = [0.03, 0.11]; // rad of yaw: up to where the two sides may differ, and from where they may not
const MOST_FRONT = 0.42; // rad: what may still be the only picture

/**
 * @typedef {{at: (number[]|null)[], seen: number[][], cheeks: number[], face: number[], worn: string[], hair: number[],
 *   lit: number}} Points
 *   of a base head: of each landmark the place on its skin (mm; null: none), where the detector sees it (mm, laid onto
 *   the places), and the colour of its skin (linear); worn: beard, glasses; hair: its form (traits.mjs); lit: by how much its
 *   painted colour is darker than it is drawn
 */

/** Landmarks laid onto a base head. @param {number[][]} landmarks @param {Points} base */
export function laid(landmarks, base) {
  const which = STEADY.filter((i) => base.at[i]);
  const up = upright(landmarks);
  const onto = align(up, base.seen, which);
  const points = up.map(onto.apply);
  const [yaw, pitch] = onto.turn[2].map((x) => Math.asin(Math.max(-1, Math.min(1, x)))); // where in the picture the face looks
  return { points, turn: onto.turn, yaw, pitch };
}

/** Returns the difference from a base head's shape, root mean square in mm. */
export function unlikeness(landmarks, base) {
  const { points } = laid(landmarks, base);
  const which = STEADY.filter((i) => base.at[i]);
  const sum = which.reduce((total, i) => total + (points[i][0] - base.seen[i][0]) ** 2 +
    (points[i][1] - base.seen[i][1]) ** 2, 0);
  return Math.sqrt(sum / which.length);
}

/** Share of the mouth's width that lies between the lips. */
export function partedLips(landmarks) {
  const far = (a, b) => Math.hypot(landmarks[a][0] - landmarks[b][0], landmarks[a][1] - landmarks[b][1]);
  return far(13, 14) / far(78, 308);
}

/** Closed lips meet in the middle of their former opening; each lip moves its other rings along. */
function closeLips(points) {
  UPPER_LIP.at(-1).forEach((top, i) => {
    const bottom = LOWER_LIP.at(-1)[i];
    const half = [0, 1, 2].map((k) => (points[bottom][k] - points[top][k]) / 2);
    for (const ring of UPPER_LIP) points[ring[i]] = points[ring[i]].map((x, k) => x + half[k]);
    for (const ring of LOWER_LIP) points[ring[i]] = points[ring[i]].map((x, k) => x - half[k]);
  });
}

/**
 * Makes the two sides of a turned face alike: what the detector gets wrong of its depth shifts both sides the same way across
 * the picture, so that it falls out of their mean.
 * @param {{points: number[][], yaw: number}} look @param {Points} base @returns {number[][]}
 */
function evened({ points, yaw }, { seen }) {
  const share = ramp(ASKEW, Math.abs(yaw));
  if (!share) return points;
  const shifts = points.map((p, i) => p.map((x, k) => x - seen[i][k]));
  return points.map((p, i) => {
    const other = shifts[OPPOSITE[i]];
    return other ? p.map((x, k) => x + (share / 2) * ((k ? other[k] : -other[k]) - shifts[i][k])) : p;
  });
}

/**
 * The front alone tells the shape: where the detector sees the landmarks of a turned face says nothing of its depth
 * (tests/bench/sides.mjs). Pictures from the side bring skin.
 * @param {{landmarks: number[][]}[]} views the first is the front
 * @param {Points} base
 * @returns {{target: (number[]|null)[], views: object[], parted: boolean}} target: the place of each landmark on the new
 *   head, mm
 */
export function fitShape(views, base) {
  const all = views.map(({ landmarks }) => laid(landmarks, base));
  const points = evened(all[0], base);
  const parted = partedLips(views[0].landmarks) > PARTED;
  const target = base.at.map((at, i) => {
    if (!at) return null;
    const shift = points[i].map((x, k) => (x - base.seen[i][k]) * (k === 2 ? DEPTH : 1));
    return at.map((x, k) => x + shift[k]);
  });
  const mouth = new Set([...UPPER_LIP, ...LOWER_LIP, ...Object.values(LIP_CORNERS)].flat());
  const shut = points.map((p) => [...p]);
  const rest = base.seen.map((p) => [...p]);
  closeLips(shut);
  closeLips(rest);
  for (const i of mouth)
    if (target[i]) target[i] = base.at[i].map((x, k) => x + (shut[i][k] - rest[i][k]) * (parted ? PARTED_TRUST : 1) *
      (k === 2 ? DEPTH : 1));
  return { target, views: all, parted };
}

/** Whether a picture can be the front, or is one of the side. */
export const isFront = ({ yaw }) => Math.abs(yaw) < TURNED;
export const tooTurned = ({ yaw, pitch }) => Math.abs(yaw) > MOST_FRONT || Math.abs(pitch) > 0.5;

/**
 * Moves an eye as a rigid whole: ball, lids and margins keep their form, so that the lids still close.
 * @returns {{from: number[], to: number[], roll: number, scale: number}}
 */
export function eyeMoves(target, base) {
  const moves = {};
  const spans = Object.values(EYES).map(({ outer, inner }) => ({
    was: Math.hypot(base.at[outer][0] - base.at[inner][0], base.at[outer][1] - base.at[inner][1]),
    is: Math.hypot(target[outer][0] - target[inner][0], target[outer][1] - target[inner][1]),
  }));
  const scale = Math.max(0.88, Math.min(1.12, (spans[0].is + spans[1].is) / (spans[0].was + spans[1].was)));
  for (const [side, { outer, inner }] of Object.entries(EYES)) {
    const slant = (p) => Math.atan2(p[outer][1] - p[inner][1], Math.abs(p[outer][0] - p[inner][0]));
    const tilt = Math.max(-0.14, Math.min(0.14, slant(target) - slant(base.at)));
    moves[side] = {
      from: [0, 1, 2].map((k) => (base.at[outer][k] + base.at[inner][k]) / 2),
      to: [0, 1, 2].map((k) => (target[outer][k] + target[inner][k]) / 2),
      roll: side === 'left' ? tilt : -tilt, // about z, from x to y
      scale,
    };
  }
  return moves;
}

/**
 * Landmarks that say what form the skin has: not the lids, whose eye moves as a whole, nor the inner rings of the lips but
 * their middle.
 */
export function shapePoints(base) {
  const without = new Set([
    ...Object.values(EYES).flatMap(({ lower, upper, iris }) => [...lower, ...upper, ...iris]),
    ...[UPPER_LIP, LOWER_LIP].flatMap((rings) => rings.slice(1)).flat(),
    ...Object.values(LIP_CORNERS).flatMap((corner) => corner.slice(1)),
  ]);
  return base.at.flatMap((at, i) => (at && i < 468 && !without.has(i) ? [i] : []));
}

/** Points of the line where the lips touch: between the innermost rings. */
export const lipLine = (points) =>
  UPPER_LIP.at(-1).flatMap((top, i) => {
    const bottom = LOWER_LIP.at(-1)[i];
    return points[top] && points[bottom] ? [points[top].map((x, k) => (x + points[bottom][k]) / 2)] : [];
  });
