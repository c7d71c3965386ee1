// SPDX-License-Identifier: GPL-3.0-or-later
/** Tendons, collar bones, the hollow between them and the larynx: the base mesh has a plain neck. */
import { normals } from '../../lib/mesh.mjs';
import { smoothstep } from '../../lib/zones.mjs';
import { refine } from '../refine.mjs';

/** How much of the relief is the mesh's; what is finer than its edges is painted (paint-neck.mjs). */
export const MODELLED = 0.55;
const EDGE = 12; // mm: longer ones are split where the relief is
const SPREAD = 34; // mm below the notch, to which it reaches

const [CLOSE, CLEAR] = [10, 24]; // mm from the nearest vertex of clothes: there, what would stand out stays flat; from there on it stands out

const bell = (x, width) => Math.exp(-((x / width) ** 2));

/** @param {number[]} from @param {number[]} to x and y @returns position along it (0 to 1), and distance from it in mm, positive upwards */
function beside([ax, ay], [bx, by], x, y) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy);
  const along = ((x - ax) * dx + (y - ay) * dy) / length / length;
  return [along, ((y - ay) * dx - (x - ax) * dy) / length];
}

/** Relief of the skin of a neck in mm, by position in the front view. @param {{tendons?: number, collar?: number, larynx?: number}} spec mm */
export function neckRelief({ fdp, point }, { tendons = 0, collar = 0, larynx = 0 }) {
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

/** Below the chin, and in front. */
export const neckShare = ({ fdp }, y, forward) => {
  const top = fdp['2.1'][1] - 12;
  return smoothstep(top, top - 15, y) * smoothstep(0.05, 0.35, forward);
};

/** Gives the skin that relief. @param {object} part the skin @param {object|undefined} clothes which lie over it @param {object|undefined} spec see neckRelief */
export function modelNeck(part, ctx, clothes, spec) {
  if (!spec) return part;
  const notch = ctx.point({ group: 'joint-l-clavicle' })[1];
  const [low, high] = [notch - SPREAD, ctx.fdp['2.1'][1] - 12];
  const on = ({ position: p }, n, v) => p[3 * v + 1] > low && p[3 * v + 1] < high && n[3 * v + 2] > 0.05;
  const before = normals(part.position, part.index, part.smooth);
  const long = ({ position: p }, a, b) => Math.hypot(p[3 * a] - p[3 * b], p[3 * a + 1] - p[3 * b + 1], p[3 * a + 2] - p[3 * b + 2]) > EDGE;
  const fine = refine(part, (a, b) => on(part, before, a) && on(part, before, b) && long(part, a, b));
  const height = neckRelief(ctx, spec);
  const bare = away(clothes);
  const n = normals(fine.position, fine.index, fine.smooth);
  for (let v = 0; v < fine.position.length / 3; v++) {
    const [x, y] = fine.position.subarray(3 * v, 3 * v + 2);
    const share = MODELLED * neckShare(ctx, y, n[3 * v + 2]) * smoothstep(low - 10, low + 10, y);
    const out = share && share * height(x, y);
    const shift = out > 0 ? out * bare(fine.position.subarray(3 * v, 3 * v + 3)) : out;
    for (let k = 0; shift && k < 3; k++) fine.position[3 * v + k] += shift * n[3 * v + k];
  }
  return fine;
}

/** 0 where clothes lie on the skin, which it must not pierce, to 1. */
function away(clothes) {
  if (!clothes) return () => 1;
  const { position: c } = clothes;
  return (q) => {
    let least = Infinity;
    for (let i = 0; i < c.length; i += 3) least = Math.min(least, Math.hypot(c[i] - q[0], c[i + 1] - q[1], c[i + 2] - q[2]));
    return smoothstep(CLOSE, CLEAR, least);
  };
}
