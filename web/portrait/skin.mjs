// SPDX-License-Identifier: MIT
// The skin of a head from pictures of a face. Each vertex of the base head has its place in a picture by the landmarks
// (whatever the face in it does, its landmarks are where they are), each texel lies between its vertices. Light is evened:
// what is slow in the picture's brightness is taken from the base, which is painted without a lamp; what is fast, the face
// itself, is the picture's. Where no picture sees the skin, and outside the face, is the base's skin in the face's tone.
import { Normals } from '../element/head/mesh/normals.mjs';
import { rbf } from '../element/head/model/rbf.mjs';
import { deeper, drawLines } from './age.mjs';
import { bareColours, paintBare, underWorn } from './bare.mjs';
import { beardOf } from './beard.mjs';
import { drawFurrows } from './furrows.mjs';
import { BROWS, COUNT, EYES, LIP_CORNERS, LOWER_LIP, OVAL, SKIN, UPPER_LIP } from './landmarks.mjs';
import { luma } from './lab.mjs';
import { lipLine, PARTED, partedLips } from './fit.mjs';
import { surfaceOf } from './sheen.mjs';
import { apartFrom, eachTexel, inside, ramp, smoothOver, visible } from './surface.mjs';
import { litShare, ratiosOf, toneOfBoth } from './tone.mjs';

const EVEN = 0.8; // how much of the slow changes is the base's
const SLOW = 17; // mm: what is slower counts as light
const GAIN = [0.5, 2.2];
const RIM = [1, 17]; // mm inside the oval: where the picture begins, and is whole
const LASHES = [0.6, 2.6]; // mm from the lids' margins
const LID = [0.2, 0.7]; // of a lid's turn: skin that moves this much on closing is hidden or shaded while the eye is open
const FACING = [0.2, 0.55]; // cosine towards the picture
const BETWEEN = [1, 3.2]; // mm from where lips meet: of parted ones a picture shows the teeth there
const DARK = [0.5, 0.8]; // of the skin's brightness: hair that hangs into the forehead
const SHINE = [1.15, 0.35]; // factor over the surroundings from which skin is shiny, and the share of the excess that is kept

/** The linear value of a byte, and the byte of a linear value. */
export const linear = Float32Array.from({ length: 256 }, (_, i) =>
  (i <= 10 ? i / 255 / 12.92 : ((i / 255 + 0.055) / 1.055) ** 2.4));
export const coded = (x) => 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
const FAINT = 0.004; // darkness at which no colour can be measured
const redness = ([r, g, b]) => Math.log((r + FAINT) / (0.7 * g + 0.3 * b + FAINT));

/** Linear colour of a picture between its pixels. */
export function sample({ width, height, data }, u, v, out) {
  const x = Math.min(width - 1.001, Math.max(0, u - 0.5));
  const y = Math.min(height - 1.001, Math.max(0, v - 0.5));
  const [i, j] = [Math.floor(x), Math.floor(y)];
  const [fx, fy] = [x - i, y - j];
  const at = (j * width + i) * 4;
  for (let k = 0; k < 3; k++)
    out[k] =
      (linear[data[at + k]] * (1 - fx) + linear[data[at + 4 + k]] * fx) * (1 - fy) +
      (linear[data[at + width * 4 + k]] * (1 - fx) + linear[data[at + width * 4 + 4 + k]] * fx) * fy;
  return out;
}

const median = (numbers) => [...numbers].sort((a, b) => a - b)[Math.floor(numbers.length / 2)];
const medians = (colours) => [0, 1, 2].map((k) => median(colours.map((c) => c[k])));

/** The tone of the skin, linear: the middle of what is seen on cheeks and forehead. */
export function toneOf(picture, landmarks) {
  const spread = Math.max(1, Math.hypot(landmarks[234][0] - landmarks[454][0], landmarks[234][1] - landmarks[454][1]) / 60);
  return medians(SKIN.flatMap((i) => [-1, 0, 1].flatMap((a) =>
    [-1, 0, 1].map((b) => sample(picture, landmarks[i][0] + a * spread, landmarks[i][1] + b * spread, [0, 0, 0])))));
}

const FEATURES = new Set([
  ...UPPER_LIP.flat(), ...LOWER_LIP.flat(), ...Object.values(LIP_CORNERS).flat(), ...Object.values(BROWS).flat(),
  ...Object.values(EYES).flatMap(({ outer, inner, lower, upper, iris }) => [outer, inner, ...lower, ...upper, ...iris])]);
