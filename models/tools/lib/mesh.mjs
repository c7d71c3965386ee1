// SPDX-License-Identifier: GPL-3.0-or-later
/** Meshes: vertices of a group, neighbours, and cutting triangles with seams out of quads. */

export function groupVertices(base, name) {
  const group = base.groups.indexOf(name);
  if (group < 0) throw new Error(`the base mesh has no group "${name}"`);
  const out = new Set();
  for (const f of base.faces) if (f.group === group) for (const v of f.v) out.add(v);
  return [...out].sort((a, b) => a - b);
}

/** Neighbours of each vertex over the edges of the faces. */
export function neighbours(faces, count) {
  const out = Array.from({ length: count }, () => new Set());
  for (const f of faces) {
    for (let i = 0; i < f.v.length; i++) {
      const a = f.v[i],
        b = f.v[(i + 1) % f.v.length];
      out[a].add(b);
      out[b].add(a);
    }
  }
  return out.map((s) => [...s]);
}

/**
 * Triangles with one vertex for each pair of (source vertex, texture coordinate).
 * @returns {{source: number[], uv: number[], index: number[], smooth: number[]|null}} source: the vertex's
 *   number in the quad mesh; uv: two numbers a vertex; smooth: first vertex at the same place, or null when
 *   there are no seams.
 */
export function triangulate(faces, uvs, keep = () => true) {
  const known = new Map();
  const first = new Map();
  const source = [],
    uv = [],
    index = [],
    smooth = [];
  let seams = false;
  const vertex = (v, t) => {
    const key = `${v}/${t}`;
    let i = known.get(key);
    if (i === undefined) {
      i = source.length;
      known.set(key, i);
      source.push(v);
      uv.push(uvs[t * 2], uvs[t * 2 + 1]);
      if (first.has(v)) seams = true;
      else first.set(v, i);
      smooth.push(first.get(v));
    }
    return i;
  };
  for (const f of faces) {
    if (!keep(f)) continue;
    const c = f.v.map((v, i) => vertex(v, f.uv[i]));
    for (let i = 2; i < c.length; i++) {
      if (f.v[0] !== f.v[i - 1] && f.v[i - 1] !== f.v[i] && f.v[i] !== f.v[0])
        index.push(c[0], c[i - 1], c[i]);
    }
  }
  return { source, uv, index, smooth: seams ? smooth : null };
}

/** Unit normals of a triangle mesh, weighted by area, shared across seams. */
export function normals(p, index, smooth) {
  const n = new Float64Array(p.length);
  const at = (i) => (smooth ? smooth[i] : i) * 3;
  for (let t = 0; t < index.length; t += 3) {
    const a = index[t] * 3,
      b = index[t + 1] * 3,
      c = index[t + 2] * 3;
    const ux = p[b] - p[a],
      uy = p[b + 1] - p[a + 1],
      uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a],
      vy = p[c + 1] - p[a + 1],
      vz = p[c + 2] - p[a + 2];
    const nx = uy * vz - uz * vy,
      ny = uz * vx - ux * vz,
      nz = ux * vy - uy * vx;
    for (let k = 0; k < 3; k++) {
      const o = at(index[t + k]);
      n[o] += nx;
      n[o + 1] += ny;
      n[o + 2] += nz;
    }
  }
  const out = new Float64Array(p.length);
  for (let i = 0; i < p.length / 3; i++) {
    const o = at(i);
    const l = Math.hypot(n[o], n[o + 1], n[o + 2]) || 1;
    for (let k = 0; k < 3; k++) out[i * 3 + k] = n[o + k] / l;
  }
  return out;
}

/** The number of the vertex that is nearest to a point. @param {{position: ArrayLike<number>}} part @param {number[]} p */
export function nearestVertex({ position }, p) {
  let [best, least] = [0, Infinity];
  for (let v = 0; v < position.length / 3; v++) {
    const far = Math.hypot(position[3 * v] - p[0], position[3 * v + 1] - p[1], position[3 * v + 2] - p[2]);
    if (far < least) [best, least] = [v, far];
  }
  return best;
}
