// SPDX-License-Identifier: GPL-3.0-or-later
/** What cloth has on it, in millimetres: folds from the armpits, seams of shoulders and sleeves, hems, buttons, and how it is woven or knitted. */
import { smoothstep } from '../../lib/zones.mjs';
import { nearestHem } from '../body/edges.mjs';
import { fractal, noise } from './noise.mjs';

const HEM_REACH = 26; // mm
const GROOVE = 1.1; // mm: half the width of a seam's groove
const STITCH = 3.4; // mm from one to the next
const BUTTON = 5.2; // mm, its radius
const BETWEEN = 82; // mm from button to button

const bell = (x, width) => Math.exp(-((x / width) ** 2));
const wave = (x) => 0.5 + 0.5 * Math.cos(2 * Math.PI * x);

/** Heights over the surface in mm, by how a texture's place (mm along it and up) lies. */
const STRUCTURES = {
  plain: (u, v) => 0.5 * noise(u / 0.9, v / 2.6) + 0.4 * noise(u / 2.6, v / 0.9),
  twill: (u, v) => 0.8 * wave((u + v) / 2.2) - 0.4 + 0.4 * noise(u / 2, v / 2),
  knit: (u, v) => 1.3 * wave(u / 3.4) * wave((v + 1.6 * Math.abs((((u / 3.4) % 1) + 1) % 1 - 0.5) * 2) / 2.6) - 0.4,
  rib: (u, v) => 1.6 * wave(u / 7) - 0.8 + 0.3 * wave(v / 2.4),
};

/** Folds as they hang from shoulders and are drawn together at the armpits. */
export function foldsOf({ point, warp }, strength) {
  const shoulder = warp(point({ group: 'joint-l-shoulder' }));
  const armpit = [shoulder[0] - 12, shoulder[1] - 84];
  return ([x, y, z]) => {
    const side = Math.abs(x);
    const [dx, dy] = [side - armpit[0], y - armpit[1]];
    const far = Math.hypot(dx, dy);
    const turn = Math.atan2(dy, -dx) + 0.5 * noise(side / 40, y / 40, x > 0 ? 3 : 7);
    const fan = Math.cos(turn * 8) * Math.exp(-far / 62) * smoothstep(4, 26, far) * smoothstep(shoulder[1] + 40, shoulder[1] - 40, y);
    const hanging = fractal(x / 34, y / 150, z / 60, 2) * smoothstep(shoulder[1] + 20, shoulder[1] - 140, y);
    const sleeve = smoothstep(armpit[0] - 6, armpit[0] + 14, side) * smoothstep(shoulder[1], shoulder[1] - 70, y);
    const across = fractal(side / 46, (y + 0.55 * side) / 17, z / 46, 2) * sleeve;
    return strength * (2.6 * fan + 4.2 * hanging + 3 * across);
  };
}

/** Seams: grooves (negative) with a swelling on both sides. */
function seamsOf({ point, warp }) {
  const shoulder = warp(point({ group: 'joint-l-shoulder' }));
  const groove = (far) => (Math.abs(far) > 9 ? 0 : 0.35 * bell(Math.abs(far) - 3.2, 2) - bell(far, GROOVE));
  return ([x, y, z]) => {
    const side = Math.abs(x);
    const top = y > shoulder[1] + 22 && side < shoulder[0] - 4 ? groove(z - shoulder[2] - 6 - 0.06 * side) : 0;
    const sleeve = y > shoulder[1] - 78 ? groove(side - shoulder[0] + 12 - 0.16 * (y - shoulder[1])) : 0;
    return Math.abs(top) > Math.abs(sleeve) ? top : sleeve;
  };
}

/** A hem: a band with a groove, or, narrow, a line of stitches. */
function hemOf({ width, band }, far, along) {
  if (far > width + 4) return 0;
  const line = -bell(far - width, band ? 1.1 : 0.8) * (band ? 1 : 0.4 + 0.6 * wave(along / STITCH));
  return line + (band && far < width ? 0.3 : 0) - 0.5 * bell(far, 0.8);
}

/** Buttons and the edge of what they close. @returns {[number, number]} height, and how much of a button there is */
function placketOf({ from, half }, x, y) {
  if (y > from) return [0, 0];
  const down = from - 14 - y;
  const nearest = Math.max(0, Math.round(down / BETWEEN)) * BETWEEN;
  const far = Math.hypot(x, down - nearest);
  const holes = Math.min(...[[-1.1, -1.1], [1.1, -1.1], [-1.1, 1.1], [1.1, 1.1]].map(([a, b]) => Math.hypot(x - a, down - nearest - b)));
  const button = smoothstep(BUTTON + 0.5, BUTTON - 0.5, far);
  const rim = -1.4 * bell(far - BUTTON - 0.7, 0.8) + button * (0.6 * bell(far - BUTTON + 1.3, 0.8) - 1.5 * bell(holes, 0.5));
  const edge = -1.1 * bell(x - half, 0.9) - 0.35 * bell(Math.abs(x) - half + 4, 0.7) * (0.4 + 0.6 * wave(y / STITCH));
  return [rim + edge * (1 - button), button];
}

/**
 * @param {object} ctx @param {object} part laid out @param {{folds?: number, structure?: string, depth?: number, hem?: object, placket?: object}} spec
 * @returns {{folds: (q: number[]) => number, fine: (q: number[], u: number, v: number) => [number, number]}} mm of folds, which light models; of all that is finer,
 *   which darkens its depths, and how much of it is a button
 */
export function clothRelief(ctx, part, { folds = 1, structure = 'plain', depth = 1, hem = { width: 4, band: false }, placket }) {
  const [seams, hemAt, woven] = [seamsOf(ctx), nearestHem(part, HEM_REACH), STRUCTURES[structure]];
  return {
    folds: foldsOf(ctx, folds),
    fine: (q, u, v) => {
      const [far, along] = hemAt(q);
      const [closed, button] = placket && q[2] > placket.before ? placketOf(placket, q[0] - (placket.x ?? 0), q[1]) : [0, 0];
      const banded = hem.band && far < hem.width ? STRUCTURES[hem.structure ?? structure](u, v) : woven(u, v);
      return [depth * banded * (1 - button) + seams(q) * (1 - button) + hemOf(hem, far, along) + closed, button];
    },
  };
}