const NOSE = 2; // the landmark below it: a beard begins there

/** The colour of the whole face above the mouth, linear, as it is lit. */
export function wholeFace(picture, landmarks) {
  const [top, nose] = [landmarks[10], landmarks[NOSE]];
  const down = [nose[0] - top[0], nose[1] - top[1]];
  const along = (p) => ((p[0] - top[0]) * down[0] + (p[1] - top[1]) * down[1]) / (down[0] ** 2 + down[1] ** 2);
  return medians(landmarks.filter((p, i) => i < COUNT - 10 && !FEATURES.has(i) && along(p) < 1)
    .map(([x, y]) => sample(picture, x, y, [0, 0, 0])));
}

/** The tones of cheeks and forehead, and of the whole face above the mouth, linear. */
export const tonesOf = (picture, landmarks) => ({ cheeks: toneOf(picture, landmarks), face: wholeFace(picture, landmarks) });

/** Makes the test whether a point is on the lower lip: below the line where the lips touch. */
function lowerLip(base) {
  const line = lipLine(base.at).sort((a, b) => a[0] - b[0]);
  const [first, last] = [line[0], line.at(-1)];
  return (x, y) => {
    if (x <= first[0] || x >= last[0]) return y < (x <= first[0] ? first : last)[1];
    const i = line.findIndex((p) => p[0] > x);
    const [a, b] = [line[i - 1], line[i]];
    return y < a[1] + ((b[1] - a[1]) * (x - a[0])) / (b[0] - a[0]);
  };
}

/** Columns and rows of a picture for places on the base head. */
function placesIn(landmarks, base, positions, chosen) {
  const warp = (without) => {
    const out = new Set(without);
    const numbers = [];
    for (let i = 0; i < COUNT - 10; i++) {
      const at = base.at[i];
      if (at && !out.has(i) && !numbers.some((j) => Math.hypot(...at.map((x, k) => x - base.at[j][k])) < 0.3)) numbers.push(i);
    }
    return rbf(numbers.flatMap((i) => base.at[i]), numbers.flatMap((i) => [landmarks[i][0], landmarks[i][1], 0]), { kernel: 'biharmonic', smooth: 0.002 });
  };
  const isLower = lowerLip(base);
  const warps = [warp(LOWER_LIP.slice(1).flat()), warp(UPPER_LIP.slice(1).flat())];
  const out = new Float32Array((positions.length / 3) * 2);
  for (const v of chosen) {
    const place = positions.subarray(3 * v, 3 * v + 3);
    const [u, w] = warps[Number(isLower(place[0], place[1]))].at(place);
    out[2 * v] = u;
    out[2 * v + 1] = w;
  }
  return out;
}

/** Returns the share of each vertex's skin that a picture may supply, 0 to 1, by its position on the face. */
function maskOf(base, { position: positions, turns }, isLid) {
  const oval = OVAL.map((i) => base.at[i]).filter(Boolean);
  const eyes = Object.values(EYES).map(({ outer, lower, inner, upper }) =>
    [outer, ...lower, inner, ...[...upper].reverse()].map((i) => base.at[i]).filter(Boolean));
  const mask = new Float32Array(positions.length / 3);
  for (let v = 0; v < mask.length; v++) {
    const [x, y, z] = positions.subarray(3 * v, 3 * v + 3);
    if (z < -40) continue;
    const lids = Math.max(...eyes.map((eye) => inside(eye, x, y)));
    mask[v] = ramp(RIM, inside(oval, x, y)) * ramp(LASHES, -lids);
  }
  for (const { turn, vertices, weights } of turns) if (vertices && isLid(turn)) vertices.forEach((v, i) =>
    (mask[v] *= 1 - ramp(LID, weights[i])));
  return mask;
}

/** mm of each vertex from the line where the lips meet. */
function fromLipLine(base, position) {
  const line = lipLine(base.at).sort((a, b) => a[0] - b[0]);
  return Float32Array.from({ length: position.length / 3 }, (_, v) => {
    const p = position.subarray(3 * v, 3 * v + 3);
    return Math.min(...line.slice(1).map((b, i) => {
      const [a, ab] = [line[i], b.map((x, k) => x - line[i][k])];
      const along = ab.reduce((sum, x, k) => sum + x * (p[k] - a[k]), 0) / ab.reduce((sum, x) => sum + x * x, 1e-9);
      const t = Math.min(1, Math.max(0, along));
      return Math.hypot(...ab.map((x, k) => p[k] - a[k] - t * x));
    }));
  });
}

