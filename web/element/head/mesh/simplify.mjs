// SPDX-License-Identifier: MIT
// Fewer triangles where the picture's points are too large to show the difference. Vertices are taken away one by one, each
// into a neighbour, as long as the result stays near the original: in position, in every pose given, in light, in its
// normal and on the texture. The remaining vertices are unchanged, and so are their moves.

const STEPS = [0.1, 0.35, 1]; // of the tolerance: what costs least goes first
const PASSES = 4; // of each step
const LEAST_PART = 300; // triangles: below there is nothing to win
const FLIPPED = 0.2; // cosine between the normals of a triangle before and after

/**
 * Features compared at a vertex, in mm: consecutive blocks of three numbers.
 * @typedef {{blocks: Float32Array[], places: number}} Features the first `places` blocks are positions, the rest pose first
 */

/** The triangles round each vertex, updated as vertices are removed. */
class Mesh {
  /** @param {{index: Uint16Array, smooth: Uint16Array|null, vertices: number}} part */
  constructor({ index, smooth, vertices }) {
    this.index = Uint32Array.from(index);
    this.round = Array.from({ length: vertices }, () => []);
    for (let i = 0; i < index.length; i++) this.round[index[i]].push(i - (i % 3));
    /** Seams of the texture: several vertices at one place, which must go together, and therefore stay. */
    this.seam = new Uint8Array(vertices);
    const first = new Map();
    for (let v = 0; smooth && v < vertices; v++) {
      const other = first.get(smooth[v]);
      if (other === undefined) first.set(smooth[v], v);
      else this.seam[v] = this.seam[other] = 1;
    }
    this.gone = new Map(); // triangle -> the vertices that it stands for
    this.turn = 0; // of counting
    this.counted = new Int32Array(vertices); // number of the pass
    this.common = new Uint8Array(vertices); // triangles that are shared with the vertex whose turn it was
  }

  /** The neighbours of a vertex; `common` says with how many of its triangles each is shared. */
  neighbours(u) {
    const { index, counted, common } = this;
    const turn = ++this.turn;
    const found = [];
    for (const t of this.round[u])
      for (let i = t; i < t + 3; i++) {
        const v = index[i];
        if (v === u) continue;
        if (counted[v] === turn) common[v]++;
        else {
          counted[v] = turn;
          common[v] = 1;
          found.push(v);
        }
      }
    return found;
  }

  /** Whether `u` may become `v` and the surface stays one: they have no neighbours in common but those of shared triangles. */
  joins(v) {
    const { index, counted, turn } = this; // of u's neighbours
    const both = new Set();
    for (const t of this.round[v])
      for (let i = t; i < t + 3; i++) if (index[i] !== v && counted[index[i]] === turn) both.add(index[i]);
    return both.size === this.common[v];
  }

  /** The vertices that have gone and are looked for in a triangle round `u`. */
  lost(u) {
    return this.round[u].flatMap((t) => this.gone.get(t) ?? []);
  }

  /** Merges `u` into `v`. @param {(p: number) => number} home of a removed vertex: one of the remaining triangles */
  collapse(u, v, home) {
    const lost = [...this.lost(u), u];
    const homes = lost.map(home);
    for (const t of this.round[u]) {
      const corners = [this.index[t], this.index[t + 1], this.index[t + 2]];
      this.gone.delete(t);
      if (corners.includes(v)) {
        for (const w of corners) if (w !== u) this.round[w].splice(this.round[w].indexOf(t), 1);
        this.index[t] = this.index[t + 1] = this.index[t + 2] = 0; // no triangle any more
      } else {
        this.index[t + corners.indexOf(u)] = v;
        this.round[v].push(t);
      }
    }
    this.round[u] = [];
    lost.forEach((p, i) => (this.gone.get(homes[i]) ?? this.gone.set(homes[i], []).get(homes[i])).push(p));
  }

  /** The triangles that are left. */
  get left() {
    return Uint16Array.from(this.index.filter((_, i, all) => all[i - (i % 3)] !== all[i - (i % 3) + 1]));
  }
}

/** The shares of a, b and c in the point of their triangle that is nearest to `p`, or almost. */
function shares(places, p, a, b, c, out) {
  let [uu, uv, vv, uw, vw] = [0, 0, 0, 0, 0];
  for (let k = 0; k < 3; k++) {
    const from = places[3 * a + k];
    const u = places[3 * b + k] - from;
    const v = places[3 * c + k] - from;
    const w = places[3 * p + k] - from;
    uu += u * u;
    uv += u * v;
    vv += v * v;
    uw += u * w;
    vw += v * w;
  }
  const area = uu * vv - uv * uv;
  let s = area > 1e-9 ? (vv * uw - uv * vw) / area : uu ? uw / uu : 0;
  let t = area > 1e-9 ? (uu * vw - uv * uw) / area : 0;
  s = Math.min(1, Math.max(0, s));
  t = Math.min(1, Math.max(0, t));
  const sum = s + t;
  if (sum > 1) {
    s /= sum;
    t /= sum;
  }
  out[0] = 1 - s - t;
  out[1] = s;
  out[2] = t;
}

