// SPDX-License-Identifier: MIT
// The hair in a picture: whether there is some above the forehead, and its colour. Nothing is concluded
// from it about who the person is.
import { lab, luma } from './lab.mjs';
import { BROWS } from './landmarks.mjs';
import { sample, toneOf } from './skin.mjs';

const UP = 0.46; // of the face's height, from the forehead's landmark: a forehead ends below that
// of it above where the skin ends: there is hair, darkest at its roots, or what stands behind the head
const THICK = [0.03, 0.07, 0.11, 0.15];
const LONG = 0.34; // and as far up it is followed, for its lights, which roots have not
/** Beside the temples, of the face's height and width. */
const ASIDE = { rise: [0.55, 0.65, 0.75, 0.85, 0.95], from: 0.46, to: 0.92 };
const STEP = 0.025;
const WIDE = 0.3; // of the face's width, to either side of its middle
const BORDER = 0.02; // of the picture's width: beside the head there is what stands behind it
const BACKDROP = 8; // CIELAB: what differs less from it is that
const GRID = 24; // columns, and samples of each
const SKIN = 15; // CIELAB: what differs less from the skin, or
const SHADE = 9; // in hue and saturation with no more than this, is skin in another light
const ALIKE = 15; // CIELAB: the hair's own spread, of which
const GLOSS = 0.65; // its lightness counts so much
const LIT = 0.5; // share of it whose colour is told, for the rest lies in its own shadow; but of dark hair
const DARK = 22; // (lightness) only gloss is lighter
// CIELAB, rad: hair that is the roots' in another light; kept: the share of it whose colour is told
const LIGHTS = { darker: 12, lighter: 38, hue: 0.45, dull: 8, vivid: 1.5, kept: 0.35 };
const PINK = [75, 9]; // lightness and a* from which it is no hair, but shining skin or what stands behind it
const LEAST = { hair: 0.5, bare: 0.6 }; // shares of the columns

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
  /** Hair farther from the skin, as long as it is the same in another light. */
  const followed = (roots) => {
    const [l, a, b] = [0, 1, 2].map((k) => median(roots.map((one) => one[k])));
    const isSame = (c) => {
      const off = Math.abs(Math.atan2(c[2], c[1]) - Math.atan2(b, a));
      const isDull = Math.min(Math.hypot(a, b), Math.hypot(c[1], c[2])) < LIGHTS.dull;
      const isVivid = Math.hypot(c[1], c[2]) > LIGHTS.vivid * Math.hypot(a, b) + LIGHTS.dull / 2; // skin
      const isHue = isDull ? Math.hypot(c[1] - a, c[2] - b) < LIGHTS.dull : off < LIGHTS.hue;
      return c[0] > l - LIGHTS.darker && c[0] < l + LIGHTS.lighter && !isVivid && isHue;
    };
    const ways = [];
    for (let i = 0; i < GRID; i++) {
      const across = WIDE * ((2 * i) / (GRID - 1) - 1);
      ways.push(Array.from({ length: Math.ceil((UP + LONG) / STEP) }, (_, j) => at(top, j * STEP, across)));
    }
    const steps = Math.ceil((ASIDE.to - ASIDE.from) / STEP);
    for (const rise of ASIDE.rise) for (const sign of [-1, 1])
      ways.push(Array.from({ length: steps }, (_, j) => at(chin, rise, sign * (ASIDE.from + j * STEP))));
    return ways.flatMap((way) => {
      const out = [];
      for (const q of way.filter(inPicture)) {
        const one = looked(q);
        if (isSkin(one.colour)) continue;
        if (isBehind(q, one.colour) || !isSame(one.colour)) {
          if (out.length) break;
          continue;
        }
        out.push(one);
      }
      return out;
    });
  };
  const found = [];
  let [seen, bare] = [0, 0];
  for (let i = 0; i < GRID; i++) {
    const across = WIDE * ((2 * i) / (GRID - 1) - 1);
    const column = steps.map((up) => at(top, up, across)).filter(inPicture);
    if (column.length < GRID / 3) continue;
    seen++;
    const end = column.findIndex((q) => !isSkin(looked(q).colour));
    const above = end < 0 ? [] : THICK.map((t) => at(top, steps[end] + t, across)).filter(inPicture);
    const hairs = above.map((q) => ({ q, ...looked(q) }))
      .filter(({ q, colour }) => !isSkin(colour) && !isBehind(q, colour));
    if (hairs.length) found.push(...hairs);
    else bare++;
  }
  const none = { kind: 'unsure', colour: null };
  if (seen < GRID / 2) return none;
  if (bare > LEAST.bare * seen) return { ...none, kind: 'none' };
  const middle = [0, 1, 2].map((k) => median(found.map(({ colour }) => colour[k])));
  const isAlike = ([l, a, b]) => Math.hypot(GLOSS * (l - middle[0]), a - middle[1], b - middle[2]) < ALIKE;
  const alike = found.filter(({ colour }) => isAlike(colour));
  if (!alike.length || alike.length < LEAST.hair * found.length) return none;
  const farther = middle[0] < DARK ? [] : followed(alike.map(({ colour: one }) => one));
  const nearer = [alike, middle[0] < DARK ? 1 : LIT];
  const [all, share] = farther.length < alike.length ? nearer : [[...alike, ...farther], LIGHTS.kept];
  const lit = all.sort((a, b) => b.colour[0] - a.colour[0]).slice(0, Math.ceil(all.length * share));
  const colour = [0, 1, 2].map((k) => median(lit.map(({ linear }) => linear[k])));
  return lab(colour)[0] > PINK[0] && lab(colour)[1] > PINK[1] ? none : { kind: 'hair', colour };
}

