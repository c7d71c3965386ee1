// SPDX-License-Identifier: GPL-3.0-or-later
/** Finds where the surface of one part passes through another, and how deep. */

const CELL = 2.5; // mm: about an edge

/**
 * Edges of one mesh that go through triangles of the other, in both directions, with both ends at least `depth` mm away from the triangle's
 * plane; closer counts as touching. Derived data is cached by object, so each pose must be a separate object.
 * @param {{position: Float64Array, index: ArrayLike<number>}} a @param {{position: Float64Array, index: ArrayLike<number>}} b
 * @param {(x: number, y: number, z: number) => boolean} [where] only there
 * @returns {{count: number, deepest: number, at: number[]|null}}
 */
export function crossings(a, b, depth, where = () => true) {
  const out = { count: 0, deepest: 0, at: null };
  if (!a.index.length || !b.index.length) return out;
  pierced(a, b, depth, where, out);
  pierced(b, a, depth, where, out);
  return out;
}

const edgeLists = new WeakMap(); // index -> its edges, each once, as pairs of vertices
const grids = new WeakMap(); // mesh -> its triangles by place

function edgesOf({ position, index }) {
  const there = edgeLists.get(index);
  if (there) return there;
  const count = position.length / 3;
  const done = new Set();
  const pairs = [];
  for (let t = 0; t < index.length; t += 3)
    for (let i = 0; i < 3; i++) {
      const u = index[t + i],
        v = index[t + ((i + 1) % 3)];
      const edge = u < v ? u * count + v : v * count + u;
      if (!done.has(edge)) pairs.push(u, v);
      done.add(edge);
    }
  const edges = Uint32Array.from(pairs);
  edgeLists.set(index, edges);
  return edges;
}

/** The triangles in cells of CELL mm: `list` holds those of cell c from start[c] to start[c + 1]. */
function gridOf(mesh) {
  const there = grids.get(mesh);
  if (there) return there;
  const { position: p, index } = mesh;
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < index.length; i++)
    for (let k = 0; k < 3; k++) {
      const x = p[index[i] * 3 + k];
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
  const size = low.map((x, k) => Math.floor((high[k] - x) / CELL) + 1);
  const start = new Uint32Array(size[0] * size[1] * size[2] + 1);
  const triangles = index.length / 3;
  const boxes = new Int32Array(triangles * 6); // cells from and to, each axis
  for (let t = 0; t < triangles; t++)
    for (let k = 0; k < 3; k++) {
      const [x, y, z] = [p[index[t * 3] * 3 + k], p[index[t * 3 + 1] * 3 + k], p[index[t * 3 + 2] * 3 + k]];
      boxes[t * 6 + k] = Math.floor((Math.min(x, y, z) - low[k]) / CELL);
      boxes[t * 6 + 3 + k] = Math.floor((Math.max(x, y, z) - low[k]) / CELL);
    }
  const each = (fn) => {
    for (let t = 0; t < triangles; t++)
      for (let z = boxes[t * 6 + 2]; z <= boxes[t * 6 + 5]; z++)
        for (let y = boxes[t * 6 + 1]; y <= boxes[t * 6 + 4]; y++)
          for (let x = boxes[t * 6]; x <= boxes[t * 6 + 3]; x++) fn((z * size[1] + y) * size[0] + x, t);
  };
  each((cell) => start[cell + 1]++);
  for (let c = 1; c < start.length; c++) start[c] += start[c - 1];
  const list = new Uint32Array(start[start.length - 1]);
  const next = start.slice();
  each((cell, t) => (list[next[cell]++] = t));
  const grid = { low, size, start, list, tested: new Int32Array(triangles) };
  grids.set(mesh, grid);
  return grid;
}

function pierced(a, b, depth, where, out) {
  const { low, size, start, list, tested } = gridOf(b);
  const edges = edgesOf(a);
  const q = a.position;
  tested.fill(-1);
  const from = [0, 0, 0],
    to = [0, 0, 0];
  for (let e = 0; e < edges.length; e += 2) {
    const u = edges[e] * 3,
      v = edges[e + 1] * 3;
    let beside = false;
    for (let k = 0; k < 3; k++) {
      from[k] = Math.max(0, Math.floor((Math.min(q[u + k], q[v + k]) - low[k]) / CELL));
      to[k] = Math.min(size[k] - 1, Math.floor((Math.max(q[u + k], q[v + k]) - low[k]) / CELL));
      beside ||= from[k] > to[k];
    }
    if (beside) continue;
    for (let z = from[2]; z <= to[2]; z++)
      for (let y = from[1]; y <= to[1]; y++)
        for (let x = from[0]; x <= to[0]; x++) {
          const cell = (z * size[1] + y) * size[0] + x;
          for (let i = start[cell]; i < start[cell + 1]; i++) {
            const t = list[i];
            if (tested[t] === e) continue;
            tested[t] = e;
            const near = through(q, u, v, b.position, b.index, t * 3);
            if (near < depth || !where(hit[0], hit[1], hit[2])) continue;
            out.count++;
            if (near > out.deepest) Object.assign(out, { deepest: near, at: [...hit] });
          }
        }
  }
}

const hit = [0, 0, 0]; // where the last edge went through

/** Returns the distance of the edge's nearer end from the plane of the triangle that it crosses; -1 if it does not cross it. */
function through(q, u, v, p, index, t) {
  const a = index[t] * 3,
    b = index[t + 1] * 3,
    c = index[t + 2] * 3;
  const ax = p[a],
    ay = p[a + 1],
    az = p[a + 2];
  const ux = p[b] - ax,
    uy = p[b + 1] - ay,
    uz = p[b + 2] - az;
  const vx = p[c] - ax,
    vy = p[c + 1] - ay,
    vz = p[c + 2] - az;
  const nx = uy * vz - uz * vy,
    ny = uz * vx - ux * vz,
    nz = ux * vy - uy * vx;
  const d = (q[u] - ax) * nx + (q[u + 1] - ay) * ny + (q[u + 2] - az) * nz;
  const f = (q[v] - ax) * nx + (q[v + 1] - ay) * ny + (q[v + 2] - az) * nz;
  if (d * f >= 0) return -1;
  const n = Math.sqrt(nx * nx + ny * ny + nz * nz);
  if (n < 1e-9) return -1;
  const share = d / (d - f);
  for (let k = 0; k < 3; k++) hit[k] = q[u + k] + (q[v + k] - q[u + k]) * share;
  const wx = hit[0] - ax,
    wy = hit[1] - ay,
    wz = hit[2] - az;
  const uu = ux * ux + uy * uy + uz * uz,
    uv = ux * vx + uy * vy + uz * vz,
    vv = vx * vx + vy * vy + vz * vz;
  const wu = wx * ux + wy * uy + wz * uz,
    wv = wx * vx + wy * vy + wz * vz;
  const det = uv * uv - uu * vv;
  const g = (uv * wv - vv * wu) / det,
    h = (uv * wu - uu * wv) / det;
  if (g < 0 || h < 0 || g + h > 1) return -1;
  return Math.min(Math.abs(d), Math.abs(f)) / n;
}