/** The square of how far `p` is from the point that has these shares of a, b and c, in one block. */
function apart(block, p, a, b, c, part) {
  let sum = 0;
  for (let k = 0; k < 3; k++) {
    const d = block[3 * p + k] - part[0] * block[3 * a + k] - part[1] * block[3 * b + k] - part[2] * block[3 * c + k];
    sum += d * d;
  }
  return sum;
}

/** Computes the normal of a triangle, with its area as the length. */
function normalOf(places, a, b, c, out) {
  const [a3, b3, c3] = [3 * a, 3 * b, 3 * c];
  const [ux, uy, uz] = [places[b3] - places[a3], places[b3 + 1] - places[a3 + 1], places[b3 + 2] - places[a3 + 2]];
  const [vx, vy, vz] = [places[c3] - places[a3], places[c3 + 1] - places[a3 + 1], places[c3 + 2] - places[a3 + 2]];
  out[0] = uy * vz - uz * vy;
  out[1] = uz * vx - ux * vz;
  out[2] = ux * vy - uy * vx;
}

/** The error of merging one vertex into another. */
class Cost {
  #part = [0, 0, 0];
  #least = [0, 0, 0];
  #before = [0, 0, 0];
  #after = [0, 0, 0];

  /** @param {Mesh} mesh @param {Features} features */
  constructor(mesh, { blocks, places }) {
    Object.assign(this, { mesh, blocks, places: blocks.slice(0, places) });
  }