const GREY = 14; // CIELAB: what is less colourful is black, grey or white hair
const BROWN = [0.26, 1.75]; // rad: hues of hair, from red to yellow
const VIVID = 58; // beyond it nothing grows

/** Whether hair has that colour by nature: a scarf or a hat may not. @param {number[]} colour linear */
export function isNatural(colour) {
  const [, a, b] = lab(colour);
  const [chroma, hue] = [Math.hypot(a, b), Math.atan2(b, a)];
  return chroma < GREY || (chroma < VIVID && hue > BROWN[0] && hue < BROWN[1]);
}

const SIDES = { rise: [0.5, 0.6, 0.7, 0.8], across: [0.52, 0.56, 0.6, 0.64] }; // of the face's height and width: above the ears
const FEW = 6; // places
const YELLOWER = 0.25; // rad

/** The colour of hair beside a bald crown, linear; null where there is none that differs from skin and backdrop. */
export function sideHairOf(picture, landmarks) {
  const [top, chin, right, left] = [10, 152, 234, 454].map((i) => landmarks[i]);
  const skin = lab(toneOf(picture, landmarks));
  const seen = SIDES.rise.flatMap((rise) => SIDES.across.flatMap((across) => [-across, across].map((far) =>
    [0, 1].map((k) => chin[k] + rise * (top[k] - chin[k]) + far * (left[k] - right[k])))))
    .filter(([x, y]) => x >= 0 && y >= 0 && x < picture.width && y < picture.height)
    .map(([x, y]) => ({ y, linear: sample(picture, x, y, [0, 0, 0]).slice() }));
  const hairs = seen.filter(({ y, linear }) => {
    const colour = lab(linear);
    const behind = [BORDER, 1 - BORDER].map((x) => lab(sample(picture, x * picture.width, y, [0, 0, 0])));
    const isDuller = Math.hypot(colour[1], colour[2]) < Math.hypot(skin[1], skin[2]);
    const isYellower = Math.atan2(colour[2], colour[1]) > Math.atan2(skin[2], skin[1]) + YELLOWER; // blond beside pale skin
    return (isDuller || isYellower) && differs(colour, skin) > SKIN && behind.every((one) => differs(one, colour) > BACKDROP);
  });
  return hairs.length < FEW ? null : [0, 1, 2].map((k) => median(hairs.map(({ linear }) => linear[k])));
}

const BROW = 0.06; // of the eyes' distance, about each landmark of a brow
const DARKER = 9; // CIELAB: a brow that differs less from the skin is hardly seen

