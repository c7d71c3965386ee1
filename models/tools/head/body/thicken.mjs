// SPDX-License-Identifier: GPL-3.0-or-later
/** Cloth has a thickness: at its hems it turns inward, and shows an inner side. */
import { normals } from '../../lib/mesh.mjs';
import { hems } from './edges.mjs';

/**
 * @param {object} part the clothes @param {{thick: number, turned: number}} look mm: how thick the hem is, and how wide the side that is turned inward
 * @returns {object} the part with a strip along its hems
 */
export function thickened(part, { thick, turned }) {
  const place = (v) => (part.smooth ? part.smooth[v] : v);
  const n = normals(part.position, part.index, part.smooth);
  const edges = hems(part);
  const back = inwardOf(part, edges, place);
  const position = Array.from(part.position),
    uv = part.uv.slice(),
    refs = part.refs.slice(),
    index = part.index.slice(),
    smooth = Array.from({ length: refs.length }, (_, v) => place(v));
  const strips = new Map();
  const added = (v) => {
    if (strips.has(v)) return strips.get(v);
    const { way, ratio, across } = back.get(place(v));
    const first = strips.get(place(v));
    const strip = [
      [-0.4, 0.5], // the rounded edge: mm beyond it and below the cloth, in thicknesses
      [turned / thick, 1],
    ].map(([inward, deep], i) => {
      const at = refs.length;
      for (let k = 0; k < 3; k++) position.push(part.position[3 * v + k] + thick * (inward * way[k] - deep * n[3 * v + k]));
      const beyond = (i ? thick + turned : 0.6 * thick) * ratio;
      const on = across.get(v) ?? [0, 0];
      uv.push(part.uv[2 * v] - beyond * on[0], part.uv[2 * v + 1] - beyond * on[1]);
      refs.push(refs[v]);
      smooth.push(first?.[i] ?? at);
      return at;
    });
    strips.set(v, strip);
    if (!strips.has(place(v))) strips.set(place(v), strip);
    return strip;
  };
  for (const [a, b] of edges) {
    const [one, other] = [added(a), added(b)];
    index.push(b, a, one[0], b, one[0], other[0], other[0], one[0], one[1], other[0], one[1], other[1]);
  }
  return { ...part, position: Float64Array.from(position), uv, refs, index, smooth };
}

/** For each place on a hem the way back into the cloth, and the same on the texture of each of its vertices. */
function inwardOf({ index, position, uv }, edges, place) {
  const on = new Map(edges.flat().map((v) => [place(v), { way: [0, 0, 0], across: new Map(), ratio: 0 }]));
  for (let t = 0; t < index.length; t += 3)
    for (let k = 0; k < 3; k++) {
      const v = index[t + k];
      const here = on.get(place(v));
      if (!here) continue;
      for (const other of [index[t + ((k + 1) % 3)], index[t + ((k + 2) % 3)]]) {
        if (on.has(place(other))) continue;
        const d = [0, 1, 2].map((j) => position[3 * other + j] - position[3 * v + j]);
        const far = Math.hypot(...d) || 1;
        d.forEach((x, j) => (here.way[j] += x / far));
        const e = [0, 1].map((j) => uv[2 * other + j] - uv[2 * v + j]);
        const flat = Math.hypot(...e) || 1;
        here.across.set(v, e.map((x) => x / flat));
        here.ratio = flat / far;
      }
    }
  for (const here of on.values()) {
    const far = Math.hypot(...here.way) || 1;
    here.way = here.way.map((x) => x / far);
  }
  return on;
}