  /**
   * The square of the largest error when `u` becomes `v`, of `u` and all that has gone before; Infinity from `most` on.
   * @param {number[]} lost `mesh.lost(u)` @param {number} other the other way along an outline, or -1
   */
  of(u, v, lost, other, most) {
    let worst = 0;
    if (other >= 0) {
      shares(this.blocks[0], u, v, other, other, this.#least);
      worst = this.#error(u, v, other, other, worst, most);
    } else worst = this.#nearest(u, u, v, worst, most);
    for (let i = 0; i < lost.length && worst < most; i++) worst = this.#nearest(lost[i], u, v, worst, most);
    return worst >= most || this.#turnsOver(u, v) ? Infinity : worst;
  }

  /** The triangle in which to look for `p` once `u` is merged into `v`. */
  home(p, u, v) {
    const [rest] = this.blocks;
    let [nearest, found] = [Infinity, -1];
    for (const t of this.mesh.round[u]) {
      const [x, y, z] = this.#become(t, u, v);
      if (x === y || y === z || x === z) continue;
      shares(rest, p, x, y, z, this.#part);
      const distance = apart(rest, p, x, y, z, this.#part);
      if (distance >= nearest) continue;
      [nearest, found] = [distance, t];
      for (let k = 0; k < 3; k++) this.#least[k] = this.#part[k];
    }
    return found;
  }

  #nearest(p, u, v, worst, most) {
    const t = this.home(p, u, v);
    return t < 0 ? Infinity : this.#error(p, ...this.#become(t, u, v), worst, most);
  }

  #error(p, a, b, c, worst, most) {
    for (const block of this.blocks) {
      worst = Math.max(worst, apart(block, p, a, b, c, this.#least));
      if (worst >= most) return Infinity;
    }
    return worst;
  }

  #become(t, u, v) {
    const { index } = this.mesh;
    return [index[t] === u ? v : index[t], index[t + 1] === u ? v : index[t + 1], index[t + 2] === u ? v : index[t + 2]];
  }

  /** Whether a triangle turns over, in any pose, when `u` becomes `v`. */
  #turnsOver(u, v) {
    const { index, round } = this.mesh;
    const [before, after] = [this.#before, this.#after];
    for (const t of round[u]) {
      const [x, y, z] = this.#become(t, u, v);
      if (x === y || y === z || x === z) continue;
      for (const places of this.places) {
        normalOf(places, index[t], index[t + 1], index[t + 2], before);
        normalOf(places, x, y, z, after);
        const dot = before[0] * after[0] + before[1] * after[1] + before[2] * after[2];
        const lengths = (before[0] ** 2 + before[1] ** 2 + before[2] ** 2) * (after[0] ** 2 + after[1] ** 2 + after[2] ** 2);
        if (dot <= FLIPPED * Math.sqrt(lengths)) return true;
      }
    }
    return false;
  }
}

/**
 * Leaves out what cannot be seen at a distance. A generator that yields now and then, so that the work can be spread.
 * @param {import('../model/model.mjs').Part} part @param {Features} features @param {number[]} tolerances mm, growing
 * @returns {Generator<void, Uint16Array[]>} for each tolerance the triangles that are left, of the same vertices
 */
export function* simplify(part, features, tolerances) {
  if (part.index.length < 3 * LEAST_PART) return tolerances.map(() => part.index);
  const mesh = new Mesh(part);
  const cost = new Cost(mesh, features);
  const tried = new Float32Array(part.vertices); // the tolerance that was not enough, as it stands now
  const found = [];
  for (const tolerance of tolerances) {
    for (const step of STEPS.map((share) => (share * tolerance) ** 2)) yield* pass(part, mesh, cost, tried, step);
    found.push(mesh.left);
  }
  return found;
}

/** Takes away what costs no more than `step`, which is the square of millimetres. */
function* pass(part, mesh, cost, tried, step) {
  for (let again = 0, changed = true; again < PASSES && changed; again++) {
    const held = new Uint8Array(part.vertices);
    changed = false;
    for (let u = 0; u < part.vertices; u++) {
      if (u % 64 === 0) yield;
      if (held[u] || mesh.seam[u] || !mesh.round[u].length || tried[u] >= step) continue;
      const around = mesh.neighbours(u);
      const rim = around.filter((v) => mesh.common[v] !== 2);
      const lost = mesh.lost(u);
      let [least, into] = [step, -1];
      if (!rim.length || rim.length === 2)
        for (const v of rim.length ? rim : around) {
          if (!mesh.joins(v)) continue;
          const error = cost.of(u, v, lost, rim.length ? rim[0] + rim[1] - v : -1, least);
          if (error < least) [least, into] = [error, v];
        }
      if (into < 0) {
        tried[u] = step;
        continue;
      }
      mesh.collapse(u, into, (p) => cost.home(p, u, into));
      changed = true;
      for (const w of around) {
        held[w] = 1;
        tried[w] = 0;
      }
    }
  }
}

const KEPT = 24; // vertices that a triangle may have to come after and still find shaded

/**
 * The triangles in such an order that the next one has vertices of those before it (tipsify, Sander and others 2007).
 * @param {Uint16Array} index @param {number} vertices how many there are @returns {Uint16Array}
 */
export function neighboursFirst(index, vertices) {
  const round = Array.from({ length: vertices }, () => []);
  for (let i = 0; i < index.length; i++) round[index[i]].push(i - (i % 3));
  const live = Int32Array.from(round, (list) => list.length);
  const stamp = new Int32Array(vertices).fill(-KEPT - 1);
  const done = new Uint8Array(index.length / 3);
  const out = new Uint16Array(index.length);
  const dead = [];
  let [time, filled, cursor] = [0, 0, 0];
  const next = (candidates) => {
    let [best, most] = [-1, -1];
    for (const v of candidates) {
      if (!live[v]) continue;
      const age = time - stamp[v];
      const worth = age + 2 * live[v] <= KEPT ? age : 0; // the oldest that stays until all round it is drawn
      if (worth > most) [best, most] = [v, worth];
    }
    if (best >= 0) return best;
    while (dead.length) {
      const v = dead.pop();
      if (live[v]) return v;
    }
    while (cursor < vertices) if (live[cursor++]) return cursor - 1;
    return -1;
  };
  for (let v = next([]); v >= 0; ) {
    const candidates = [];
    for (const t of round[v]) {
      if (done[t / 3]) continue;
      done[t / 3] = 1;
      for (let k = 0; k < 3; k++) {
        const w = index[t + k];
        out[filled++] = w;
        dead.push(w);
        candidates.push(w);
        live[w]--;
        if (time - stamp[w] > KEPT) stamp[w] = time++;
      }
    }
    v = next(candidates);
  }
  return out;
}

/**
 * Renumbers vertices in the order of their first use, and drops unused ones.
 * @param {Uint16Array} index
 * @returns {{index: Uint16Array, kept: Uint16Array}} the renumbered triangles; old numbers of the vertices kept
 */
export function renumbered(index) {
  const numbers = new Map();
  const out = index.map((v) => {
    if (!numbers.has(v)) numbers.set(v, numbers.size);
    return numbers.get(v);
  });
  return { index: out, kept: Uint16Array.from(numbers.keys()) };
}
