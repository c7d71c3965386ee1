// SPDX-License-Identifier: GPL-3.0-or-later
/** Plain cloth, painted on the surface in millimetres: threads, soft folds, and shade. */
import { dilate, eachTexel, occlusion } from './bake.mjs';
import { hex, mix } from '../../lib/color.mjs';
import { normals } from '../../lib/mesh.mjs';
import { fractal, noise } from './noise.mjs';

const SHADE = { directions: 60, resolution: 256, bias: 3 };
const STRENGTH = 0.55; // of the shade: some light always comes through cloth

/** @param {{size: number, material: string, colours: string[]}} spec colours of the cloth inside and on its folds */
export function paintCloth(spec, { parts }) {
  const part = parts.find(({ material }) => material === spec.material);
  const { size } = spec;
  const [deep, high] = spec.colours.map(hex);
  const skin = parts.find(({ name }) => name === 'skin');
  const sky = occlusion(part, normals(part.position, part.index, part.smooth), [{ part, weight: 1 }, { part: skin, weight: 1 }], SHADE);
  const data = new Float32Array(size * size * 3);
  const done = eachTexel(part, size, (texel, a, b, c, wa, wb, wc) => {
    const at = (list, stride, k) => wa * list[a * stride + k] + wb * list[b * stride + k] + wc * list[c * stride + k];
    const [x, y, z] = [0, 1, 2].map((k) => at(part.position, 3, k));
    const fold = fractal(x / 34, y / 80, z / 34, 3);
    const thread = noise(x / 0.9, y / 2.6, z / 0.9) * 0.6 + noise(x / 2.6, y / 0.9, z / 2.6) * 0.4;
    const light = 1 - STRENGTH * (1 - Math.max(0, at(sky, 1, 0)));
    const colour = mix(deep, high, Math.min(1, Math.max(0, 0.5 + 0.9 * fold + 0.16 * thread)));
    data.set(colour.map((value) => value * light), texel * 3);
  });
  dilate(data, done, size, 6);
  return { size, data };
}
