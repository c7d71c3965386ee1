// SPDX-License-Identifier: GPL-3.0-or-later
/** The texture of teeth, gums and palate: three tiles, see `teeth.mjs`. */
import { hex, mix, ramp } from '../../lib/color.mjs';
import { fractal, noise } from './noise.mjs';
import { TILES } from '../teeth.mjs';
import { smoothstep } from '../../lib/zones.mjs';

/** Colours from the translucent edge over the body to the neck: of young and of old teeth. */
const ENAMEL = {
  young: [[0, '#c9cac8'], [0.07, '#d6d4cd'], [0.2, '#e8e3d9'], [0.5, '#eee4d4'], [0.8, '#e7d3b4'], [1, '#d2b088']],
  old: [[0, '#b9b3a6'], [0.07, '#c8bfab'], [0.2, '#d6c9ad'], [0.5, '#dac69f'], [0.8, '#ccac80'], [1, '#ae885b']],
};
const GUM = [[0, '#e0928c'], [0.25, '#cf7a76'], [0.6, '#b85f5e'], [1, '#9a4644']];
const PALATE = [[0, '#d4857d'], [0.4, '#c27068'], [1, '#9c4a46']];

/** @returns {{size: number, data: Float32Array}} RGB, 0..255 */
export function paintTeeth(size, { wear, shade }) {
  const stops = (list) => list.map(([at, text]) => [at, hex(text)]);
  const enamel = { young: stops(ENAMEL.young), old: stops(ENAMEL.old) };
  const gum = stops(GUM),
    palate = stops(PALATE);
  const data = new Float32Array(size * size * 3);
  const painters = {
    tooth(u, v) {
      // Three lobes reach down into the translucent edge.
      const at = Math.max(0, v - 0.05 * Math.max(0, 1 - v / 0.3) * (0.5 + 0.5 * Math.cos(6 * Math.PI * u)) + 0.02 * noise(u * 5, v * 2, 4));
      let c = mix(ramp(enamel.young, at), ramp(enamel.old, at), wear);
      if (shade) c = mix(c, hex(shade), 0.7);
      // Gaps between adjacent teeth are dark and warm.
      const side = smoothstep(0.4, 0.5, Math.abs(u - 0.5));
      c = mix(c, [160, 120, 98], 0.5 * side * side);
      return c.map((x) => x * (1 + 0.018 * noise(u * 9, v * 3)));
    },
    gum: (u, v) => ramp(gum, v).map((x) => x * (1 + 0.08 * fractal(u * 40, v * 5, 1, 3))),
    palate(u, v) {
      const folds = 0.06 * Math.sin(v * 26 + 2 * noise(u * 12, v * 4)) * smoothstep(0.15, 0.4, v);
      return ramp(palate, v).map((x) => x * (1 + folds + 0.05 * fractal(u * 20, v * 8, 5, 2)));
    },
  };
  for (let y = 0; y < size; y++) {
    for (let x = 0; x < size; x++) {
      const u = (x + 0.5) / size,
        v = 1 - (y + 0.5) / size;
      const [name, tile] = Object.entries(TILES).reduce((best, one) => (outside(one[1], u, v) < outside(best[1], u, v) ? one : best));
      const at = [0, 1].map((k) => Math.min(1, Math.max(0, ([u, v][k] - tile[k]) / tile[k + 2])));
      data.set(painters[name](...at), (y * size + x) * 3);
    }
  }
  return { size, data };
}

/** Returns the distance of a point outside of a tile. */
function outside([x, y, w, h], u, v) {
  return Math.max(x - u, u - x - w, y - v, v - y - h, 0);
}
