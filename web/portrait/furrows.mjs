// SPDX-License-Identifier: MIT
// Furrows and spots of old skin, where age puts them on every face: across the forehead, between the brows, beside and under
// the eyes, from the nose to the mouth and from there to the chin. Pictures of old people are retouched or evenly lit, and
// show less of them.
import { luma } from './lab.mjs';
import { OPPOSITE } from './landmarks.mjs';
import { eachTexel } from './surface.mjs';

const BEGINS = 58; // years
const WHOLE = 80; // years from which furrows are as deep as they get
const SPOTS = { cell: 8, share: 0.3, radius: [0.7, 2.1], colour: [0.8, 0.7, 0.58], from: 66, whole: 84 }; // mm, years
const LIGHTER = 0.4; // of its depth, that the skin above a furrow is lighter
const WIDER = 2.4; // as much wider that is
const UNEVEN = [7, 1.1]; // mm along which, and by which a furrow strays
const ENDS = 0.16; // of its length, over which it fades

const between = (a, b, share) => ({ a, b, share });
const row = (some, others, share) => some.map((a, i) => between(a, others[i], share));
const FOREHEAD = [104, 69, 108, 151, 337, 299, 333];
const ABOVE = [103, 67, 109, 10, 338, 297, 332];
const BROWS = [63, 105, 66, 9, 296, 334, 293];

/** Furrows by the landmarks that they pass, with half their width in mm and how much they darken. */
const MIDDLE = [
  { at: FOREHEAD, wide: 1, deep: 0.36 },
  { at: row(FOREHEAD, ABOVE, 0.48), wide: 1, deep: 0.32 },
  { at: row(FOREHEAD, ABOVE, 0.98), wide: 1, deep: 0.28 },
  { at: row(FOREHEAD, BROWS, 0.42), wide: 0.9, deep: 0.3 },
];
const RIGHT = [
  { at: [between(9, 107, 0.7), between(8, 55, 0.6), between(168, 193, 0.4)], wide: 0.9, deep: 0.34 },
  { at: [between(33, 143, 0.5), between(33, 143, 1.1)], wide: 0.6, deep: 0.3 },
  { at: [between(33, 111, 0.5), between(33, 116, 0.9)], wide: 0.7, deep: 0.3 },
  { at: [between(33, 156, 0.5), between(33, 139, 0.9)], wide: 0.7, deep: 0.28 },
  { at: [112, 26, 22, 23, 24, 110, 25], wide: 0.8, deep: 0.22 },
  { at: [128, 121, 120, 119, 118, 117], wide: 1.6, deep: 0.28 },
  { at: [between(129, 203, 0.5), 203, 206, 216, between(216, 212, 0.7)], wide: 1.6, deep: 0.42 },
  { at: [between(61, 57, 0.7), between(43, 202, 0.6), between(204, 210, 0.5)], wide: 1.3, deep: 0.38 },
];
const mirrored = (at) => (typeof at === 'number' ? OPPOSITE[at] : between(mirrored(at.a), mirrored(at.b), at.share));
const ALL = [...MIDDLE, ...RIGHT, ...RIGHT.map((one) => ({ ...one, at: one.at.map(mirrored) }))];

const grown = (years, from, whole) => Math.min(1, Math.max(0, ((years ?? 0) - from) / (whole - from)));
const wave = (x, y, z, phase) =>
  Math.sin(x + phase) * 0.5 + Math.sin(1.7 * y + 2.3 * phase) * 0.3 + Math.sin(2.3 * z - phase) * 0.2;

/** Furrows on a base head: pieces of lines, with how far along they are. @param {(number[]|null)[]} places of landmarks */
function linesOn(places) {
  const placeOf = (at) => {
    if (typeof at === 'number') return places[at];
    const [a, b] = [placeOf(at.a), placeOf(at.b)];
    return a && b && a.map((x, k) => x + at.share * (b[k] - x));
  };
  const all = ALL.map(({ at, wide, deep }, i) => ({ points: at.map(placeOf).filter(Boolean), wide, deep, phase: 2.4 * i }));
  return all.filter(({ points }) => points.length > 1).map((one) => {
    const [low, high] = [Math.min, Math.max].map((most) => [0, 1, 2].map((k) => most(...one.points.map((p) => p[k]))));
    return { ...one, reach: 3 * WIDER * one.wide + UNEVEN[1], low, high };
  });
}

