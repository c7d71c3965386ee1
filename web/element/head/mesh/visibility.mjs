// SPDX-License-Identifier: MIT
// Finds the triangles that are visible while a head faces the viewer. The rest (skin under hair and cloth, hair behind hair,
// the back of the teeth) costs as much as what is seen where no graphics processor draws: the colour of a point is worked out
// before its depth is read.
import { faceValues } from '../../face/face-mixer.mjs';
import { across, scan } from '../shading/occlusion.mjs';

const POINT_MM = 1.5; // of the pictures that are looked at
const NEAR_MM = 0.5; // what lies that close behind counts as seen
const HIDES = 230; // alpha from which hair hides the surface behind it
const SHOWS = 26; // alpha up to which hair is invisible

const DEGREES = Math.PI / 180;
const MOST = { pitch: 10, yaw: 14, roll: 12 }; // degrees that the head is turned from the viewer, and from the body

/** Directions to the eye, as the head has them: those of MOST, and what the width of the picture adds. */
const DIRECTIONS = [-21, 0, 21].flatMap((pitch) => [-27, -9, 9, 27].map((yaw) => {
  const [a, b] = [yaw * DEGREES, pitch * DEGREES];
  return [Math.sin(a) * Math.cos(b), Math.sin(b), Math.cos(a) * Math.cos(b)];
}));

const UNIT = 1e5 * DEGREES; // of the FAPs that turn the head
const lips = (up, down) => ({
  4: up, 8: up, 9: up, 51: up, 55: up, 56: up, 5: down, 10: down, 11: down, 52: down, 57: down, 58: down,
});
const turns = ({ pitch = 0, yaw = 0, roll = 0 }) => ({ 48: pitch * UNIT, 49: yaw * UNIT, 50: roll * UNIT });
const WIDEST = { 3: 900, 4: -450, 5: -1100 };

/** Faces: speaking, wide open, with bare teeth. */
const POSES = [
  { 3: 350, ...lips(-150, -450), ...turns({ yaw: -MOST.yaw, pitch: MOST.pitch }) },
  { ...WIDEST, ...lips(WIDEST[4], WIDEST[5]), 6: 150, 7: 150, ...turns({ yaw: MOST.yaw, pitch: -MOST.pitch }) },
  { ...lips(WIDEST[4], WIDEST[4]), 6: 300, 7: 300, ...turns({ roll: MOST.roll }) },
].map(faceValues);

/**
 * Whether a face shows no more than those do.
 * @param {ArrayLike<number>} values by FAP number @param {number[]} eye where it is seen from, a unit vector as the head has it
 */
export function within(values, [x, y, z]) {
  const lip = (a, b, c) => Math.min(values[a], values[b], values[c]);
  return Object.values(MOST).every((most, i) => Math.abs(values[48 + i]) <= most * UNIT) &&
    Math.abs(Math.atan2(x, z)) <= MOST.yaw * DEGREES && Math.abs(Math.asin(y)) <= MOST.pitch * DEGREES &&
    values[3] <= WIDEST[3] && lip(4, 8, 9) >= WIDEST[4] && lip(5, 10, 11) >= WIDEST[5];
}

/** Whether the lips meet, in the middle and at both sides of it. @param {ArrayLike<number>} values by FAP number */
export const shut = (values) => [[4, 5], [8, 10], [9, 11]].every(([upper, lower]) => values[upper] + values[lower] >= 0);

/**
 * @typedef {object} Seen a part whose visible triangles are wanted
 * @property {Uint16Array} index @property {number} vertices @property {Float32Array} uv
 * @property {boolean} double whether both sides of its triangles are drawn
 * @property {((u: number, v: number) => number)|null} alpha null: opaque
 * @property {boolean} hides whether it occludes others @property {boolean} asked whether its result is needed
 * @property {Uint8Array|null} free not 0 for vertices that move by themselves: their triangles always count as visible
 */

/** A picture of a head from far away: how near what hides is. */
class Sight {
  constructor(direction, positions) {
    const [u, v] = across(direction);
    this.axes = [u, v, direction];
    this.points = positions.map((position) => this.#project(position));
    const [least, most] = [[Infinity, Infinity], [-Infinity, -Infinity]];
    for (const points of this.points)
      for (let i = 0; i < points.length; i++) {
        const k = i % 3;
        if (k === 2) continue;
        if (points[i] < least[k]) least[k] = points[i];
        if (points[i] > most[k]) most[k] = points[i];
      }
    for (const points of this.points) for (let i = 0; i < points.length; i++) if (i % 3 < 2) points[i] -= least[i % 3];
    [this.width, this.height] = [0, 1].map((k) => Math.ceil(most[k] - least[k]) + 1);
    this.depth = new Float32Array(this.width * this.height).fill(-Infinity);
  }

  /** In points of the picture, and in mm towards the eye. */
  #project(position) {
    const [u, v, d] = this.axes;
    const out = new Float32Array(position.length);
    for (let i = 0; i < position.length; i += 3) {
      const [x, y, z] = [position[i], position[i + 1], position[i + 2]];
      out[i] = (x * u[0] + y * u[1] + z * u[2]) / POINT_MM;
      out[i + 1] = (x * v[0] + y * v[1] + z * v[2]) / POINT_MM;
      out[i + 2] = x * d[0] + y * d[1] + z * d[2];
    }
    return out;
  }

