// SPDX-License-Identifier: MIT

/** A few fibres on the skin: they hide nothing. */
export const THIN = ['lashes', 'brows'];

/** Parts that cast no shadow: thin ones, and lenses. */
export const CLEAR = [...THIN, 'glasses'];

/** Hairs beside each other, between which some light comes through to the skin. */
export const isAiry = (name) => /^(hair|beard)/.test(name);

/** Derives the kind of surface from the name of a part. */
export function kindOf(name) {
  if (/^(hair|beard|lashes|brows)/.test(name)) return 'hair';
  if (name.startsWith('eye')) return 'eye';
  if (/^(teeth|tongue|mouth)/.test(name)) return 'mouth';
  return name.startsWith('skin') ? 'skin' : 'other';
}

/** How surfaces shine: seen from the front; the share of the narrow part, and its roughness as a share of the broad one's. */
export const GLOSS = { f0: 0.028, strength: 2.6, narrow: 0.28, oily: 0.68 };

const VOLUME = 0.65;
const BACK_MM = 70; // from the eyes to the middle of the skull

/**
 * Hair is made of a few large leaves. Their normals lean towards those of a ball round the head, so that the whole is lit
 * as one volume and not leaf by leaf.
 * @param {import('../model/model.mjs').Part} part @param {Float32Array} normals
 */
export function volumeNormals({ position }, normals) {
  const center = [0, 1, 2].map((k) => {
    let sum = 0;
    for (let i = k; i < position.length; i += 3) sum += position[i];
    return (3 * sum) / position.length;
  });
  const out = new Float32Array(normals.length);
  for (let v = 0; v < out.length; v += 3) {
    const away = center.map((value, k) => position[v + k] - value);
    const distance = Math.hypot(...away) || 1;
    const n = normals.slice(v, v + 3);
    const side = n[0] * away[0] + n[1] * away[1] + n[2] * away[2] < 0 ? -1 : 1; // leaves have no outside
    const mixed = away.map((value, k) => (VOLUME * value) / distance + (1 - VOLUME) * side * n[k]);
    const length = Math.hypot(...mixed) || 1;
    for (let k = 0; k < 3; k++) out[v + k] = mixed[k] / length;
  }
  return out;
}

const LYING = 4; // times as wide as high on the texture: strands run along such a strip (less may be a row of curls)

/** For each vertex whether the piece of the texture that it belongs to lies: its fibres run along u. */
function lying({ uv, index, vertices }) {
  const piece = Uint32Array.from({ length: vertices }, (_, v) => v);
  const root = (v) => {
    while (piece[v] !== v) v = piece[v] = piece[piece[v]];
    return v;
  };
  for (let i = 0; i < index.length; i += 3) for (const k of [1, 2]) piece[root(index[i + k])] = root(index[i]);
  const boxes = Array.from({ length: vertices }, () => [Infinity, Infinity, -Infinity, -Infinity]);
  for (const v of index) {
    const box = boxes[root(v)];
    for (const k of [0, 1]) [box[k], box[2 + k]] = [Math.min(box[k], uv[2 * v + k]), Math.max(box[2 + k], uv[2 * v + k])];
  }
  return Array.from(piece, (_, v) => {
    const [left, top, right, bottom] = boxes[root(v)];
    return right - left > LYING * (bottom - top);
  });
}

/**
 * Computes the direction of fibres at each vertex: that of the texture's v, or of its u for strips that lie along it.
 * @param {import('../model/model.mjs').Part} part
 */
export function fibres({ name, position, uv, index, smooth, vertices }) {
  const sums = new Float32Array(3 * vertices);
  const lies = uv && !THIN.includes(name) ? lying({ uv, index, vertices }) : []; // lashes stand beside each other
  const place = (v) => (smooth ? smooth[v] : v);
  for (let t = 0; uv && t < index.length; t += 3) {
    const [a, b, c] = [index[t], index[t + 1], index[t + 2]];
    const [u1, v1] = [uv[2 * b] - uv[2 * a], uv[2 * b + 1] - uv[2 * a + 1]];
    const [u2, v2] = [uv[2 * c] - uv[2 * a], uv[2 * c + 1] - uv[2 * a + 1]];
    const area = u1 * v2 - u2 * v1;
    if (!area) continue;
    for (let k = 0; k < 3; k++) {
      const e1 = position[3 * b + k] - position[3 * a + k];
      const e2 = position[3 * c + k] - position[3 * a + k];
      const along = Math.sign(area) * (lies[a] ? v2 * e1 - v1 * e2 : u1 * e2 - u2 * e1);
      for (const v of [a, b, c]) sums[3 * place(v) + k] += along;
    }
  }
  const out = new Float32Array(3 * vertices);
  for (let v = 0; v < vertices; v++) {
    const sum = sums.subarray(3 * place(v), 3 * place(v) + 3);
    const length = Math.hypot(...sum) || 1;
    for (let k = 0; k < 3; k++) out[3 * v + k] = sum[k] / length;
  }
  return out;
}

const CLUSTER = 48; // triangles that stay together

/**
 * The triangles of hair, the outermost first: what lies below need not be coloured. Neighbours stay together, so that their
 * vertices are shaded once.
 * @param {import('../model/model.mjs').Part} part @param {Uint16Array} index its triangles, neighbours after each other
 * @returns {Uint16Array}
 */
export function outsideFirst({ position }, index) {
  const clusters = [];
  for (let start = 0; start < index.length; start += 3 * CLUSTER) {
    const corners = index.subarray(start, start + 3 * CLUSTER);
    const sum = [0, 0, 0];
    for (const v of corners) for (let k = 0; k < 3; k++) sum[k] += position[3 * v + k] / corners.length;
    clusters.push({ corners, away: Math.hypot(sum[0], sum[1], sum[2] + BACK_MM) });
  }
  clusters.sort((a, b) => b.away - a.away);
  return Uint16Array.from(clusters.flatMap(({ corners }) => [...corners]));
}

const CORNEA = 1.5; // it is curved more than the ball it sits on
const LIMBUS = 1.35; // where it has gone over into the ball, in radii of the iris

/**
 * Computes the normals of an eye as a ball with a cornea that looks along z, independent of the mesh of its iris.
 * @param {import('../model/model.mjs').Part} part @param {number[]} center
 * @param {number} iris its radius, in radii of the ball
 */
export function eyeNormals({ position }, center, iris) {
  const out = new Float32Array(position.length);
  const edge = Math.asin(Math.min(1, iris));
  for (let v = 0; v < out.length; v += 3) {
    const [x, y, z] = center.map((value, k) => position[v + k] - value);
    const angle = Math.atan2(Math.hypot(x, y), z);
    const flat = Math.min(1, Math.max(0, (angle / edge - 1) / (LIMBUS - 1)));
    const bent = angle * (CORNEA + (1 - CORNEA) * flat);
    const aside = Math.hypot(x, y) || 1;
    out.set([(x / aside) * Math.sin(bent), (y / aside) * Math.sin(bent), Math.cos(bent)], v);
  }
  return out;
}
