// SPDX-License-Identifier: MIT
// The feature points of an avatar, found by what its own shapes move; and its FAPUs.
import { OPENERS } from './controls.mjs';
import { lipSeamOf } from './lip-seam.mjs';

const EYE_MOUTH = 65; // mm from the eyes' height to the mouth's, where an avatar is of no human size
const OUTER = 1.14; // of the seam's width: FAPU MW goes to the outer corners
const HUMAN = [40, 100];
const SIDES = [['L', 'Left', 1], ['R', 'Right', -1]];

/** The shift of every vertex. */
function dense({ vertices, deltas }, length) {
  const out = new Float32Array(length);
  vertices.forEach((v, i) => out.set(deltas.subarray(3 * i, 3 * i + 3), 3 * v));
  return out;
}

/** The vertices that a field moves, from the most moved down to a share of that. @returns {number[]} */
function moved({ vertices, deltas }, share, keep = () => true) {
  const far = (i) => Math.hypot(deltas[3 * i], deltas[3 * i + 1], deltas[3 * i + 2]);
  const kept = [...vertices.keys()].filter((i) => keep(vertices[i]));
  const most = kept.reduce((best, i) => Math.max(best, far(i)), 0);
  return kept.filter((i) => far(i) >= share * most && most > 0).map((i) => vertices[i]);
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
const middle = (position, vertices) => [0, 1, 2].map((k) => mean(vertices.map((v) => position[3 * v + k])));

/** Lids: the point of the upper rim that goes down farthest, and what it meets. */
function lidsOf(rig, blink, side) {
  const { position } = rig;
  const ofSide = (v) => side * (position[3 * v] - rig.middle) > 0;
  const upper = moved(blink, 0.8, ofSide);
  if (!upper.length) return null;
  const shift = dense(blink, position.length);
  const centre = middle(position, moved(blink, 0.3, ofSide));
  const down = (v) => -shift[3 * v + 1] - 0.2 * Math.abs(position[3 * v] - centre[0]);
  const top = upper.reduce((best, v) => (down(v) > down(best) ? v : best));
  const travel = -shift[3 * top + 1];
  if (!(travel > 0)) return null;
  const met = (v) => {
    const at = [0, 1, 2].map((k) => position[3 * v + k] + shift[3 * v + k] - position[3 * top + k] - shift[3 * top + k]);
    return Math.hypot(...at);
  };
  let bottom = -1;
  for (let v = 0; v < position.length / 3; v++) {
    if (rig.meshOf[v] !== rig.meshOf[top] || Math.abs(position[3 * v] - position[3 * top]) > travel) continue;
    const stays = shift[3 * v + 1] > -0.2 * travel && position[3 * v + 1] < position[3 * top + 1] - 0.5 * travel;
    if (stays && (bottom < 0 || met(v) < met(bottom))) bottom = v;
  }
  if (bottom < 0 || met(bottom) > 0.6 * travel) bottom = -1;
  return { top, bottom, centre, opening: travel + (bottom < 0 ? 0 : shift[3 * bottom + 1]) };
}

/** Between mouth and nose: where the profile is deepest behind the line from the lip to the nose's tip. @returns {number} mm */
function mouthNose(rig, upper, eyeMouth) {
  const { position } = rig;
  const mouth = position[3 * upper + 1];
  const bins = new Map();
  for (let v = 0; v < position.length / 3; v++) {
    const height = position[3 * v + 1] - mouth;
    const beside = Math.abs(position[3 * v] - rig.middle) > 0.06 * eyeMouth;
    if (beside || height < 0.1 * eyeMouth || height > 0.8 * eyeMouth) continue;
    const bin = Math.round(height / (0.03 * eyeMouth));
    bins.set(bin, Math.max(bins.get(bin) ?? -Infinity, position[3 * v + 2]));
  }
  const tip = [...bins].reduce((best, one) => (one[1] > best[1] ? one : best), [0, -Infinity]);
  const step = 0.03 * eyeMouth;
  const slope = (tip[1] - position[3 * upper + 2]) / (tip[0] * step); // of the line from the lip to the nose's tip
  const depth = ([bin, z]) => position[3 * upper + 2] + slope * bin * step - z;
  const under = [...bins].filter(([bin]) => bin < tip[0]).reduce((best, one) => (depth(one) > depth(best) ? one : best), tip);
  const found = under[0] * step;
  return Math.min(0.32, Math.max(0.24, found / eyeMouth || 0.28)) * eyeMouth; // as faces have it: some profiles say little
}

/**
 * @param {import('./rig.mjs').Rig} world @param {import('./facing.mjs').Facing} facing
 * @param {{leftEye?: number[], rightEye?: number[]}} bones places in the world
 * @returns {object|null} null: nothing of it opens a mouth. place: what brings the world to the face's mm; points: lists of
 *   vertices by name; rest: where they are, from the eyes' middle; rig: the one given, in the face's mm; fapu in mm
 */
export function landmarksOf(world, facing, bones) {
  const opener = OPENERS.find((name) => world.fields.get(name)?.vertices.length);
  if (!opener) return null;
  const axes = [facing.left, facing.up, facing.front];
  const turned = ([x, y, z]) => axes.map((axis) => axis[0] * x + axis[1] * y + axis[2] * z);
  const rig = scaled(world, turned, 1000);
  const { position, fields } = rig;
  const opening = dense(fields.get(opener), position.length);
  rig.middle = median(moved(fields.get(opener), 0.5).map((v) => position[3 * v]));
  const seam = lipSeamOf(position, opening, rig.meshOf);
  if (!seam.length) return null;
  const lids = {};
  for (const [letter, name, side] of SIDES) {
    const blink = fields.get(`eyeBlink${name}`) ?? fields.get('eyeBlink');
    const found = blink && lidsOf(rig, blink, side);
    if (found) lids[letter] = found;
  }
  const [left, right] = SIDES.map(([letter, name]) => {
    const bone = bones[`${name.toLowerCase()}Eye`];
    return bone ? turned(bone).map((value) => 1000 * value) : lids[letter]?.centre;
  });
  const mouth = nearest(seam, rig.middle);
  const height = position[3 * mouth.upper + 1];
  const width = seam.at(-1).x - seam[0].x;
  const guess = [rig.middle, height + 1.4 * width, position[3 * mouth.upper + 2] - 0.3 * width];
  const eyes = left && right ? left.map((value, k) => (value + right[k]) / 2) : guess;
  const eyeMouth = eyes[1] - height;
  const size = eyeMouth > HUMAN[0] && eyeMouth < HUMAN[1] ? 1 : EYE_MOUTH / eyeMouth;
  if (!(eyeMouth > 0)) return null;
  const pairs = sidesOf(seam, rig.middle, width);
  const points = { chin: [chinOf(rig, opening, mouth, width)] };
  for (const [letter, { upper, lower }] of Object.entries(pairs)) {
    points[`upper${letter}`] = [upper];
    points[`lower${letter}`] = [lower];
  }
  Object.assign(points, { cornerL: cornerOf(rig, seam.at(-1), 1, width), cornerR: cornerOf(rig, seam[0], -1, width) });
  for (const [letter, { top, bottom }] of Object.entries(lids)) {
    points[`lidTop${letter}`] = [top];
    if (bottom >= 0) points[`lidBottom${letter}`] = [bottom];
  }
  Object.assign(points, upperFace(rig));
  const eyeDistance = left && right ? left[0] - right[0] : 2 * 0.43 * eyeMouth;
  const opened = Object.values(lids);
  const fapu = {
    IRISD: size * (opened.length ? opened.reduce((sum, one) => sum + one.opening, 0) / opened.length : 0.16 * eyeDistance),
    ES: size * eyeDistance,
    ENS: size * eyeMouth * 0.65,
    MNS: size * mouthNose(rig, mouth.upper, eyeMouth),
    MW: size * OUTER * width,
  };
  const place = { axes, scale: 1000 * size, origin: eyes.map((value) => value * size) };
  const face = scaled(rig, (p) => p, size);
  return { place, points, seam, fapu, opener, lids: Object.keys(lids), rig: face, rest: restOf(face, points, place.origin) };
}

const nearest = (seam, x) => seam.reduce((best, pair) => (Math.abs(pair.x - x) < Math.abs(best.x - x) ? pair : best));

/** The pairs in the middle of the seam, and half way to its ends: as far from the middle on the one side as on the other. */
function sidesOf(seam, middle, width) {
  const sides = { '': nearest(seam, middle), L: seam.at(-1), R: seam[0] };
  let least = Infinity;
  for (const l of seam)
    for (const r of seam) {
      const [left, right] = [l.x - middle, middle - r.x];
      const off = Math.abs(left - width / 4) + Math.abs(right - width / 4) + 2 * Math.abs(left - right);
      if (off >= least) continue;
      least = off;
      Object.assign(sides, { L: l, R: r });
    }
  return sides;
}

/** Every place and shift through that, times a scale. */
function scaled({ position, meshOf, fields }, through, scale) {
  const all = (numbers) => {
    const out = new Float32Array(numbers.length);
    for (let i = 0; i < out.length; i += 3) {
      const at = through([numbers[i], numbers[i + 1], numbers[i + 2]]);
      for (let k = 0; k < 3; k++) out[i + k] = at[k] * scale;
    }
    return out;
  };
  return {
    position: all(position),
    meshOf,
    fields: new Map([...fields].map(([name, { vertices, deltas }]) => [name, { vertices, deltas: all(deltas) }])),
  };
}

const median = (values) => values.sort((a, b) => a - b)[values.length >> 1] ?? 0;

/** The seam ends inside the mouth: its corner is the skin before that end. @returns {number[]} */
function cornerOf({ position, meshOf }, { upper, lower }, side, width) {
  const end = middle(position, [upper, lower]);
  let best = upper;
  for (let v = 0; v < position.length / 3; v++) {
    if (meshOf[v] !== meshOf[upper]) continue;
    const [x, y, z] = [0, 1, 2].map((k) => position[3 * v + k] - end[k]);
    const near = side * x > -0.02 * width && Math.hypot(x, y, z) < 0.12 * width;
    if (near && position[3 * v + 2] > position[3 * best + 2]) best = v;
  }
  return [best];
}

/** The point of the skin in the middle that goes down farthest as the mouth opens. */
function chinOf(rig, opening, { lower }, width) {
  const { position, meshOf } = rig;
  let [best, least] = [lower, 0.5 * opening[3 * lower + 1]];
  for (let v = 0; v < position.length / 3; v++) {
    if (meshOf[v] !== meshOf[lower] || Math.abs(position[3 * v] - position[3 * lower]) > 0.12 * width) continue;
    const near = position[3 * v + 2] > position[3 * lower + 2] - 0.6 * width;
    const outside = position[3 * v + 1] < position[3 * lower + 1] - 0.2 * width;
    if (near && outside && opening[3 * v + 1] < least) [best, least] = [v, opening[3 * v + 1]];
  }
  return best;
}

/** Brows and cheeks: the middle of what is moved most by the shapes that move them. */
function upperFace({ position, fields, middle: x }) {
  const points = {};
  for (const [letter, name, side] of SIDES) {
    const own = (v) => side * (position[3 * v] - x) > 0;
    const of = {
      browIn: 'browInnerUp',
      browMid: `browDown${name}`,
      browOut: `browOuterUp${name}`,
      puff: 'cheekPuff',
      cheek: `cheekSquint${name}`,
    };
    for (const [point, shape] of Object.entries(of)) {
      const vertices = fields.has(shape) ? moved(fields.get(shape), 0.75, own) : [];
      if (vertices.length) points[point + letter] = vertices;
    }
  }
  return points;
}

/** Returns the rest positions of the points, relative to the middle of the eyes. @returns {Record<string, number[]>} */
function restOf({ position }, points, origin) {
  const from = (vertices) => middle(position, vertices).map((value, k) => value - origin[k]);
  return Object.fromEntries(Object.entries(points).map(([name, vertices]) => [name, from(vertices)]));
}
