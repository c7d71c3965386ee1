// SPDX-License-Identifier: GPL-3.0-or-later
/** Cloth, painted on the surface in millimetres: threads or stitches, folds, seams, hems, and shade. */
import { dilate, eachTexel, occlusion } from './bake.mjs';
import { clothRelief } from './cloth-relief.mjs';
import { hex, mix } from '../../lib/color.mjs';
import { normals } from '../../lib/mesh.mjs';
import { diffuse } from '../../lib/shading.mjs';
import { fractal } from './noise.mjs';

const SHADE = { directions: 60, resolution: 256, bias: 3 };
const STRENGTH = 0.5; // of the shade: some light always comes through cloth
const REACH = [0.85, 0.7, 0.85, 0.6]; // of sky and lamps, about the share that comes to a chest
const MODELLED = 0.75; // of the light on folds
const DEEP = 0.2; // darkening per mm of what is fine
const STEP = 1.5; // mm

/**
 * @param {{size: number, material: string, colours: string[], inner?: string[], stripes?: object, buttons?: string}} spec colours of the cloth inside and on its folds, and of what is worn
 *   under a jacket: its second largest piece; see clothRelief
 */
export function paintCloth(spec, { parts, ctx }) {
  const part = parts.find(({ material }) => material === spec.material);
  const { size, stripes } = spec;
  const pieces = piecesOf(part);
  const dyes = [spec.colours, ...(spec.inner ? [spec.inner] : [])].map((colours) => colours.map(hex));
  const button = hex(spec.buttons ?? spec.colours[0]);
  const skin = parts.find(({ name }) => name === 'skin');
  const n = normals(part.position, part.index, part.smooth);
  const sky = occlusion(part, n, [{ part, weight: 1 }, { part: skin, weight: 1 }], SHADE);
  const relief = clothRelief(ctx, part, spec);
  const data = new Float32Array(size * size * 3);
  const done = eachTexel(part, size, (texel, a, b, c, wa, wb, wc) => {
    const at = (list, stride, k) => wa * list[a * stride + k] + wb * list[b * stride + k] + wc * list[c * stride + k];
    const [q, normal] = [part.position, n].map((list) => [0, 1, 2].map((k) => at(list, 3, k)));
    const [u, v] = [0, 1].map((k) => at(part.uv, 2, k) * part.side);
    const [fine, buttoned] = relief.fine(q, u, v);
    const light = (1 - STRENGTH * (1 - Math.max(0, at(sky, 1, 0)))) * Math.max(0.35, 1 + DEEP * Math.min(0.5, fine));
    const modelled = lightOf(relief.folds, q, normal);
    const tone = 0.5 + 0.25 * fractal(q[0] / 34, q[1] / 80, q[2] / 34, 3);
    const [deep, high] = dyes[Number(pieces[a] === 1 && dyes.length > 1)];
    const dyed = stripes && stripeAt(stripes, q) ? hex(stripes.colour) : mix(deep, high, Math.min(1, Math.max(0, tone)));
    data.set(mix(dyed, button, buttoned).map((value, k) => value * light * modelled[k]), texel * 3);
  });
  dilate(data, done, size, 6);
  return { size, data };
}

/** For each vertex the number of its piece: 0 is the largest. */
function piecesOf({ index, smooth, position: p }) {
  const one = Array.from({ length: p.length / 3 }, (_, v) => v);
  const root = (v) => {
    while (one[v] !== v) v = one[v] = one[one[v]];
    return v;
  };
  const place = (v) => (smooth ? smooth[v] : v);
  const joined = (a, b) => (one[root(place(a))] = root(place(b)));
  for (let t = 0; t < index.length; t += 3) for (const k of [1, 2]) joined(index[t], index[t + k]);
  const areas = new Map();
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => 3 * index[t + i]);
    const [e, f] = [b, c].map((q) => [0, 1, 2].map((k) => p[q + k] - p[a + k]));
    const area = Math.hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]);
    const piece = root(place(index[t]));
    areas.set(piece, (areas.get(piece) ?? 0) + area);
  }
  const order = [...areas.keys()].sort((a, b) => areas.get(b) - areas.get(a));
  return one.map((_, v) => order.indexOf(root(place(v))));
}

/** Rings about the body. */
const stripeAt = ({ every, wide, below = Infinity }, [, y]) => y < below && (((y % every) + every) % every) < wide;

/** The light on the folds by the light on the surface without them, as colours are stored. */
function lightOf(folds, q, n) {
  const here = folds(q);
  const slope = [0, 1, 2].map((k) => (folds(q.map((x, j) => x + (j === k ? STEP : 0))) - here) / STEP);
  const out = slope.reduce((sum, x, k) => sum + x * n[k], 0);
  const bent = n.map((x, k) => x - (slope[k] - out * x));
  const long = Math.hypot(...bent) || 1;
  const [before, after] = [n, bent.map((x) => x / long)].map((normal) => diffuse('other', 0, normal, REACH));
  return before.map((x, k) => 1 + MODELLED * ((after[k] / Math.max(x, 0.05)) ** (1 / 2.2) - 1));
}
