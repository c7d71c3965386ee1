// SPDX-License-Identifier: GPL-3.0-or-later
/** Working on a surface texel by texel, and ambient occlusion. */
import { DepthMap } from './depth.mjs';

const REACH = 260; // mm: the whole head

/**
 * Calls `fn(texel, a, b, c, wa, wb, wc)` for every texel that a triangle of the part covers in its texture; a
 * border of about one texel round each triangle is included, so islands have no holes at their rims.
 */
export function eachTexel(part, size, fn) {
  const { uv, index } = part;
  const done = new Uint8Array(size * size);
  for (const slack of [0, 1]) {
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [index[t], index[t + 1], index[t + 2]];
      const [ax, ay, bx, by, cx, cy] = [a, b, c].flatMap((v) => [
        uv[v * 2] * size - 0.5,
        (1 - uv[v * 2 + 1]) * size - 0.5,
      ]);
      const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      if (Math.abs(area) < 1e-9) continue;
      const x0 = Math.max(0, Math.floor(Math.min(ax, bx, cx) - slack)),
        x1 = Math.min(size - 1, Math.ceil(Math.max(ax, bx, cx) + slack));
      const y0 = Math.max(0, Math.floor(Math.min(ay, by, cy) - slack)),
        y1 = Math.min(size - 1, Math.ceil(Math.max(ay, by, cy) + slack));
      // Tolerance for texels outside a triangle, as barycentric weights: `slack` texels relative to the triangle's heights.
      const la = (slack * Math.hypot(cx - bx, cy - by)) / Math.abs(area);
      const lb = (slack * Math.hypot(ax - cx, ay - cy)) / Math.abs(area);
      const lc = (slack * Math.hypot(bx - ax, by - ay)) / Math.abs(area);
      for (let y = y0; y <= y1; y++) {
        for (let x = x0; x <= x1; x++) {
          const i = y * size + x;
          if (done[i]) continue;
          const wa = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area;
          const wb = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area;
          const wc = 1 - wa - wb;
          if (wa < -la || wb < -lb || wc < -lc) continue;
          done[i] = 1;
          fn(i, a, b, c, wa, wb, wc);
        }
      }
    }
  }
  return done;
}

/**
 * Fills what no triangle covers with the mean colour, and near the filled texels, ring by ring, with their
 * colour.
 */
export function dilate(data, done, size, passes) {
  const sum = [0, 0, 0];
  let n = 0;
  for (let i = 0; i < done.length; i += 7) {
    if (!done[i]) continue;
    for (let k = 0; k < 3; k++) sum[k] += data[i * 3 + k];
    n++;
  }
  for (let i = 0; i < done.length; i++)
    if (!done[i]) for (let k = 0; k < 3; k++) data[i * 3 + k] = sum[k] / n;
  const steps = [-1, 1, -size, size];
  const free = (i, step) => {
    const j = i + step;
    const wraps = (step === -1 && i % size === 0) || (step === 1 && i % size === size - 1);
    return j >= 0 && j < done.length && !wraps && !done[j] ? j : -1;
  };
  let ring = [];
  for (let i = 0; i < done.length; i++) if (done[i] && steps.some((step) => free(i, step) >= 0)) ring.push(i);
  for (let pass = 0; pass < passes; pass++) {
    const next = [];
    for (const i of ring) {
      for (const step of steps) {
        const j = free(i, step);
        if (j < 0) continue;
        done[j] = 1;
        for (let k = 0; k < 3; k++) data[j * 3 + k] = data[i * 3 + k];
        next.push(j);
      }
    }
    ring = next;
  }
}

/**
 * Share of the sky that each vertex of `part` sees (cosine weighted), by depth maps from many directions.
 * @param {{part: object, weight: number, opaque?: (u: number, v: number) => boolean}[]} occluders parts, the light they block, and where they are opaque
 */
export function occlusion(part, normals, occluders, { directions, resolution, bias }) {
  const n = part.position.length / 3;
  const seen = new Float64Array(n),
    total = new Float64Array(n);
  for (let d = 0; d < directions; d++) {
    const z = 1 - (2 * (d + 0.5)) / directions,
      turn = d * Math.PI * (3 - Math.sqrt(5));
    const r = Math.sqrt(1 - z * z);
    const dir = [r * Math.cos(turn), z, r * Math.sin(turn)];
    const maps = occluders.map(({ part: o, weight, opaque }) => {
      const depth = new DepthMap(dir, { resolution, reach: REACH });
      depth.draw(o, opaque);
      return { depth, weight };
    });
    for (let v = 0; v < n; v++) {
      const nx = normals[v * 3],
        ny = normals[v * 3 + 1],
        nz = normals[v * 3 + 2];
      const cos = nx * dir[0] + ny * dir[1] + nz * dir[2];
      if (cos <= 0.02) continue;
      const q = [0, 1, 2].map((k) => part.position[v * 3 + k] + normals[v * 3 + k] * bias);
      let light = 1;
      for (const m of maps)
        if (m.depth.hides(...q, bias * (0.5 + 0.7 / Math.max(cos, 0.3)))) light *= 1 - m.weight;
      seen[v] += cos * light;
      total[v] += cos;
    }
  }
  return seen.map((x, v) => (total[v] ? x / total[v] : 1));
}
