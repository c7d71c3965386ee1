// SPDX-License-Identifier: GPL-3.0-or-later
/** The hairs of grown hair (hair/grow.mjs): a column for each kind of card, roots above, tips below. */
import { hex, ramp } from '../../lib/color.mjs';
import { dice } from '../cards.mjs';
import { COILED, FULL, SPARSE } from '../hair/grow.mjs';
import { noise } from './noise.mjs';

const SEED = 20261130;
const HAIRS = [80, 9]; // of a full card, and of a sparse one
const THICK = [0.032, 0.026]; // of a card's width
const COILS = [24, 4]; // of a full cell, and of a sparse one
const RADII = [0.11, 0.2]; // of a coil, in widths of a card
const DRAWN_OUT = 0.12; // widths of a card that a coil goes on, a turn
const TURNS = [1.2, 3];
const WIRE = 0.034; // half its thickness, in widths of a card

/**
 * @param {{size: number, strands: {ramp: [number, string][], curl?: number, gather?: number, contrast?: number, starts?: number, dark?: number, fine?: number, coils?: boolean, rope?: number}}} spec curl: waves of a hair, in widths of a card;
 *   gather: how far the tips of a card come together, 0 to 1; contrast: how much hairs differ in light;
 *   starts: share of a card within which they begin; dark: share over which it is darker between roots; fine: how many times as many hairs, and as thin;
 *   coils: in place of hairs that lie beside each other, in cells as hair/grow.mjs has them; rope: of turns along a card, whose hairs are a single loc then
 */
export function paintStrands({ size, strands: { ramp: stops, curl = 0.05, gather = 1, contrast = 1, starts: late = 0.05, dark = 0.18, fine = 1, coils, rope = 0 } }) {
  const colours = stops.map(([at, text]) => [at, hex(text)]);
  const roll = dice(SEED);
  const [shade, alpha] = [new Float32Array(size * size).fill(0.4), new Float32Array(size * size)];
  const column = size / (FULL + SPARSE);
  if (coils) for (let cell = 0; cell < COILED * (FULL + SPARSE); cell++) paintCoils({ shade, alpha, size, column, cell, roll, contrast });
  else for (let kind = 0; kind < FULL + SPARSE; kind++) {
    const sparse = kind >= FULL ? 1 : 0;
    const tone = sparse ? 0.08 : 0.16 * (roll() - 0.5); // locks differ
    if (rope && !sparse) drawRope({ turns: rope, light: 0.42 + contrast * tone, phase: 7 * roll() }, { shade, alpha, size, left: kind * column, column });
    else for (let h = 0; h < fine * HAIRS[sparse]; h++) {
      const deep = h / (fine * HAIRS[sparse]); // later ones lie above
      const hair = { from: sparse ? 0.1 + 0.8 * roll() : spread(roll, gather), bow: 0.16 * (roll() - 0.5), phase: 7 * roll(), wave: curl * (0.5 + roll()), starts: late * roll(),
        ends: 1 - 0.35 * roll() ** 1.5, thick: (THICK[sparse] / fine) * (0.7 + 0.6 * roll()), light: 0.45 + contrast * (0.3 * (deep - 0.5) + tone + 0.26 * (roll() - 0.5)) };
      hair.to = 0.5 + (hair.from - 0.5) * (1 - gather * (0.15 + 0.5 * roll())); // tips gather
      drawHair(hair, { shade, alpha, size, left: kind * column, column, late });
    }
  }
  const data = new Float32Array(size * size * 4);
  for (let i = 0; i < alpha.length; i++) {
    const y = Math.floor(i / size) / size;
    const root = coils ? 1 : 1 - 0.35 * contrast * Math.max(0, 1 - y / dark);
    const value = shade[i] * root + 0.06 * noise((i % size) / 1.7, y * 30);
    data.set(ramp(colours, Math.min(1, Math.max(0, value))), i * 4);
    data[i * 4 + 3] = 255 * alpha[i];
  }
  return { size, data };
}

const ROPE = [0.4, 0.05]; // of a card's width: half a loc's, and by how much that differs along it

