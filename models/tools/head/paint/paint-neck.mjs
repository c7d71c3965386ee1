// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Tendons, collar bones, the hollow between them and the larynx: too fine for the mesh, so they are painted as lit on an upright neck.
 */
import { diffuse } from '../../lib/shading.mjs';
import { smoothstep } from '../../lib/zones.mjs';

const REACH = [0.75, 0.6, 0.8, 0.4]; // of sky and lamps, about the share that enters an open collar
const HOLLOW = 0.05; // darkening per mm of depth
const STEP = 0.5; // mm

const bell = (x, width) => Math.exp(-((x / width) ** 2));

/** @param {number[]} from @param {number[]} to x and y @returns position along it (0 to 1), and distance from it in mm, positive upwards */
function beside([ax, ay], [bx, by], x, y) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy);
  const along = ((x - ax) * dx + (y - ay) * dy) / length / length;
  return [along, ((y - ay) * dx - (x - ax) * dy) / length];
}

/** Relief of the skin of a neck in mm, by position in the front view. */
function relief({ fdp, point }, { tendons = 0, collar = 0, larynx = 0 }) {
  const notch = point({ group: 'joint-l-clavicle' })[1] + 3;
  const shoulder = point({ group: 'joint-l-scapula' });
  const behindEar = [fdp['10.5'][0] * 0.9, fdp['10.5'][1] - 12];
  const apple = fdp['2.1'][1] - 42;
  return (x, y) => {
    const side = Math.abs(x);
    const [along, beyond] = beside([9, notch + 2], behindEar, side, y);
    const muscle = smoothstep(-0.03, 0.06, along) * smoothstep(0.75, 0.2, along) * bell(beyond, 4 + 6 * Math.max(0, along));
    const [out, above] = beside([12, notch - 5], [shoulder[0], notch + 8], side, y);
    const shown = smoothstep(-0.08, 0.05, out) * smoothstep(1, 0.6, out);
    const bone = shown * (bell(above, 5) - 0.6 * bell(above - 11, 7));
    const hollow = bell(Math.hypot(x / 1.2, y - notch - 3), 7);
    const front = bell(Math.hypot(x, (y - apple) / 1.6), 7);
    return tendons * muscle + collar * (bone - 0.9 * hollow) + larynx * front;
  };
}

/**
 * @param {object} ctx @param {{tendons?: number, collar?: number, larynx?: number}|undefined} spec relief in mm
 * @param {number} subsurface of the skin
 * @returns {(colour: number[], q: number[], normal: number[]) => number[]}
 */
export function neckPaint(ctx, spec, subsurface) {
  if (!spec) return (colour) => colour;
  const height = relief(ctx, spec);
  const top = ctx.fdp['2.1'][1] - 12;
  return (colour, [x, y], n) => {
    if (y > top || n[2] < 0.05) return colour;
    const here = height(x, y);
    const slope = [height(x + STEP, y) - here, height(x, y + STEP) - here].map((rise) => rise / STEP);
    if (Math.abs(here) < 0.01 && Math.hypot(...slope) < 0.003) return colour;
    const bent = [n[0] - slope[0], n[1] - slope[1], n[2]];
    const length = Math.hypot(...bent);
    const [before, after] = [n, bent.map((value) => value / length)].map((normal) => diffuse('skin', subsurface, normal, REACH));
    const share = smoothstep(top, top - 15, y) * smoothstep(0.05, 0.35, n[2]);
    const deep = 1 + HOLLOW * Math.min(0, here);
    return colour.map((value, k) => value * (1 + share * ((after[k] / before[k]) ** (1 / 2.2) * deep - 1)));
  };
}
