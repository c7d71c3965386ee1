// SPDX-License-Identifier: MIT
// The hair in a picture: whether there is some above the forehead, and its colour. Nothing is concluded
// from it about who the person is.
import { sample, toneOf } from './skin.mjs';

const UP = 0.46; // of the face's height, from the forehead's landmark: a forehead ends below that
const THICK = [0.02, 0.09]; // of it above where the skin ends: what is there is hair, or what stands behind the head
const WIDE = 0.3; // of the face's width, to either side of its middle
const BORDER = 0.02; // of the picture's width: beside the head there is what stands behind it
const BACKDROP = 8; // CIELAB: what differs less from it is that
const GRID = 24; // columns, and samples of each
const SKIN = 15; // CIELAB: what differs less from the skin, or
const SHADE = 9; // in hue and saturation with no more than this, is skin in another light
const ALIKE = 16; // CIELAB: the hair's own spread
const LEAST = { hair: 0.5, bare: 0.6 }; // shares of the columns

/** CIELAB (D65) of a linear colour. */
export function lab([r, g, b]) {
  const f = (t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116);
  const [x, y, z] = [
    f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505),
    f(0.2126 * r + 0.7152 * g + 0.0722 * b),
    f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089),
  ];
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

const differs = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

/**
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture RGBA @param {number[][]} landmarks
 * @returns {{kind: 'hair'|'none'|'unsure', colour: number[]|null}} colour: linear; unsure: the picture ends at the
 *   forehead, or what is above it is neither skin nor of one colour
 */
export function hairOf(picture, landmarks) {
  const [top, chin, right, left] = [10, 152, 234, 454].map((i) => landmarks[i]);
  const up = [top[0] - chin[0], top[1] - chin[1]];
  const side = [left[0] - right[0], left[1] - right[1]];
  const at = (from, along, across) => [0, 1].map((k) => from[k] + along * up[k] + across * side[k]);
  const skin = lab(toneOf(picture, landmarks));
  const isSkin = (c) => {
    const d = c.map((x, k) => x - skin[k]);
    return Math.hypot(...d) < SKIN || (Math.hypot(d[1], d[2]) < SHADE && d[0] > -30 && skin[0] > 35);
  };
  const inPicture = ([x, y]) => x >= 0 && y >= 0 && x < picture.width && y < picture.height;
  const looked = ([x, y]) => {
    const linear = sample(picture, x, y, [0, 0, 0]).slice();
    return { linear, colour: lab(linear) };
  };
  const steps = Array.from({ length: GRID }, (_, j) => (UP * j) / (GRID - 1));
  const borders = (y) => [BORDER, 1 - BORDER].map((x) => looked([x * picture.width, y]).colour);
  const isBehind = ([, y], c) => borders(y).some((one) => differs(one, c) < BACKDROP);
  const found = [];
  let [seen, bare] = [0, 0];
  for (let i = 0; i < GRID; i++) {
    const across = WIDE * ((2 * i) / (GRID - 1) - 1);
    const column = steps.map((up) => at(top, up, across)).filter(inPicture);
    if (column.length < GRID / 3) continue;
    seen++;
    const end = column.findIndex((q) => !isSkin(looked(q).colour));
    const beyond = (t) => at(top, steps[end] + THICK[0] + t * (THICK[1] - THICK[0]), across);
    const above = end < 0 ? [] : [0, 0.5, 1].map(beyond).filter(inPicture);
    const hairs = above.map((q) => ({ q, ...looked(q) }))
      .filter(({ q, colour }) => !isSkin(colour) && !isBehind(q, colour));
    if (hairs.length) found.push(...hairs);
    else bare++;
  }
  const none = { kind: 'unsure', colour: null };
  if (seen < GRID / 2) return none;
  if (bare > LEAST.bare * seen) return { ...none, kind: 'none' };
  const middle = [0, 1, 2].map((k) => median(found.map(({ colour }) => colour[k])));
  const alike = found.filter(({ colour }) => differs(colour, middle) < ALIKE);
  if (!alike.length || alike.length < LEAST.hair * found.length) return none;
  const colour = [0, 1, 2].map((k) => median(alike.map(({ linear }) => linear[k])));
  return { kind: 'hair', colour };
}

const luma = (c) => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];

/**
 * Gives a picture of hair another colour: its own light and shade stay, as shares of their middle.
 * @param {{data: ArrayLike<number>}} image RGBA, changed in place @param {number[]} colour linear
 * @param {{linear: ArrayLike<number>, coded: (x: number) => number}} scale linear: by byte
 */
export function dye({ data }, colour, { linear, coded }) {
  const lights = [];
  const lightAt = (i) => luma([linear[data[i]], linear[data[i + 1]], linear[data[i + 2]]]);
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 127) lights.push(lightAt(i));
  const middle = Math.max(0.002, median(lights) ?? 0);
  for (let i = 0; i < data.length; i += 4) {
    const share = (lightAt(i) / middle) ** 0.8;
    for (let k = 0; k < 3; k++) data[i + k] = coded(Math.min(1, colour[k] * share));
  }
}

const SCALP = { slope: 1.05, level: 60, soft: 12 }; // mm: what lies behind y = level + slope * z is under hair (models/heads)
const EAR = [20, 42, 26]; // mm from its middle, along the axes

const NEAR = [9, 15]; // mm from hair: what is so near has its roots, what is farther has not

/**
 * The skin under hair, whose painted roots another hair does not have.
 * @param {Float32Array} position @param {number[][]} ears their middles
 * @param {Float32Array[]} [gone] positions of hair that the head loses, with the roots around it
 * @returns {Float32Array} of each vertex, 0 to 1
 */
export function underHair(position, ears, gone = []) {
  const about = nearness(gone);
  return Float32Array.from({ length: position.length / 3 }, (_, v) => {
    const q = position.subarray(3 * v, 3 * v + 3);
    if (ears.some((ear) => Math.hypot(...ear.map((x, k) => (x - q[k]) / EAR[k])) < 1)) return 0;
    const behind = (q[1] - SCALP.slope * q[2] - SCALP.level + SCALP.soft) / (2 * SCALP.soft);
    return Math.min(1, Math.max(0, behind, about(q)));
  });
}

/** How near places are to points: 1 at them, 0 far away. */
function nearness(lists) {
  const cells = new Map();
  const keyOf = (q) => q.map((x) => Math.floor(x / NEAR[1]));
  for (const list of lists)
    for (let i = 0; i < list.length; i += 3) {
      const q = [list[i], list[i + 1], list[i + 2]];
      const key = keyOf(q).join();
      if (!cells.has(key)) cells.set(key, []);
      cells.get(key).push(q);
    }
  return ([x, y, z]) => {
    const [i, j, k] = keyOf([x, y, z]);
    let least = NEAR[1];
    for (const a of [-1, 0, 1])
      for (const b of [-1, 0, 1])
        for (const c of [-1, 0, 1])
          for (const q of cells.get([i + a, j + b, k + c].join()) ?? [])
            least = Math.min(least, Math.hypot(x - q[0], y - q[1], z - q[2]));
    return (NEAR[1] - least) / (NEAR[1] - NEAR[0]);
  };
}