  /** @param {Seen} part @param {Float32Array} points its vertices */
  hide({ index, uv, double, alpha }, points) {
    const { depth, width, height } = this;
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [index[t], index[t + 1], index[t + 2]];
      if (!double && !faces(points, a, b, c)) continue;
      scan(points, 3 * a, 3 * b, 3 * c, width, height, (at, near, wb, wc) => {
        if (near > depth[at] && (!alpha || alphaAt(alpha, uv, a, b, c, wb, wc) >= HIDES)) depth[at] = near;
      });
    }
  }

  /** Notes which triangles are seen. @param {Seen} part @param {Float32Array} points @param {Uint8Array} seen */
  look({ index, uv, double, alpha }, points, seen) {
    const { depth, width, height } = this;
    for (let t = 0; t < index.length; t += 3) {
      if (seen[t / 3]) continue;
      const [a, b, c] = [index[t], index[t + 1], index[t + 2]];
      if (!double && !faces(points, a, b, c)) continue;
      let asked = false;
      const visible = (at, near, wb, wc) => {
        asked = true;
        if (near < depth[at] - NEAR_MM || (alpha && alphaAt(alpha, uv, a, b, c, wb, wc) <= SHOWS)) return false;
        seen[t / 3] = 1;
        return true;
      };
      scan(points, 3 * a, 3 * b, 3 * c, width, height, visible);
      if (asked) continue;
      const at = (k) => (points[3 * a + k] + points[3 * b + k] + points[3 * c + k]) / 3; // smaller than a pixel
      visible(Math.floor(at(1)) * width + Math.floor(at(0)), at(2), 1 / 3, 1 / 3);
    }
  }
}

/** Whether a triangle is seen from its front. */
function faces(points, a, b, c) {
  const [x, y] = [points[3 * a], points[3 * a + 1]];
  return (points[3 * b] - x) * (points[3 * c + 1] - y) > (points[3 * b + 1] - y) * (points[3 * c] - x);
}

function alphaAt(alpha, uv, a, b, c, wb, wc) {
  const wa = 1 - wb - wc;
  return alpha(wa * uv[2 * a] + wb * uv[2 * b] + wc * uv[2 * c], wa * uv[2 * a + 1] + wb * uv[2 * b + 1] + wc * uv[2 * c + 1]);
}

/** Finds the triangles with a marked vertex. @param {Uint16Array} index @param {Uint8Array|null} some not 0: marked */
function touching(index, some) {
  const out = new Uint8Array(index.length / 3);
  if (some) for (let i = 0; i < index.length; i++) out[(i - (i % 3)) / 3] |= some[index[i]];
  return out;
}

/** Adds the neighbours of visible triangles, by common corners. */
function grown({ index, vertices }, seen) {
  const touched = new Uint8Array(vertices);
  seen.forEach((one, t) => {
    if (one) for (let k = 0; k < 3; k++) touched[index[3 * t + k]] = 1;
  });
  return touching(index, touched);
}

/**
 * Finds the visible triangles of a head. A generator that yields after each part of a picture, so that the work can be spread.
 * @param {Seen[]} parts
 * @param {(pose: Float32Array) => {positions: Float32Array[], turn: (direction: number[]) => number[]}} posed returns the
 *   positions of their vertices in a pose, and the rotation of its head
 * @returns {Generator<void, Uint8Array[]>} for each part a byte for each triangle, not 0 where it may be seen
 */
export function* visibleTriangles(parts, posed) {
  const seen = parts.map(({ index, free }) => touching(index, free));
  for (const pose of POSES) {
    const { positions, turn: turned } = posed(pose);
    for (const direction of DIRECTIONS) {
      const picture = new Sight(turned(direction), positions);
      for (const [i, part] of parts.entries()) if (part.hides) yield picture.hide(part, picture.points[i]);
      for (const [i, part] of parts.entries()) if (part.asked) yield picture.look(part, picture.points[i], seen[i]);
    }
  }
  return parts.map((part, i) => grown(part, seen[i]));
}
