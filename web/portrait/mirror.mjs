// SPDX-License-Identifier: MIT
// What a face before a camera does, as FAPs: how its landmarks have moved since it was at rest, in units that are the face's
// own.
import { AU, clampFap, faps as table } from '../../protocol/fap.mjs';
import { align, upright } from './align.mjs';
import { PARTED, partedLips } from './fit.mjs';
import { EYES, STEADY } from './landmarks.mjs';

const TURN_SEEN = 0.6; // of a turn: the detector flattens faces
const SHUT = 0.75; // of the lids' way down that the detector shows
const EYEBALL = 1.03; // radius of an eyeball by the diameter of an iris: 12 mm by 11.7 mm
const JAW_PER_LIP = 1.1; // way of the jaw by that of the lower lip, which follows it
const UPPER_SHARE = 0.75; // of the way on which lids meet
const GAZE_MOST = 0.5; // sine
const ASIDE = 0.08; // of the face's width: a nose that is further from its middle is turned
const LEAST = 0.01; // of the face's height: a smaller unit is no measure

/** Directions of a head: x to its left, y up, z forward. */
const [LEFT, RIGHT, UP, DOWN] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/** FAP, its landmarks (the mean counts), its direction and its unit. */
const MOVES = [
  [3, [152], DOWN, 'MNS'],
  // the lips' inner edges
  [4, [13], DOWN, 'MNS'], [5, [14], UP, 'MNS'], [8, [311, 310], DOWN, 'MNS'], [9, [81, 80], DOWN, 'MNS'],
  [10, [402, 318], UP, 'MNS'], [11, [178, 88], UP, 'MNS'],
  [6, [308], LEFT, 'MW'], [7, [78], RIGHT, 'MW'], [12, [308], UP, 'MNS'], [13, [78], UP, 'MNS'],
  // brows
  [31, [336, 285], UP, 'ENS'], [32, [107, 55], UP, 'ENS'], [33, [334, 282], UP, 'ENS'], [34, [105, 52], UP, 'ENS'],
  [35, [300, 276], UP, 'ENS'], [36, [70, 46], UP, 'ENS'], [37, [336, 285], RIGHT, 'ES'], [38, [107, 55], LEFT, 'ES'],
  // the lips' outer edges
  [51, [0], DOWN, 'MNS'], [52, [17], UP, 'MNS'], [55, [269, 270], DOWN, 'MNS'], [56, [39, 40], DOWN, 'MNS'],
  [57, [405, 321], UP, 'MNS'], [58, [181, 91], UP, 'MNS'],
  [53, [291], LEFT, 'MW'], [54, [61], RIGHT, 'MW'], [59, [291], UP, 'MNS'], [60, [61], UP, 'MNS'],
];
/** Lids: FAPs of the upper and the lower one, their middles, and the eye's corners and iris. */
const LIDS = [
  { upper: 19, lower: 21, at: [386, 374], yaw: 23, pitch: 25, eye: EYES.left },
  { upper: 20, lower: 22, at: [159, 145], yaw: 24, pitch: 26, eye: EYES.right },
];

/** Of each FAP: that of the other side, and whether a movement to the side changes its sign. */
const OTHER = new Map([
  [6, 7], [8, 9], [10, 11], [12, 13], [19, 20], [21, 22], [23, 24, -1], [25, 26], [31, 32], [33, 34], [35, 36], [37, 38],
  [49, 49, -1], [50, 50, -1], [53, 54], [55, 56], [57, 58], [59, 60],
].flatMap(([a, b, sign = 1]) => [[a, [b, sign]], [b, [a, sign]]]));

/** The face that a mirror shows. @param {Record<number, number>} faps */
export const mirrored = (faps) => Object.fromEntries(Object.entries(faps).map(([fap, value]) => {
  const [other, sign] = OTHER.get(Number(fap)) ?? [fap, 1];
  return [other, sign * value || 0];
}));

const mean = (points, list) => [0, 1].map((k) => list.reduce((sum, i) => sum + points[i][k], 0) / list.length);
const between = (points, a, b) => Math.hypot(points[a][0] - points[b][0], points[a][1] - points[b][1]);

/** How far the lids are apart. */
const opening = (points, { at: [upper, lower] }) => points[upper][1] - points[lower][1];

const irisWidth = (points, [, a, b, c, d]) => (between(points, a, c) + between(points, b, d)) / 2;

/** Whether a face may be at rest: it looks into the camera, with its lips closed. @param {number[][]} landmarks */
export function mayRest(landmarks) {
  const [nose, right, left] = [1, 234, 454].map((i) => landmarks[i][0]);
  return partedLips(landmarks) < PARTED && Math.abs(nose - (left + right) / 2) < ASIDE * Math.abs(left - right);
}

export class FaceReader {
  #rest;
  #steady; // landmarks that neither the jaw nor an expression moves
  #unit;

