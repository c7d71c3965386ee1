// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Defines the effect of each FAP on a mesh without shapes: zones around the feature points with raised-cosine weights, as in LUCIA. Distances along
 * the mesh separate upper and lower lip, so that touching lips do not stick together. Points of one lip or brow share the movement by inverse
 * distances: the weight is 1 at each point and 0 at the others, so that equal values move the whole as one.
 */
import { FAPS } from '../../lib/faps.mjs';
import { nearestVertex } from '../../lib/mesh.mjs';

const cosine = (d) => (d >= 1 ? 0 : 0.5 + 0.5 * Math.cos(Math.PI * Math.max(0, d)));
const step = (from, to, x) => 1 - cosine(Math.min(1, Math.max(0, (x - from) / (to - from))));
const far = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
export const at = (list, v) => [list[3 * v], list[3 * v + 1], list[3 * v + 2]];

const UPPER = ['9.15', '2.2', '2.6', '2.7', '8.1', '8.5', '8.6'];
const LOWER = ['2.1', '2.10', '2.3', '2.8', '2.9', '8.2', '8.7', '8.8'];
const CORNERS = [12, 13, 59, 60];

/** FAPs that share a movement; on: the lip that they belong to; radius in mm by the face's units. */
const GROUPS = [
  { faps: [4, 8, 9, 51, 55, 56, ...CORNERS], on: 'upper', radius: ({ MW }) => 0.34 * MW },
  { faps: [5, 10, 11, 52, 57, 58, ...CORNERS], on: 'lower', radius: ({ MW }) => 0.34 * MW },
  { faps: [6, 53], radius: ({ MW }) => 0.45 * MW },
  { faps: [7, 54], radius: ({ MW }) => 0.45 * MW },
  { faps: [17], on: 'upper', radius: ({ MW }) => 0.55 * MW },
  { faps: [16], on: 'lower', radius: ({ MW }) => 0.55 * MW },
  { faps: [18], on: 'lower', radius: ({ MW }) => 0.4 * MW },
  { faps: [31, 33, 35], above: '3.1', radius: ({ ES }) => 0.45 * ES },
  { faps: [32, 34, 36], above: '3.2', radius: ({ ES }) => 0.45 * ES },
  { faps: [37], above: '3.1', radius: ({ ES }) => 0.35 * ES },
  { faps: [38], above: '3.2', radius: ({ ES }) => 0.35 * ES },
  ...[39, 40, 41, 42].map((fap) => ({ faps: [fap], radius: ({ ES }) => 0.5 * ES })),
  { faps: [61], radius: ({ ES }) => 0.22 * ES },
  { faps: [62], radius: ({ ES }) => 0.22 * ES },
  { faps: [63], radius: ({ ES }) => 0.34 * ES },
  { faps: [64], radius: ({ ES }) => 0.34 * ES },
  ...[65, 66, 67, 68].map((fap) => ({ faps: [fap], radius: ({ ES }) => 0.45 * ES })),
];

/** Shortest distances along edges from the seeds to all vertices. */
function ways({ position, index, smooth }, seeds) {
  const near = new Map();
  for (let t = 0; t < index.length; t += 3)
    for (let i = 0; i < 3; i++) {
      const [a, b] = [smooth[index[t + i]], smooth[index[t + ((i + 1) % 3)]]];
      for (const [from, to] of [[a, b], [b, a]]) (near.get(from) ?? near.set(from, new Set()).get(from)).add(to);
    }
  const out = new Float64Array(position.length / 3).fill(Infinity);
  let front = seeds.map((v) => smooth[v]);
  for (const v of front) out[v] = 0;
  while (front.length) {
    const next = new Set();
    for (const v of front)
      for (const w of near.get(v) ?? []) {
        const way = out[v] + far(at(position, v), at(position, w));
        if (way < out[w] - 1e-9) {
          out[w] = way;
          next.add(w);
        }
      }
    front = [...next];
  }
  return out.map((_, v) => out[smooth[v]]);
}

/** Tells for each vertex of the skin whether it is on the upper lip's side of the mouth. */
function upperSide(skin, fdp) {
  const seeds = (names) => names.filter((name) => fdp[name]).map((name) => nearestVertex(skin, fdp[name]));
  const [up, down] = [seeds(UPPER), seeds(LOWER)];
  const [a, b] = [ways(skin, up), ways(skin, down)];
  const line = (fdp['2.2'][1] + fdp['2.3'][1]) / 2;
  const side = Array.from(a, (way, v) => (way === b[v] ? skin.position[3 * v + 1] > line : way < b[v]));
  for (const v of up) side[skin.smooth[v]] = side[v] = true;
  for (const v of down) side[skin.smooth[v]] = side[v] = false;
  return side;
}

