// SPDX-License-Identifier: MIT
// Finds the orientation of an avatar's face: up and forward. glTF has y up and z forward, VRM 0 looks back, and files may break
// both. The avatar's own shapes decide: those that open the mouth move down, and lie in front of the middle of the head.
import { OPENERS } from './controls.mjs';

const DOWN = 1.5; // times as far as along any other axis
const BEFORE = 0.1; // of the width of what moves
const ASIDE = Math.cos(0.1); // within 6 degrees of an axis the axis itself is meant: the sides of a face may differ a little
const [X, Y, Z] = [0, 1, 2];

/** @typedef {{left: number[], up: number[], front: number[]}} Facing axes of the face, in the world's */

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const less = (a, b) => a.map((value, k) => value - b[k]);

/** The axis that is nearest to a direction. */
function axisOf(direction) {
  const far = direction.map(Math.abs);
  const k = far.indexOf(Math.max(...far));
  return [X, Y, Z].map((one) => (one === k ? Math.sign(direction[k]) : 0));
}

/** Returns the weighted mean position of vertices. @returns {number[]|null} */
function middleOf(position, vertices, weightOf = () => 1) {
  const sum = [0, 0, 0];
  let all = 0;
  vertices.forEach((v, i) => {
    const weight = weightOf(i);
    all += weight;
    for (let k = 0; k < 3; k++) sum[k] += weight * position[3 * v + k];
  });
  return all > 0 ? sum.map((value) => value / all) : null;
}

const lengths = ({ deltas }) => {
  const far = (i) => Math.hypot(deltas[i], deltas[i + 1], deltas[i + 2]);
  return Float64Array.from({ length: deltas.length / 3 }, (_, i) => far(3 * i));
};

/** Returns the direction from the right side's shapes to the left side's. @returns {number[]} 0 without such shapes */
function sidesOf({ position, fields }) {
  const sum = [0, 0, 0];
  for (const [name, left] of fields) {
    const right = name.endsWith('Left') && fields.get(name.replace(/Left$/, 'Right'));
    if (!right || /^(jaw|mouth)Left$/.test(name)) continue;
    const [a, b] = [left, right].map((field) => middleOf(position, field.vertices, ((far) => (i) => far[i])(lengths(field))));
    if (a && b) less(a, b).forEach((value, k) => (sum[k] += value));
  }
  return sum;
}

/**
 * @param {import('./rig.mjs').Rig} rig in the world
 * @param {{leftEye?: number[], rightEye?: number[]}} bones places in the world
 * @param {{usual: number[], jaw: boolean}} told usual: where such files look; jaw: what opens the mouth is a bone, whose turn
 *   says nothing
 * @returns {Facing & {swapped: boolean}} swapped: what is called left lies on the right
 */
export function facingOf(rig, bones, { usual, jaw }) {
  const { position, fields } = rig;
  const opener = fields.get(OPENERS.find((name) => fields.get(name)?.vertices.length));
  const eyes = bones.leftEye && bones.rightEye ? less(bones.leftEye, bones.rightEye) : [0, 0, 0];
  const called = sidesOf(rig);
  let up = [0, 1, 0];
  let seen = null; // the way to the front, by the shape of the head
  if (opener) {
    const far = lengths(opener);
    if (!jaw) {
      const way = [0, 0, 0];
      far.forEach((_, i) => way.forEach((__, k) => (way[k] += opener.deltas[3 * i + k])));
      const sorted = way.map(Math.abs).sort((a, b) => b - a);
      if (sorted[0] > DOWN * sorted[1]) up = axisOf(way).map((value) => 0 - value);
    }
    seen = before(position, opener.vertices, far, up);
  }
  const flat = (one) => less(one, up.map((value) => value * dot(one, up)));
  const level = [eyes, called].map(flat).find((one) => Math.hypot(...one) > 0);
  const front = seen ?? (level ? axisOf(cross(level, up)) : usual);
  const left = cross(up, front);
  if (!level) return { left, up, front, swapped: false };
  const swapped = dot(level, left) < 0;
  const exact = level.map((value) => ((swapped ? -1 : 1) * value) / Math.hypot(...level));
  const turned = dot(exact, left) < ASIDE && dot(exact, left) > 0.5;
  return turned ? { left: exact, up, front: cross(exact, up), swapped } : { left, up, front, swapped };
}

/** From the middle of the head to what the mouth moves, level. @returns {number[]|null} null: it says nothing */
function before(position, vertices, far, up) {
  const most = far.reduce((best, value) => Math.max(best, value), 0);
  const centre = middleOf(position, vertices, (i) => (far[i] >= 0.5 * most ? 1 : 0));
  if (!centre) return null;
  const level = (p) => less(p, up.map((value) => value * dot(p, up)));
  const place = (v) => less([position[3 * v], position[3 * v + 1], position[3 * v + 2]], centre);
  const wide = (v, i) => (far[i] >= 0.3 * most ? Math.hypot(...level(place(v))) : 0);
  const size = vertices.reduce((best, v, i) => Math.max(best, wide(v, i)), 0);
  const sum = [0, 0, 0];
  let count = 0;
  for (let v = 0; v < position.length / 3; v++) {
    const at = place(v);
    const [height, beside] = [dot(at, up), Math.hypot(...level(at))];
    if (!(height > 0 && height < 3 * size && beside < 4 * size)) continue;
    count++;
    level(at).forEach((value, k) => (sum[k] -= value));
  }
  const way = sum.map((value) => value / (count || 1));
  return Math.hypot(...way) > BEFORE * size ? axisOf(way) : null;
}
