// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Subdivides triangles where the outline matters. A split edge gets a vertex on the curve that its end points and
 * normals give (the edge of a PN triangle, Vlachos et al. 2001); the old vertices stay where they are, so
 * feature points stay exact. The actions of a new vertex are the mean of its two neighbours', but along the lips
 * they follow a curve through four neighbours, so that an opening is round where its vertices are far apart.
 */
import { normals } from '../lib/mesh.mjs';

/**
 * @param {(a: number, b: number) => boolean} split whether the edge between two vertices is to be split;
 *   symmetric
 * @param {(a: number[][], b: number[][]) => number[][]} between refs of a new vertex
 */
export function refine(part, split, between = meanOf) {
  const first =
    part.smooth ??
    part.index.reduce((all, v) => {
      all[v] = v;
      return all;
    }, []);
  const n = normals(part.position, part.index, part.smooth);
  const middles = new Map();
  const position = Array.from(part.position),
    uv = part.uv.slice(),
    refs = part.refs.slice();
  const smooth = Array.from({ length: refs.length }, (_, v) => first[v] ?? v);
  const places = new Map();

  const middle = (a, b) => {
    const lowHigh = a < b ? [a, b] : [b, a];
    const key = lowHigh.join('/');
    if (middles.has(key)) return middles.get(key);
    const i = refs.length;
    middles.set(key, i);
    const fa = smooth[a],
      fb = smooth[b];
    const place = fa < fb ? `${fa}/${fb}` : `${fb}/${fa}`;
    if (!places.has(place)) places.set(place, i);
    smooth.push(places.get(place));
    position.push(...curved(part.position, n, fa < fb ? a : b, fa < fb ? b : a));
    uv.push((uv[a * 2] + uv[b * 2]) / 2, (uv[a * 2 + 1] + uv[b * 2 + 1]) / 2);
    refs.push(between(refs[a], refs[b]));
    return i;
  };

  const index = [];
  for (let t = 0; t < part.index.length; t += 3) {
    const v = [part.index[t], part.index[t + 1], part.index[t + 2]];
    const cut = v.map((a, i) => (split(a, v[(i + 1) % 3]) ? middle(a, v[(i + 1) % 3]) : -1));
    index.push(...pieces(v, cut));
  }
  const seams = smooth.some((f, v) => f !== v);
  return { ...part, position: Float64Array.from(position), uv, refs, index, smooth: seams ? smooth : null };
}

const MOST_ROUNDS = 3;

/** Refines until no edge is longer than that, in mm, so that round parts with few faces look round. */
export function rounded(part, longest) {
  for (let round = 0; round < MOST_ROUNDS; round++) {
    const finer = refine(part, longEdges(part, longest));
    if (finer.index.length === part.index.length) break;
    part = finer;
  }
  return part;
}

/** Edges longer than that, mm. */
export function longEdges({ position: p }, length) {
  return (a, b) =>
    Math.hypot(p[a * 3] - p[b * 3], p[a * 3 + 1] - p[b * 3 + 1], p[a * 3 + 2] - p[b * 3 + 2]) > length;
}

const EAR = ['10.1', '10.2', '10.3', '10.4', '10.5', '10.6'];
const EAR_REACH = 22; // mm from one of its points: the whole ear, little of the cheek

/** Edges of the lips, the lids, the nose's underside and the ears that are long enough to show as corners. */
export function skinDetail(ctx, part, spec) {
  const long = longEdges(part, spec.longestEdge),
    ear = longEdges(part, spec.longestEar),
    longer = longEdges(part, spec.longestElsewhere);
  const near = part.refs.map((refs) => {
    const [v] = refs[0];
    const q = [ctx.p[v * 3], ctx.p[v * 3 + 1], ctx.p[v * 3 + 2]];
    const toEye = Math.min(
      ...['l', 'r'].map((side) => Math.hypot(...q.map((x, k) => x - ctx.eyes[side][k]))),
    );
    return ctx.grid.inner[v] + ctx.grid.outer[v] > 0.4 || toEye < ctx.eyes.radius + 6;
  });
  const ears = part.refs.map(([[v]]) =>
    EAR.some((name) => Math.hypot(...ctx.fdp[name].map((x, k) => x - ctx.p[v * 3 + k])) < EAR_REACH),
  );
  const high = (v) => part.position[v * 3 + 1] > spec.refineAbove;
  return (a, b) => (near[a] && near[b] ? long(a, b) : ears[a] && ears[b] ? ear(a, b) : high(a) && high(b) && longer(a, b));
}

/**
 * The triangles that replace one triangle; cut[i] is the vertex in the middle of the edge from v[i] to the
 * next, or -1.
 */
function pieces(v, cut) {
  const count = cut.filter((c) => c >= 0).length;
  if (count === 0) return v;
  if (count === 3) {
    return [v[0], cut[0], cut[2], cut[0], v[1], cut[1], cut[2], cut[1], v[2], cut[0], cut[1], cut[2]];
  }
  const turn = count === 1 ? cut.findIndex((c) => c >= 0) : (cut.findIndex((c) => c < 0) + 1) % 3;
  const [a, b, c] = [0, 1, 2].map((i) => v[(i + turn) % 3]);
  const [ab, bc] = [0, 1].map((i) => cut[(i + turn) % 3]);
  return count === 1 ? [a, ab, c, ab, b, c] : [a, ab, c, ab, bc, c, ab, b, bc];
}

function curved(p, n, a, b) {
  const d = [0, 1, 2].map((k) => p[b * 3 + k] - p[a * 3 + k]);
  const wa = [0, 1, 2].reduce((s, k) => s + d[k] * n[a * 3 + k], 0),
    wb = -[0, 1, 2].reduce((s, k) => s + d[k] * n[b * 3 + k], 0);
  return [0, 1, 2].map(
    (k) => (p[a * 3 + k] + p[b * 3 + k]) / 2 - (wa * n[a * 3 + k] + wb * n[b * 3 + k]) / 8,
  );
}

function meanOf(a, b) {
  const sum = new Map();
  for (const [v, w] of [...a, ...b]) sum.set(v, (sum.get(v) ?? 0) + w / 2);
  return [...sum];
}

/**
 * Refs of new vertices of the skin: along an edge loop of the lips by the four-point scheme (Dyn, Levin and Gregory 1987), elsewhere the mean.
 * @param {{l: number[][], r: number[][]}} mouth the loops of the topology
 */
export function alongLips(mouth) {
  const rings = mouth.l.map((left, row) => [...left, ...mouth.r[row].slice(1, -1).reverse()]);
  const places = new Map(rings.flatMap((ring) => ring.map((v, at) => [v, { ring, at }])));
  return (a, b) => {
    const [one, other] = [a, b].map((refs) => (refs.length === 1 ? places.get(refs[0][0]) : undefined));
    if (one?.ring !== other?.ring || !one) return meanOf(a, b);
    const { ring } = one;
    const count = ring.length;
    const step = (other.at - one.at + count) % count;
    if (step !== 1 && step !== count - 1) return meanOf(a, b);
    const first = step === 1 ? one.at : other.at;
    return [-1, 9, 9, -1].map((w, i) => [ring[(first - 1 + i + count) % count], w / 16]);
  };
}
