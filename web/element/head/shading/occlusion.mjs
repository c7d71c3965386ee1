// SPDX-License-Identifier: MIT
import { FILL, KEY, RIM } from './lights.mjs';

/**
 * The points of a picture whose middle lies in a triangle.
 * @param {Float32Array} points (column, row, height), flat
 * @param {number} a @param {number} b @param {number} c where its corners begin in them
 * @param {number} width @param {number} height of the picture
 * @param {(at: number, depth: number, wb: number, wc: number) => boolean|void} visit each point, with its height and the
 *   shares of the second and third corner; true: no more of them
 */
export function scan(points, a, b, c, width, height, visit) {
  const [ax, ay, bx, by, cx, cy] = [points[a], points[a + 1], points[b], points[b + 1], points[c], points[c + 1]];
  const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  if (!area) return;
  const left = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5));
  const right = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx) - 0.5));
  const low = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
  const high = Math.min(height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
  for (let y = low; y <= high; y++)
    for (let x = left; x <= right; x++) {
      const [px, py] = [x + 0.5, y + 0.5];
      const wb = ((px - ax) * (cy - ay) - (py - ay) * (cx - ax)) / area;
      const wc = ((bx - ax) * (py - ay) - (by - ay) * (px - ax)) / area;
      if (wb < 0 || wc < 0 || wb + wc > 1) continue;
      const depth = points[a + 2] + wb * (points[b + 2] - points[a + 2]) + wc * (points[c + 2] - points[a + 2]);
      if (visit(y * width + x, depth, wb, wc)) return;
    }
}

const SIZE = 192; // of a depth picture, in both directions
const BIAS_MM = 2.5; // surfaces do not shade themselves
const FOLD_MM = 4; // further tolerance for lids, so that the fold of an open lid does not shade the closed one
const SKY_DIRECTIONS = 40;
const LAMP_DIRECTIONS = [14, 6, 7]; // of key, fill and rim light, which have a size
const LAMP_RADIUS = [0.3, 0.3, 0.2]; // radians
const LEAST_SKY = 0.12; // some light gets everywhere: no skin is black under hair
const AIRY_MM = 22; // hair is hairs: what lies just below it gets some of the light,
const AIRY = 0.7; // this much, and less with the distance

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (v) => v.map((value) => value / Math.hypot(...v));

/** The share of light that passes through hair to a surface `mm` below it. */
export const throughHair = (mm) => AIRY * Math.max(0, 1 - mm / AIRY_MM);