  /** @param {number[][]} landmarks of the face at rest, with its lips closed, looking into the camera */
  constructor(landmarks) {
    const points = upright(landmarks);
    const height = between(points, 10, 152);
    this.#rest = points;
    this.#steady = STEADY.filter((i) => points[i][1] > points[2][1]);
    const unit = (size) => Math.max(size, LEAST * height) / 1024;
    this.#unit = {
      MNS: unit(between(points, 2, 13)), MW: unit(between(points, 61, 291)), ES: unit(between(points, 468, 473)),
      ENS: unit(mean(points, [468, 473])[1] - points[2][1]),
    };
  }

  /** @param {number[][]} landmarks @returns {Record<number, number>} FAPs, whole, within their limits */
  read(landmarks) {
    const now = upright(landmarks);
    const { apply, turn } = align(now, this.#rest, this.#steady);
    const points = now.map(apply);
    const out = {};
    for (const [fap, at, [x, y], unit] of MOVES) {
      const [a, b] = [points, this.#rest].map((all) => mean(all, at));
      out[fap] = ((a[0] - b[0]) * x + (a[1] - b[1]) * y) / this.#unit[unit];
    }
    out[3] = Math.max(out[3], -JAW_PER_LIP * out[5]); // beards and rounded chins hide the jaw
    const gaze = LIDS.map((lid) => this.#readEye(lid, points, out));
    // both eyes look at the same; that they cross is noise
    for (const k of [0, 1]) {
      const sum = gaze.reduce((all, { shift, open }) => [all[0] + open * shift[k], all[1] + open], [0, 1e-3]);
      const angle = Math.asin(Math.max(-GAZE_MOST, Math.min(GAZE_MOST, sum[0] / sum[1]))) / AU;
      for (const { yaw, pitch } of LIDS) out[k ? pitch : yaw] = k ? -angle : angle;
    }
    const forward = turn[2];
    out[48] = Math.asin(Math.max(-1, Math.min(1, -forward[1]))) / TURN_SEEN / AU;
    out[49] = Math.atan2(forward[0], forward[2]) / TURN_SEEN / AU;
    out[50] = Math.atan2(turn[0][1], turn[1][1]) / AU;
    return Object.fromEntries(Object.entries(out).map(([fap, value]) => [fap, limited(Number(fap), value)]));
  }

  /** Lids that meet close those of any head. @returns {{shift: number[], open: number}} of the iris, in radii of the eyeball */
  #readEye({ upper, lower, at, eye }, points, out) {
    const apart = Math.max(opening(this.#rest, { at }), 1e-3);
    const shut = Math.min(1, (1 - opening(points, { at }) / apart) / SHUT);
    out[upper] = 1024 * shut * (shut > 0 ? UPPER_SHARE : 1);
    out[lower] = 1024 * shut * (shut > 0 ? 1 - UPPER_SHARE : 0);
    const middle = (all) => mean(all, [eye.outer, eye.inner]).map((x, k) => all[eye.iris[0]][k] - x);
    const [now, rest] = [points, this.#rest].map(middle);
    const radius = Math.max(EYEBALL * irisWidth(this.#rest, eye.iris), 1e-3);
    return { shift: now.map((x, k) => (x - rest[k]) / radius), open: Math.max(0, Math.min(1, 1 - 2 * shut)) };
  }
}

const limited = (fap, value) => (Number.isFinite(value) ? Math.round(clampFap(fap, value)) || 0 : 0);

const STILL_HERTZ = 1.5; // of the filter for a face that does not move,
const QUICK = 0.02; // and how much more per unit of speed: steps of the coder a second
const SPEED_HERTZ = 1;

/** Calms what trembles without delaying what moves. Casiez, Roussel, Vogel, 1 euro filter (CHI 2012). */
export class Calm {
  #last = null;
  #speeds = {};

  /** @param {number} time seconds @param {Record<number, number>} faps @returns {Record<number, number>} */
  take(time, faps) {
    const gone = this.#last && time - this.#last.time;
    if (!gone || gone <= 0 || gone > 1) {
      this.#last = { time, faps: { ...faps } };
      this.#speeds = {};
      return faps;
    }
    const share = (hertz) => 1 / (1 + 1 / (2 * Math.PI * hertz * gone));
    const next = {};
    for (const [fap, value] of Object.entries(faps)) {
      const before = this.#last.faps[fap] ?? value;
      const slow = this.#speeds[fap] ?? 0;
      const speed = slow + share(SPEED_HERTZ) * ((value - before) / gone / table[fap].quant_step - slow);
      this.#speeds[fap] = speed;
      next[fap] = before + share(STILL_HERTZ + QUICK * Math.abs(speed)) * (value - before);
    }
    this.#last = { time, faps: next };
    return Object.fromEntries(Object.entries(next).map(([fap, value]) => [fap, Math.round(value) || 0]));
  }
}
