// SPDX-License-Identifier: GPL-3.0-or-later
/** The hairs of cards (head/cards.mjs), in the free square of a picture of hair: columns with other hairs in each. */
import { hex, ramp } from '../../lib/color.mjs';
import { dice, KINDS } from '../cards.mjs';

const HAIRS = 8; // of a card
const SEED = 20260303;
const THICK = 0.07; // of a card's width, at the root

/** @param {{size: number, data: Float32Array}} image @param {number[]} square of withCards @param {[number, string][]} stops colours of the hair, from dark to light */
export function paintCards({ size, data }, [u, v, side], stops) {
  const colours = stops.map(([at, text]) => [at, hex(text)]);
  const roll = dice(SEED);
  const [left, top] = [Math.round(u * size), Math.round((1 - v - side) * size)];
  const texels = Math.floor(side * size);
  const column = texels / KINDS;
  const hairs = Array.from({ length: KINDS * HAIRS }, () => ({
    from: 0.12 + 0.76 * roll(), to: 0.2 + 0.6 * roll(), bow: 0.2 * (roll() - 0.5), starts: 0.12 * roll(), ends: 0.55 + 0.45 * roll(), shade: 0.35 + 0.4 * roll(),
  }));
  const middle = ramp(colours, 0.5);
  for (let j = 0; j < texels; j++)
    for (let i = 0; i < texels; i++) {
      const kind = Math.min(KINDS - 1, Math.floor(i / column));
      const [x, y] = [(i + 0.5) / column - kind, (j + 0.5) / texels];
      let [share, shade] = [0, 0.5];
      for (const hair of hairs.slice(kind * HAIRS, (kind + 1) * HAIRS)) {
        if (y < hair.starts || y > hair.ends) continue;
        const at = hair.from + (hair.to - hair.from) * y + hair.bow * Math.sin(Math.PI * y);
        const taper = Math.min(1, (hair.ends - y) / 0.5, (y - hair.starts) / 0.06);
        const here = Math.min(1, Math.max(0, (THICK * (0.35 + 0.65 * taper) - Math.abs(x - at)) * column + 0.5)) * (0.35 + 0.65 * taper);
        if (here > share) [share, shade] = [here, hair.shade];
      }
      const texel = 4 * ((top + j) * size + left + i);
      data.set(share ? ramp(colours, shade) : middle, texel);
      data[texel + 3] = 255 * share;
    }
}
