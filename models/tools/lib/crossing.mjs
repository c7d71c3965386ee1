// SPDX-License-Identifier: GPL-3.0-or-later
/** Where the surface of one part goes through that of another, and how deep. */

const CELL = 4; // mm

/**
 * Edges of one mesh that go through triangles of the other, in both directions, with both ends at least `depth` mm away from
 * the triangle's plane: less is a touch.
 * @param {{position: Float64Array, index: ArrayLike<number>}} a @param {{position: Float64Array, index: ArrayLike<number>}} b
 * @param {(x: number, y: number, z: number) => boolean} [where] only there
 * @returns {{count: number, deepest: number, at: number[]|null}}
 */
export function crossings(a, b, depth, where = () => true) {
  const out = { count: 0, deepest: 0, at: null };
  pierced(a, b, depth, where, out);
  pierced(b, a, depth, where, out);
  return out;
}

function pierced(a, b, depth, where, out) {
  const cells = new Map();
  const key = (x, y, z) => (x + 512) * 1048576 + (y + 512) * 1024 + z + 512;
  const p = b.position;
  for (let t = 0; t < b.index.length; t += 3) {
    const box = [0, 1, 2].map((k) => {
      const three = [0, 1, 2].map((i) => p[b.index[t + i] * 3 + k]);
      return [Math.floor(Math.min(...three) / CELL), Math.floor(Math.max(...three) / CELL)];
    });
    for (let x = box[0][0]; x <= box[0][1]; x++)
      for (let y = box[1][0]; y <= box[1][1]; y++)
        for (let z = box[2][0]; z <= box[2][1]; z++) {
          const k = key(x, y, z);
          (cells.get(k) ?? cells.set(k, []).get(k)).push(t);
        }
  }
  const q = a.position;
  const done = new Set();
  for (let t = 0; t < a.index.length; t += 3) {
    for (let i = 0; i < 3; i++) {
      const u = a.index[t + i],
        v = a.index[t + ((i + 1) % 3)];
      const edge = u < v ? u * 65536 + v : v * 65536 + u;
      if (done.has(edge)) continue;
      done.add(edge);
      const s = [q[u * 3], q[u * 3 + 1], q[u * 3 + 2]],
        e = [q[v * 3], q[v * 3 + 1], q[v * 3 + 2]];
      const tested = new Set();
      const lo = s.map((x, k) => Math.floor(Math.min(x, e[k]) / CELL)),
        hi = s.map((x, k) => Math.floor(Math.max(x, e[k]) / CELL));
      for (let x = lo[0]; x <= hi[0]; x++)
        for (let y = lo[1]; y <= hi[1]; y++)
          for (let z = lo[2]; z <= hi[2]; z++)
            for (const triangle of cells.get(key(x, y, z)) ?? []) {
              if (tested.has(triangle)) continue;
              tested.add(triangle);
              const hit = through(s, e, p, b.index, triangle);
              if (!hit || hit.depth < depth || !where(...hit.at)) continue;
              out.count++;
              if (hit.depth > out.deepest) Object.assign(out, { deepest: hit.depth, at: hit.at });
            }
    }
  }
}

/** Where the edge goes through the triangle, and how far its nearer end is away from the triangle's plane. */
function through(s, e, p, index, t) {
  const [a, b, c] = [0, 1, 2].map((i) => index[t + i] * 3);
  const ux = p[b] - p[a],
    uy = p[b + 1] - p[a + 1],
    uz = p[b + 2] - p[a + 2];
  const vx = p[c] - p[a],
    vy = p[c + 1] - p[a + 1],
    vz = p[c + 2] - p[a + 2];
  const nx = uy * vz - uz * vy,
    ny = uz * vx - ux * vz,
    nz = ux * vy - uy * vx;
  const n = Math.hypot(nx, ny, nz);
  if (n < 1e-9) return null;
  const side = (q) => ((q[0] - p[a]) * nx + (q[1] - p[a + 1]) * ny + (q[2] - p[a + 2]) * nz) / n;
  const d = side(s),
    f = side(e);
  if (d * f >= 0) return null;
  const at = s.map((x, k) => x + ((e[k] - x) * d) / (d - f));
  const w = [at[0] - p[a], at[1] - p[a + 1], at[2] - p[a + 2]];
  const uu = ux * ux + uy * uy + uz * uz,
    uv = ux * vx + uy * vy + uz * vz,
    vv = vx * vx + vy * vy + vz * vz;
  const wu = w[0] * ux + w[1] * uy + w[2] * uz,
    wv = w[0] * vx + w[1] * vy + w[2] * vz;
  const det = uv * uv - uu * vv;
  const g = (uv * wv - vv * wu) / det,
    h = (uv * wu - uu * wv) / det;
  if (g < 0 || h < 0 || g + h > 1) return null;
  return { at, depth: Math.min(Math.abs(d), Math.abs(f)) };
}