/** The colour of the brows, linear; null where they hardly differ from the skin. */
export function browsOf(picture, landmarks) {
  const reach = BROW * Math.hypot(...[0, 1].map((k) => landmarks[33][k] - landmarks[263][k]));
  const steps = [-1, 0, 1];
  const seen = Object.values(BROWS).flat().flatMap((i) => steps.flatMap((a) => steps.map((b) => {
    const colour = sample(picture, landmarks[i][0] + a * reach, landmarks[i][1] + b * reach, [0, 0, 0]).slice();
    return { colour, light: luma(colour) };
  }))).sort((a, b) => a.light - b.light).slice(0, Object.values(BROWS).flat().length * 2);
  const colour = [0, 1, 2].map((k) => median(seen.map((one) => one.colour[k])));
  return differs(lab(colour), lab(toneOf(picture, landmarks))) < DARKER ? null : colour;
}

/** The middle of the light of hair's picture, linear. @param {ArrayLike<number>} linear by byte */
export function lightOf({ data }, linear) {
  const lights = [];
  for (let i = 0; i < data.length; i += 4)
    if (data[i + 3] > 127) lights.push(luma([linear[data[i]], linear[data[i + 1]], linear[data[i + 2]]]));
  return median(lights) ?? 0;
}

/**
 * Gives a picture of hair another colour: its own light and shade stay, as shares of their middle.
 * @param {{data: ArrayLike<number>}} image RGBA, changed in place @param {number[]} colour linear
 * @param {{linear: ArrayLike<number>, coded: (x: number) => number}} scale linear: by byte
 */
export function dye({ data }, colour, { linear, coded }) {
  const lightAt = (i) => luma([linear[data[i]], linear[data[i + 1]], linear[data[i + 2]]]);
  const middle = Math.max(0.002, lightOf({ data }, linear));
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
 * @param {number} [lower] mm by which hair begins lower
 * @returns {Float32Array} of each vertex, 0 to 1
 */
export function underHair(position, ears, gone = [], lower = 0) {
  const about = nearness(gone);
  return Float32Array.from({ length: position.length / 3 }, (_, v) => {
    const q = position.subarray(3 * v, 3 * v + 3);
    if (ears.some((ear) => Math.hypot(...ear.map((x, k) => (x - q[k]) / EAR[k])) < 1)) return 0;
    const behind = (q[1] - SCALP.slope * q[2] - SCALP.level + lower + SCALP.soft) / (2 * SCALP.soft);
    return Math.min(1, Math.max(0, behind, about(q)));
  });
}

/** How near places are to points: 1 at them, 0 far away. @param {ArrayLike<number>[]} lists @param {number[]} [reach] mm */
export function nearness(lists, reach = NEAR) {
  const cells = new Map();
  const keyOf = (q) => q.map((x) => Math.floor(x / reach[1]));
  for (const list of lists)
    for (let i = 0; i < list.length; i += 3) {
      const q = [list[i], list[i + 1], list[i + 2]];
      const key = keyOf(q).join();
      if (!cells.has(key)) cells.set(key, []);
      cells.get(key).push(q);
    }
  return ([x, y, z]) => {
    const [i, j, k] = keyOf([x, y, z]);
    let least = reach[1];
    for (const a of [-1, 0, 1])
      for (const b of [-1, 0, 1])
        for (const c of [-1, 0, 1])
          for (const q of cells.get([i + a, j + b, k + c].join()) ?? [])
            least = Math.min(least, Math.hypot(x - q[0], y - q[1], z - q[2]));
    return (reach[1] - least) / (reach[1] - reach[0]);
  };
}

const BEARD = [200, 199, 175, 201, 421, 210, 430, 211, 431, 170, 395, 169, 394, 165, 391, 92, 322];
const UNLIKE = 11; // CIELAB: what differs less from the face is skin

/** The colour of a beard or moustache, linear; null where the lower face differs little from the rest. */
export function beardColourOf(picture, landmarks) {
  const skin = lab(toneOf(picture, landmarks));
  const reach = BROW * Math.hypot(...[0, 1].map((k) => landmarks[33][k] - landmarks[263][k]));
  const steps = [-1, 0, 1];
  const seen = BEARD.flatMap((i) => steps.flatMap((a) => steps.map((b) =>
    sample(picture, landmarks[i][0] + a * reach, landmarks[i][1] + b * reach, [0, 0, 0]).slice())));
  const hairs = seen.filter((c) => differs(lab(c), skin) > UNLIKE);
  return hairs.length < seen.length / 4 ? null : [0, 1, 2].map((k) => median(hairs.map((c) => c[k])));
}