/**
 * @param {{skin: object, fdp: object, fapu: object, pivot: number[]}} face
 * @returns {{fields: Map<number, Float64Array>, jaw: Float64Array}} fields: mm per mm of each FAP; jaw: weights of the jaw rotation
 */
export function zoneFields({ skin, fdp, fapu, pivot }) {
  const count = skin.position.length / 3;
  const upper = upperSide(skin, fdp);
  const fields = new Map();
  const lip = new Float64Array(count);
  for (const group of GROUPS) {
    const faps = group.faps.filter((fap) => fdp[FAPS[fap].point]);
    const points = faps.map((fap) => fdp[FAPS[fap].point]);
    const radius = group.radius(fapu);
    const lid = group.above && fdp[group.above]?.[1];
    for (let v = 0; v < count; v++) {
      if (group.on && (group.on === 'upper') !== upper[v]) continue;
      const p = at(skin.position, v);
      const ds = points.map((q) => far(p, q));
      let weight = cosine(Math.min(...ds) / radius);
      if (lid !== undefined) weight *= step(lid, lid + 0.6 * (Math.max(...points.map((q) => q[1])) - lid), p[1]);
      if (!weight) continue;
      if (group.faps.includes(5)) lip[v] = weight;
      const shares = ds.map((d) => 1 / (d * d + 1e-6));
      const sum = shares.reduce((a, b) => a + b);
      faps.forEach((fap, i) => {
        const field = fields.get(fap) ?? fields.set(fap, new Float64Array(3 * count)).get(fap);
        for (let k = 0; k < 3; k++) field[3 * v + k] = ((weight * shares[i]) / sum) * FAPS[fap].direction[k];
      });
    }
  }
  const whole = jawShares({ skin, fdp, fapu, pivot, upper });
  for (const [fap, direction] of [[14, FAPS[14].direction], [15, FAPS[15].direction]])
    fields.set(fap, Float64Array.from(skin.position, (_, i) => whole[Math.floor(i / 3)] * direction[i % 3]));
  return { fields, jaw: whole.map((x, v) => x * (1 - lip[v])) };
}

/** Weights of the jaw rotation: everything below the mouth, fading towards the angle of the jaw and down the neck. */
function jawShares({ skin, fdp, fapu, pivot, upper }) {
  const chin = fdp['2.1'];
  const corner = (fdp['8.3'][1] + fdp['8.4'][1]) / 2;
  const long = chin[2] - pivot[2];
  return Float64Array.from({ length: skin.position.length / 3 }, (_, v) => {
    const [x, y, z] = at(skin.position, v);
    const beside = step(0.45 * fapu.MW, 0.75 * fapu.MW, Math.abs(x));
    const high = upper[v] ? 0 : 1;
    const low = 1 - step(corner - 0.7 * fapu.MNS, corner + 0.3 * fapu.MNS, y);
    const down = step(chin[1] - 1.6 * fapu.MNS, chin[1] - 0.15 * fapu.MNS, y);
    return (high * (1 - beside) + Math.min(high, low) * beside) * down * step(pivot[2] + 0.2 * long, pivot[2] + 0.8 * long, z);
  });
}

/** Field of an Xface model from its vertex weights. @returns {Float64Array|null} */
export function xfaceField(skin, piece, fdp, { name, vertices, weight, axis, fap }) {
  const own = new Map((piece.mesh.from ?? []).map((from, v) => [from, v]));
  const mine = vertices.map((v) => (own.size ? own.get(v) : v)).filter((v) => v !== undefined && v < piece.count).map((v) => piece.at + v);
  const d = (v) => (axis < 0 ? far(fdp[name], at(skin.position, v)) : Math.abs(fdp[name][axis] - skin.position[3 * v + axis]));
  const most = Math.max(...mine.map(d));
  if (!(most > 0)) return null;
  const field = new Float64Array(skin.position.length);
  for (const v of mine) for (let k = 0; k < 3; k++) field[3 * v + k] = (Math.cos((Math.PI * d(v)) / most) + 1) * weight * FAPS[fap].direction[k];
  return field;
}
