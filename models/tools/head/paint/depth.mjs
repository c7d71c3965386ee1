// SPDX-License-Identifier: GPL-3.0-or-later
/** Depth map from a direction: the height of the nearest surface along it, as a picture. */
import { narrow } from '../../lib/span.mjs';

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

export class DepthMap {
  /** @param {number[]} dir unit vector @param {{resolution: number, reach: number, centre?: number[]}} size reach: mm from the middle to the border */
  constructor(dir, { resolution, reach, centre = [0, 0, 0] }) {
    this.dir = dir;
    this.right = unit(cross(Math.abs(dir[1]) > 0.9 ? [1, 0, 0] : [0, 1, 0], dir));
    this.top = cross(dir, this.right);
    this.resolution = resolution;
    this.reach = reach;
    this.centre = centre;
    this.scale = resolution / (2 * reach);
    this.depth = new Float32Array(resolution * resolution).fill(-Infinity);
  }

  #along(axis, x, y, z) {
    const c = this.centre;
    return (x - c[0]) * axis[0] + (y - c[1]) * axis[1] + (z - c[2]) * axis[2];
  }

  /** @param {object} part @param {(u: number, v: number) => boolean} [opaque] where its texture is opaque */
  draw({ position: p, index, uv }, opaque) {
    const n = p.length / 3;
    const [x, y, z] = [this.right, this.top, this.dir].map((axis, k) =>
      Float64Array.from({ length: n }, (_, v) => {
        const far = this.#along(axis, p[v * 3], p[v * 3 + 1], p[v * 3 + 2]);
        return k === 2 ? far : (far + this.reach) * this.scale;
      }),
    );
    for (let t = 0; t < index.length; t += 3) this.#fill(x, y, z, [index[t], index[t + 1], index[t + 2]], uv, opaque);
  }

  #fill(x, y, z, [a, b, c], uv, opaque) {
    const { resolution, depth } = this;
    const ax = x[a], bx = x[b], cx = x[c], ay = y[a], by = y[b], cy = y[c], az = z[a], bz = z[b], cz = z[c];
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (Math.abs(area) < 1e-9) return;
    const x0 = Math.max(0, Math.floor(Math.min(ax, bx, cx))),
      x1 = Math.min(resolution - 1, Math.floor(Math.max(ax, bx, cx)));
    const y0 = Math.max(0, Math.floor(Math.min(ay, by, cy))),
      y1 = Math.min(resolution - 1, Math.floor(Math.max(ay, by, cy)));
    const stepA = (by - cy) / area,
      stepB = (cy - ay) / area,
      stepC = (ay - by) / area;
    const row = { from: x0, to: x1 };
    for (let j = y0; j <= y1; j++) {
      const py = j + 0.5;
      row.from = x0;
      row.to = x1;
      const first = x0 + 0.5;
      const left = ((bx - first) * (cy - py) - (by - py) * (cx - first)) / area,
        right = ((cx - first) * (ay - py) - (cy - py) * (ax - first)) / area;
      narrow(row, left, stepA, right, stepB, 1 - left - right, stepC);
      for (let i = row.from; i <= row.to; i++) {
        const px = i + 0.5;
        const wa = ((bx - px) * (cy - py) - (by - py) * (cx - px)) / area;
        const wb = ((cx - px) * (ay - py) - (cy - py) * (ax - px)) / area;
        const wc = 1 - wa - wb;
        if (wa < 0 || wb < 0 || wc < 0) continue;
        const far = wa * az + wb * bz + wc * cz;
        if (far <= depth[j * resolution + i]) continue;
        if (opaque && !opaque(wa * uv[a * 2] + wb * uv[b * 2] + wc * uv[c * 2], wa * uv[a * 2 + 1] + wb * uv[b * 2 + 1] + wc * uv[c * 2 + 1])) continue;
        depth[j * resolution + i] = far;
      }
    }
  }

  /** Returns whether something occludes the point, nearer by more than `slack` mm. */
  hides(x, y, z, slack) {
    const i = Math.floor((this.#along(this.right, x, y, z) + this.reach) * this.scale),
      j = Math.floor((this.#along(this.top, x, y, z) + this.reach) * this.scale);
    const { resolution: n } = this;
    return i >= 0 && j >= 0 && i < n && j < n && this.depth[j * n + i] > this.#along(this.dir, x, y, z) + slack;
  }

  /**
   * Returns the share of the light from that direction that reaches a point: 0..1, from the four surrounding samples.
   * @param {(mm: number) => number} [through] light transmitted to a point that many mm below
   */
  reaches(x, y, z, slack, through = () => 0) {
    const u = (this.#along(this.right, x, y, z) + this.reach) * this.scale - 0.5,
      v = (this.#along(this.top, x, y, z) + this.reach) * this.scale - 0.5;
    const i = Math.floor(u),
      j = Math.floor(v);
    const { resolution: n, depth } = this;
    if (i < 0 || j < 0 || i >= n - 1 || j >= n - 1) return 1;
    const limit = this.#along(this.dir, x, y, z) + slack;
    const fx = u - i,
      fy = v - j,
      at = j * n + i;
    if (depth[at] <= limit && depth[at + 1] <= limit && depth[at + n] <= limit && depth[at + n + 1] <= limit) return 1;
    const open = (k) => (depth[k] > limit ? through(depth[k] - limit) : 1);
    const row = (k) => open(k) * (1 - fx) + open(k + 1) * fx;
    return row(at) * (1 - fy) + row(at + n) * fy;
  }
}