/** Low-pass filters colours on the skin: their weighted mean over some mm. */
function slowly(positions, colours, weights, chosen) {
  const sources = chosen.filter((v, i) => weights[v] > 0.3 && i % 3 === 0);
  const out = new Float32Array(colours.length);
  for (const v of chosen) {
    const sum = [0, 0, 0];
    let total = 1e-9;
    for (const s of sources) {
      const d = (positions[3 * v] - positions[3 * s]) ** 2 + (positions[3 * v + 1] - positions[3 * s + 1]) ** 2 +
        (positions[3 * v + 2] - positions[3 * s + 2]) ** 2;
      if (d > 9 * SLOW * SLOW) continue;
      const w = weights[s] * Math.exp(-d / (2 * SLOW * SLOW));
      total += w;
      for (let k = 0; k < 3; k++) sum[k] += w * colours[3 * s + k];
    }
    for (let k = 0; k < 3; k++) out[3 * v + k] = sum[k] / total;
  }
  return out;
}

/** A picture as the texture will have it: weights and gains by vertex. */
function layer({ picture, landmarks }, view, { base, part, normals, mask, tone, look, bearded }) {
  const { position, index } = part;
  const seen = visible(position, index, look, view.turn);
  const weight = new Float32Array(mask.length);
  const lips = partedLips(landmarks) > PARTED ? fromLipLine(base, position) : null;
  for (let v = 0; v < weight.length; v++) {
    const facing = [0, 1, 2].reduce((sum, k) => sum + view.turn[k][2] * normals[3 * v + k], 0);
    weight[v] = mask[v] && seen[v] ? mask[v] * ramp(FACING, facing) : 0;
  }
  const chosen = [...weight.keys()].filter((v) => mask[v] > 0);
  const places = placesIn(landmarks, base, position, chosen);
  const colours = new Float32Array(position.length);
  const bright = luma(tone.is);
  const top = base.at[9]?.[1] ?? 20;
  for (const v of chosen) {
    const c = sample(picture, places[2 * v], places[2 * v + 1], colours.subarray(3 * v, 3 * v + 3));
    if (position[3 * v + 1] > top) weight[v] *= ramp(DARK, luma(c) / bright);
  }
  const brightness = (v) => luma(colours.subarray(3 * v, 3 * v + 3)) / bright;
  const paleness = (v) => redness(tone.is) - redness(colours.subarray(3 * v, 3 * v + 3));
  const beard = beardOf(base, part, chosen.filter((v) => weight[v] > 0), brightness, paleness, bearded);
  beard?.forEach((share, v) => (weight[v] *= 1 - share));
  const soft = smoothOver(part, weight, 5);
  for (let v = 0; v < weight.length; v++) {
    weight[v] = Math.min(1, 1.15 * ramp([0.35, 0.95], soft[v]));
    if (lips) weight[v] *= ramp(BETWEEN, lips[v]);
  }
  const slow = slowly(position, colours, weight, chosen);
  return { picture, places, weight, colours, chosen, slow, bearded: Boolean(beard) };
}

/**
 * @param {{part: object, surface: object, texture: object, eyes: object[], worn: object[], base:
 *   import('./fit.mjs').Points, isLid: (turn: number) => boolean}} head part: the base's skin (model.mjs); surface: its
 *   material; texture: RGBA; eyes: parts that hide skin behind them; worn: glasses that the new head has not; isLid: whether
 *   a turn of the model closes an eye; scalp: what is painted on it in turn, the share of each vertex and a colour (none:
 *   the face's skin, as `bright` as it says); light: by how many stops the skin is lighter than in the picture;
 *   bearded: the face is known to have a beard; age: of ageing (age.mjs), by its years; lines: of
 *   an old head's skin (linesOf), or null
 * @param {{picture: object, landmarks: number[][]}[]} pictures the first is the front @param {object[]} views laid (fit.mjs)
 * @returns {{width: number, height: number, data: Uint8ClampedArray, tone: {was: number[], is: number[]}, bearded: boolean}}
 */