/** How near a place is to a line: mm from it (above it: more than 0), and how much of it is there. */
function off({ points, phase }, q) {
  let [least, at, above] = [Infinity, 0, 0];
  for (let i = 1; i < points.length; i++) {
    const [a, b] = [points[i - 1], points[i]];
    const [x, y, z] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    const along = (q[0] - a[0]) * x + (q[1] - a[1]) * y + (q[2] - a[2]) * z;
    const t = Math.min(1, Math.max(0, along / (x * x + y * y + z * z + 1e-9)));
    const d = [q[0] - a[0] - t * x, q[1] - a[1] - t * y, q[2] - a[2] - t * z];
    const far = Math.hypot(...d);
    if (far >= least) continue;
    const side = Math.abs(x) > Math.abs(y) ? Math.sign(d[1]) : Math.sign(d[0]) * Math.sign(a[0] || 1);
    [least, at, above] = [far, (i - 1 + t) / (points.length - 1), side];
  }
  const stray = UNEVEN[1] * wave(q[0] / UNEVEN[0], q[1] / UNEVEN[0], q[2] / UNEVEN[0], phase);
  const share = Math.min(1, at / ENDS, (1 - at) / ENDS) * (0.75 + 0.25 * wave(q[0] / 5, q[1] / 5, 0, phase));
  return { mm: above * least + stray, share };
}

/** Numbers of 0..1 for a cell of space. */
const dice = (i, j, k, n) => {
  const x = Math.sin(i * 127.1 + j * 311.7 + k * 74.7 + n * 53.3) * 43758.5453;
  return x - Math.floor(x);
};

/** How much of a spot a place has. */
function spotAt(q) {
  const cell = q.map((x) => Math.floor(x / SPOTS.cell));
  if (dice(...cell, 0) > SPOTS.share) return 0;
  const [low, high] = SPOTS.radius;
  const radius = low + (high - low) * dice(...cell, 1) ** 2;
  const middle = cell.map((x, k) => (x + 0.3 + 0.4 * dice(...cell, 2 + k)) * SPOTS.cell);
  const far = Math.hypot(...q.map((x, k) => x - middle[k])) * (1 + 0.25 * wave(2 * q[0], 2 * q[1], 2 * q[2], radius));
  return (0.4 + 0.6 * dice(...cell, 6)) * Math.min(1, Math.max(0, (1.25 * radius - far) / (0.5 * radius)));
}

/**
 * Draws furrows and spots of an age onto a skin.
 * @param {{width: number, height: number, data: Uint8ClampedArray}} skin
 * @param {{position: Float32Array, uv: Float32Array, index: Uint16Array}} mesh
 * @param {(number[]|null)[]} places of landmarks on it @param {number|null} years
 * @param {{linear: ArrayLike<number>, coded: (x: number) => number}} codes
 */
export function drawFurrows({ width, height, data }, { position, uv, index }, places, years, { linear, coded }) {
  const [deep, spotted] = [grown(years, BEGINS, WHOLE), grown(years, SPOTS.from, SPOTS.whole)];
  if (!deep) return;
  const lines = linesOn(places);
  eachTexel({ uv, index }, [width, height], () => true, (texel, corners, w) => {
    const q = [0, 1, 2].map((k) => corners.reduce((sum, v, c) => sum + w[c] * position[3 * v + k], 0));
    let factor = 1;
    for (const one of lines) {
      const { low, high, reach } = one;
      const beside = q[0] < low[0] - reach || q[0] > high[0] + reach || q[1] < low[1] - reach || q[1] > high[1] + reach;
      if (beside || q[2] < low[2] - reach) continue;
      const { mm, share } = off(one, q);
      if (share <= 0) continue;
      const valley = Math.exp(-0.5 * (mm / one.wide) ** 2);
      const ridge = Math.exp(-0.5 * ((mm - WIDER * one.wide) / (WIDER * one.wide)) ** 2);
      factor *= 1 - deep * one.deep * share * (valley - LIGHTER * ridge * 0.5);
    }
    const spot = spotted && spotted * spotAt(q);
    if (factor === 1 && !spot) return;
    const colour = [0, 1, 2].map((k) => linear[data[4 * texel + k]]);
    const red = factor < 1 ? (1 - factor) * 0.35 : 0; // blood shows in a furrow
    const light = luma(colour);
    colour.forEach((x, k) => {
      const furrowed = x * factor + (k === 0 ? red * 0.2 * light : 0);
      data[4 * texel + k] = coded(Math.min(1, furrowed * (1 - spot * (1 - SPOTS.colour[k]))));
    });
  });
}
