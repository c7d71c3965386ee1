// SPDX-License-Identifier: GPL-3.0-or-later
/** Working on a surface texel by texel, and ambient occlusion. */

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
      // How far outside a texel may lie, as barycentric weights: `slack` texels over the triangle's heights.
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
 * @param {{part: object, weight: number}[]} occluders parts and how much light they stop
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
    const maps = occluders.map(({ part: o, weight }) => ({ depth: depthMap(o, dir, resolution), weight }));
    for (let v = 0; v < n; v++) {
      const nx = normals[v * 3],
        ny = normals[v * 3 + 1],
        nz = normals[v * 3 + 2];
      const cos = nx * dir[0] + ny * dir[1] + nz * dir[2];
      if (cos <= 0.02) continue;
      const q = [0, 1, 2].map((k) => part.position[v * 3 + k] + normals[v * 3 + k] * bias);
      let light = 1;
      for (const m of maps)
        if (m.depth.hides(q, bias * (0.5 + 0.7 / Math.max(cos, 0.3)))) light *= 1 - m.weight;
      seen[v] += cos * light;
      total[v] += cos;
    }
  }
  return seen.map((x, v) => (total[v] ? x / total[v] : 1));
}

function depthMap(part, dir, resolution) {
  const up = Math.abs(dir[1]) > 0.9 ? [1, 0, 0] : [0, 1, 0];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((x) => x / Math.hypot(...a));
  const right = unit(cross(up, dir));
  const top = cross(dir, right);
  const reach = 260,
    scale = resolution / (2 * reach);
  const project = (q) => [
    (q[0] * right[0] + q[1] * right[1] + q[2] * right[2] + reach) * scale,
    (q[0] * top[0] + q[1] * top[1] + q[2] * top[2] + reach) * scale,
    q[0] * dir[0] + q[1] * dir[1] + q[2] * dir[2],
  ];
  const depth = new Float32Array(resolution * resolution).fill(-Infinity);
  const p = part.position;
  const points = [];
  for (let v = 0; v < p.length / 3; v++) points.push(project([p[v * 3], p[v * 3 + 1], p[v * 3 + 2]]));
  for (let t = 0; t < part.index.length; t += 3)
    fillDepth(depth, resolution, points[part.index[t]], points[part.index[t + 1]], points[part.index[t + 2]]);
  return {
    hides(q, slack) {
      const [x, y, z] = project(q);
      const i = Math.floor(x),
        j = Math.floor(y);
      return i >= 0 && j >= 0 && i < resolution && j < resolution && depth[j * resolution + i] > z + slack;
    },
  };
}

function fillDepth(depth, resolution, a, b, c) {
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  if (Math.abs(area) < 1e-9) return;
  const x0 = Math.max(0, Math.floor(Math.min(a[0], b[0], c[0]))),
    x1 = Math.min(resolution - 1, Math.floor(Math.max(a[0], b[0], c[0])));
  const y0 = Math.max(0, Math.floor(Math.min(a[1], b[1], c[1]))),
    y1 = Math.min(resolution - 1, Math.floor(Math.max(a[1], b[1], c[1])));
  for (let y = y0; y <= y1; y++) {
    for (let x = x0; x <= x1; x++) {
      const px = x + 0.5,
        py = y + 0.5;
      const wa = ((b[0] - px) * (c[1] - py) - (b[1] - py) * (c[0] - px)) / area;
      const wb = ((c[0] - px) * (a[1] - py) - (c[1] - py) * (a[0] - px)) / area;
      const wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const z = wa * a[2] + wb * b[2] + wc * c[2];
      const i = y * resolution + x;
      if (z > depth[i]) depth[i] = z;
    }
  }
}