/** A loc: hairs that are wound about each other. */
function drawRope({ turns, light, phase }, { shade, alpha, size, left, column }) {
  for (let j = 0; j < size; j++) {
    const y = j / size;
    const half = (ROPE[0] + ROPE[1] * Math.sin(2 * Math.PI * turns * y + phase) + ROPE[1] * noise(phase, y * 14)) * column * Math.min(1, (1 - y) / 0.02 + 0.4);
    for (let i = 0; i < column; i++) {
      const across = (i + 0.5 - column / 2) / half;
      const texel = j * size + left + i;
      alpha[texel] = Math.min(1, Math.max(0, (1 - Math.abs(across)) * half + 0.5));
      const wound = Math.sin(2 * Math.PI * turns * y + phase + 2.2 * across);
      shade[texel] = Math.max(0, light * Math.sqrt(Math.max(0.12, 1 - across * across)) + 0.13 * wound + 0.1 * noise(i / 2 + 30 * phase, y * 60));
    }
  }
}

/** A place across a card: most hairs are in the middle of a lock, and all over a card whose hairs do not gather. */
function spread(roll, gather) {
  const [a, b] = [roll(), roll()];
  return 0.5 + 0.44 * (gather * (a - b) + (1 - gather) * (2 * a - 1));
}

function drawHair({ from, to, bow, phase, wave, starts, ends, thick, light }, { shade, alpha, size, left, column, late }) {
  for (let j = Math.floor(starts * size); j < Math.min(size, ends * size); j++) {
    const y = (j + 0.5) / size;
    const at = from + (to - from) * y ** 1.4 + bow * Math.sin(Math.PI * y) + wave * Math.sin(6 * y + phase) * y;
    const taper = Math.min(1, (ends - y) / 0.25, (y - starts) / (0.6 * late) + 0.3);
    const half = thick * column * (0.3 + 0.7 * taper);
    const middle = at * column;
    for (let i = Math.max(0, Math.floor(middle - half)); i <= Math.min(column - 1, Math.ceil(middle + half)); i++) {
      const share = Math.min(1, Math.max(0, half - Math.abs(i + 0.5 - middle) + 0.5));
      if (!share) continue;
      const texel = j * size + left + i;
      const across = 1 - 0.25 * Math.abs(i + 0.5 - middle) / half; // round
      shade[texel] += share * (light * across - shade[texel]);
      alpha[texel] = Math.max(alpha[texel], share * Math.min(1, 0.55 + 0.6 * taper));
    }
  }
}

/** A tangle of coils in one cell, denser at its root; those drawn later lie above. */
function paintCoils({ shade, alpha, size, column, cell, roll, contrast }) {
  const high = size / COILED;
  const [left, top] = [(cell % (FULL + SPARSE)) * column, Math.floor(cell / (FULL + SPARSE)) * high];
  const sparse = cell % (FULL + SPARSE) >= FULL ? 1 : 0;
  for (let coil = 0; coil < COILS[sparse]; coil++) {
    const deep = coil / COILS[sparse];
    const radius = column * (RADII[0] + (RADII[1] - RADII[0]) * roll());
    const [x, y] = [radius + (column - 2 * radius) * roll(), radius + (high - 2 * radius) * roll() ** 1.3];
    const [way, phase, turns] = [2 * Math.PI * roll(), 7 * roll(), TURNS[0] + (TURNS[1] - TURNS[0]) * roll()];
    const light = 0.45 + contrast * (0.5 * (deep - 0.5) + 0.3 * (roll() - 0.5));
    const steps = Math.ceil(turns * 2 * Math.PI * radius);
    for (let step = 0; step < steps; step++) {
      const turn = (step / steps - 0.5) * turns;
      const angle = phase + 2 * Math.PI * turn;
      const drift = turn * DRAWN_OUT * column;
      const at = [x + radius * Math.cos(angle) + drift * Math.cos(way), y + radius * Math.sin(angle) + drift * Math.sin(way)];
      const lit = light * (1 - 0.3 * Math.sin(angle)); // above
      dot({ shade, alpha, size, left, top, column, high }, at, WIRE * column, lit);
    }
  }
}

/** A round dot within a cell. */
function dot({ shade, alpha, size, left, top, column, high }, [x, y], half, light) {
  for (let j = Math.max(0, Math.floor(y - half)); j <= Math.min(high - 1, y + half + 1); j++)
    for (let i = Math.max(0, Math.floor(x - half)); i <= Math.min(column - 1, x + half + 1); i++) {
      const share = Math.min(1, Math.max(0, half - Math.hypot(i + 0.5 - x, j + 0.5 - y) + 0.5));
      if (!share) continue;
      const texel = (top + j) * size + left + i;
      shade[texel] += share * (light - shade[texel]);
      alpha[texel] = Math.max(alpha[texel], share);
    }
}