export function paintSkin(head, pictures, views) {
  const { part, surface, texture, eyes, worn, base, isLid } = head;
  const { scalp = [], light = 0, bearded = false, age = 0, years = null, lines = null } = head;
  const { position, uv, index } = part;
  const size = [texture.width, texture.height];
  let own = new Float32Array(position.length);
  for (let v = 0; v < part.vertices; v++) sample(texture, uv[2 * v] * size[0], (1 - uv[2 * v + 1]) * size[1],
    own.subarray(3 * v, 3 * v + 3));
  const outer = Math.max(...Object.values(EYES).map((eye) => Math.abs(base.at[eye.outer]?.[0] ?? 0)));
  const share = worn.length ? underWorn(position, worn.map((one) => one.position), outer) : null;
  if (share) own = bareColours(part, own, share);
  const seen = tonesOf(pictures[0].picture, pictures[0].landmarks);
  const tone = { was: skinTone(base, position, own), is: seen.cheeks, face: toneOfBoth(seen) };
  const mask = maskOf(base, part, isLid);
  const normals = new Normals(part).rest;
  const layers = pictures.map((one, i) =>
    layer(one, views[i], { base, part, normals, mask, tone: { ...tone, is: toneOf(one.picture, one.landmarks) },
    look: eyes, bearded }));
  // The base's drawn skin is known by the same measure: light adds to its texture.
  const specular = { was: surface.specular, is: surfaceOf(surface, tone.face, age).specular };
  const { all: ratio, lit } = ratiosOf(seen, base, specular, light);
  const isLit = litShare(position, SKIN.map((i) => base.at[i]).filter(Boolean));
  // The picture shows its own light, too: this much of its colour belongs to the texture.
  const unlit = tone.was.map((x, k) => (x * ratio[k]) / (tone.is[k] + 1e-4));
  const slowOwn = slowly(position, own, mask, layers[0].chosen);
  for (const one of layers) {
    one.gain = new Float32Array(position.length);
    for (const v of one.chosen)
      for (let k = 0; k < 3; k++) one.gain[3 * v + k] = unlit[k] * Math.min(GAIN[1],
        Math.max(GAIN[0], ((slowOwn[3 * v + k] * ratio[k]) / (unlit[k] * one.slow[3 * v + k] + 1e-4)) ** EVEN));
    // Evening the light shifts the tone: cheeks and forehead, where it is measured, are lit more than their surroundings.
    const wanted = skinTone(base, position, own, one.weight);
    const painted = one.colours.map((x, i) => x * one.gain[i]);
    for (const v of one.chosen) for (let k = 0, dull = dulled(one.colours, one.slow, v); k < 3; k++) painted[3 * v + k] *= dull;
    const got = wanted && skinTone(base, position, painted, one.weight);
    for (let i = 0; got && i < one.gain.length; i++) one.gain[i] *= (wanted[i % 3] * ratio[i % 3]) / (got[i % 3] + 1e-4);
    for (let i = 0; i < one.gain.length; i++) one.gain[i] *= lit[i % 3] ** isLit[Math.floor(i / 3)];
  }
  divide(layers);
  const data = new Uint8ClampedArray(texture.data);
  if (share) paintBare(part, { share, bare: own }, size, data, coded);
  const table = ratio.map((r) => Uint8ClampedArray.from({ length: 256 }, (_, i) => coded(linear[i] * r)));
  for (let i = 0; i < data.length; i += 4) for (let k = 0; k < 3; k++) data[i + k] = table[k][data[i + k]];
  eachTexel(part, size, (corners) => corners.some((v) => isLit[v] > 0), (texel, corners, w) => {
    const much = corners.reduce((sum, v, c) => sum + w[c] * isLit[v], 0);
    for (let k = 0; k < 3; k++) data[4 * texel + k] = coded(Math.min(1, linear[data[4 * texel + k]] * lit[k] ** much));
  });
  for (const { share: covered, colour, bright = 1 } of scalp) {
    const under = colour ?? tone.was.map((x, k) => x * ratio[k] * bright);
    paintBare(part, { share: covered, bare: Float32Array.from(position, (_, i) => under[i % 3]) }, size, data, coded);
  }
  const shown = paint(layers, { uv, index, size, age }, data);
  if (lines && age) {
    const bald = shares({ uv, index, size }, [...scalp.map(({ share: covered }) => covered), browShare(position, base.at)]);
    drawLines({ width: size[0], height: size[1], data }, lines, { share: age, shown, bald }, { linear, coded });
  }
  drawFurrows({ width: size[0], height: size[1], data }, part, base.at, years, { linear, coded });
  return { width: size[0], height: size[1], data, tone, bearded: layers.some((one) => one.bearded) };
}