/** Two directions at right angles to `d` and each other. */
export function across(d) {
  const u = unit(cross(Math.abs(d[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], d));
  return [u, cross(d, u)];
}

/** Evenly over the sphere (a Fibonacci lattice), or over a cap of it. */
function directions(count, axis, radius) {
  const [u, v] = across(axis);
  return Array.from({ length: count }, (_, i) => {
    const height = radius ? 1 - ((1 - Math.cos(radius)) * (i + 0.5)) / count : 1 - (2 * (i + 0.5)) / count;
    const ring = Math.sqrt(1 - height * height);
    const angle = i * Math.PI * (3 - Math.sqrt(5));
    return axis.map((value, k) => value * height + ring * (Math.cos(angle) * u[k] + Math.sin(angle) * v[k]));
  });
}

/** A depth map seen from a direction: heights along it, in mm. */
class DepthPicture {
  constructor(direction, radius, center) {
    [this.u, this.v] = across(direction);
    this.d = direction;
    this.scale = SIZE / (2 * radius);
    this.center = center;
    this.depth = new Float32Array(SIZE * SIZE).fill(-Infinity);
    this.airy = new Uint8Array(SIZE * SIZE); // where it is hair
  }

  /** Positions as (column, row, height), flat. */
  project(position) {
    const out = new Float32Array(position.length);
    for (let i = 0; i < position.length; i += 3) {
      const p = [position[i] - this.center[0], position[i + 1] - this.center[1], position[i + 2] - this.center[2]];
      out[i] = dot(p, this.u) * this.scale + SIZE / 2;
      out[i + 1] = dot(p, this.v) * this.scale + SIZE / 2;
      out[i + 2] = dot(p, this.d);
    }
    return out;
  }

  draw(points, { index, uv, opaque, airy = false }) {
    const { depth, airy: hair } = this;
    let corners;
    const there = (wb, wc) => opaque(...[0, 1].map((k) => {
      const [a, b, c] = corners.map((v) => uv[2 * v + k]);
      return a + wb * (b - a) + wc * (c - a);
    }));
    const nearest = (at, height, wb, wc) => {
      if (height <= depth[at] || (opaque && !there(wb, wc))) return;
      depth[at] = height;
      hair[at] = Number(airy);
    };
    for (let t = 0; t < index.length; t += 3) {
      corners = [index[t], index[t + 1], index[t + 2]];
      scan(points, 3 * corners[0], 3 * corners[1], 3 * corners[2], SIZE, SIZE, nearest);
    }
  }

  /**
   * Returns the share of light that reaches a projected point, 0..1, by four texels; hair may stop all of it or a part.
   * @param {number} fold mm before the point within which nothing shades it
   */
  reaches(points, i, stopped, fold) {
    const x = Math.min(SIZE - 2, Math.max(0, Math.floor(points[i] - 0.5)));
    const y = Math.min(SIZE - 2, Math.max(0, Math.floor(points[i + 1] - 0.5)));
    const [fx, fy] = [Math.min(1, points[i] - 0.5 - x), Math.min(1, points[i + 1] - 0.5 - y)];
    const at = y * SIZE + x;
    const open = (k) => {
      const below = this.depth[k] - points[i + 2] - BIAS_MM - fold;
      if (below <= 0) return 1;
      return this.airy[k] && !stopped ? throughHair(below) : 0;
    };
    const row = (k) => open(k) * (1 - fx) + open(k + 1) * fx;
    return row(at) * (1 - fy) + row(at + SIZE) * fy;
  }
}

/**
 * Computes the light that reaches each vertex of a head: of the open sky, and of the key, fill and rim light. Every part may
 * shade every other. A generator that yields after each direction, so that the work can be spread; it returns a list for
 * each part.
 * @param {{position: Float32Array, index: Uint16Array, shades: boolean, airy?: boolean, uv?: ArrayLike<number>,
 *   opaque?: ((u: number, v: number) => boolean)|null, seen: {position: Float32Array, normal: Float32Array}}[]} parts
 *   `position`: the pose in which it casts shadows, if it `shades` and is `opaque`; `airy`: it is hair; `seen`: the pose in
 *   which it receives light
 * @returns {Generator<void, Uint8Array[]>} for each part four bytes a vertex: sky, key, fill, rim
 */
export function* bakeOcclusion(parts) {
  const radius = Math.SQRT2 * Math.max(...parts.map(({ position }) => position.reduce((m, x) => Math.max(m, Math.abs(x)), 0)));
  const lights = [
    { directions: directions(SKY_DIRECTIONS, [0, 1, 0], 0), sky: true },
    { directions: directions(LAMP_DIRECTIONS[0], KEY.direction, LAMP_RADIUS[0]) },
    { directions: directions(LAMP_DIRECTIONS[1], FILL.direction, LAMP_RADIUS[1]) },
    // from behind it would have to come through all the hair
    { directions: directions(LAMP_DIRECTIONS[2], RIM.direction, LAMP_RADIUS[2]), stopped: true },
  ];
  const sums = parts.map(({ position }) => lights.map(() => new Float32Array(position.length / 3)));
  const weights = parts.map(({ position }) => lights.map(() => new Float32Array(position.length / 3)));
  const folds = parts.map(({ position, seen }) => Float32Array.from({ length: position.length / 3 }, (_, v) =>
    Math.min(FOLD_MM, Math.hypot(...[0, 1, 2].map((k) => seen.position[3 * v + k] - position[3 * v + k])))));
  for (const [l, light] of lights.entries())
    for (const direction of light.directions) {
      const picture = new DepthPicture(direction, radius, [0, 0, 0]);
      for (const part of parts) if (part.shades) picture.draw(picture.project(part.position), part);
      parts.forEach(({ seen, airy }, i) => {
        const points = picture.project(seen.position);
        for (let v = 0; v < points.length; v += 3) {
          // A surface that faces away from this part of the sky gets no light from it.
          const facing = light.sky ? dot(seen.normal.subarray(v, v + 3), direction) : 1;
          if (facing <= 0) continue;
          sums[i][l][v / 3] += facing * picture.reaches(points, v, airy || light.stopped, folds[i][v / 3]);
          weights[i][l][v / 3] += facing;
        }
      });
      yield;
    }
  return parts.map(({ position }, i) => {
    const reach = new Uint8Array((4 * position.length) / 3).fill(255);
    for (let v = 0; v < position.length / 3; v++)
      for (let l = 0; l < lights.length; l++)
        reach[4 * v + l] = Math.round(255 * Math.max(lights[l].sky ? LEAST_SKY : 0, sums[i][l][v] / (weights[i][l][v] || 1)));
    return reach;
  });
}