const BROW = [4, 9]; // mm from its landmarks, where an old head's skin has its own

const browShare = (position, at) => {
  const places = Object.values(BROWS).flat().map((i) => at[i]).filter(Boolean);
  return Float32Array.from({ length: position.length / 3 }, (_, v) => 1 - ramp(BROW, apartFrom(places, position, v)));
};

/** The greatest of shares of the vertices, of each texel. @param {Float32Array[]} lists */
function shares({ uv, index, size }, lists) {
  const out = new Float32Array(size[0] * size[1]);
  for (const list of lists)
    eachTexel({ uv, index }, size, (corners) => corners.some((v) => list[v] > 0), (texel, corners, w) => {
      out[texel] = Math.max(out[texel], corners.reduce((sum, v, c) => sum + w[c] * list[v], 0));
    });
  return out;
}

/** Blends several pictures of the skin by how directly each faces it. */
function divide(layers) {
  const [{ weight: first }] = layers;
  for (let v = 0; v < first.length; v++) {
    const sum = layers.reduce((total, { weight }) => total + weight[v] ** 2, 0);
    const most = Math.max(...layers.map(({ weight }) => weight[v]));
    if (sum) for (const one of layers) one.weight[v] = (most * one.weight[v] ** 2) / sum;
  }
}

/**
 * The tone of colours of vertices, as toneOf measures a picture's. @param {Float32Array|null} [weight] only where it is above a
 * half @returns {number[]|null} null: that is nowhere
 */
function skinTone(base, position, colours, weight = null) {
  const vertices = SKIN.filter((i) => base.at[i]).map((i) => {
    let [best, least] = [0, Infinity];
    for (let v = 0; v < position.length / 3; v++) {
      const far = base.at[i].reduce((sum, x, k) => sum + (x - position[3 * v + k]) ** 2, 0);
      if (far < least) [least, best] = [far, v];
    }
    return best;
  }).filter((v) => !weight || weight[v] > 0.5);
  return vertices.length ? medians(vertices.map((v) => [...colours.subarray(3 * v, 3 * v + 3)])) : null;
}

/** Reduces the shine of a colour. */
function dulled(colours, slow, v = 0) {
  const bright = luma(colours.subarray?.(3 * v) ?? colours) / (luma(slow.subarray?.(3 * v) ?? slow) + 1e-4);
  return bright > SHINE[0] ? (SHINE[0] + (bright - SHINE[0]) * SHINE[1]) / bright : 1;
}

/** @returns {Float32Array} of each texel, how much of it pictures show */
function paint(layers, { uv, index, size, age }, data) {
  const shown = new Float32Array(size[0] * size[1]);
  const colour = [0, 0, 0];
  const wanted = (corners) => layers.some(({ weight }) => corners.some((v) => weight[v] > 0));
  eachTexel({ uv, index }, size, wanted, (texel, corners, share) => {
    const mixed = (list, stride, k) => share[0] * list[corners[0] * stride + k] + share[1] * list[corners[1] * stride + k] +
      share[2] * list[corners[2] * stride + k];
    const at = 4 * texel;
    let rest = 1;
    const sum = [0, 0, 0];
    for (const { picture, places, weight, gain, slow } of layers) {
      const w = mixed(weight, 1, 0);
      if (w < 0.004) continue;
      rest -= w;
      sample(picture, mixed(places, 2, 0), mixed(places, 2, 1), colour);
      const about = [0, 1, 2].map((k) => mixed(slow, 3, k));
      const dull = dulled(colour, about) * (age ? deeper(luma(colour), luma(about), age) : 1);
      for (let k = 0; k < 3; k++) sum[k] += w * dull * colour[k] * mixed(gain, 3, k);
    }
    shown[texel] = Math.min(1, 1 - rest);
    if (rest < 1) for (let k = 0; k < 3; k++) data[at + k] = coded(sum[k] + Math.max(0, rest) * linear[data[at + k]]);
  });
  return shown;
}
