// SPDX-License-Identifier: GPL-3.0-or-later
/** A moustache: cards on the skin between nose and upper lip, which move as the skin at their roots. */
import { normals } from '../lib/mesh.mjs';
import { unit } from '../lib/vector.mjs';
import { along, dice, KINDS, layCard, scatter, withCards } from './cards.mjs';

const SEED = 20260202;
const RADIUS = 60; // mm, of the face there
const AHEAD = 0.25; // of normals: skin that is seen from the front

/**
 * @param {object} beard @param {object} skin @param {Record<string, number[]>} fdp
 * @param {{count: number, length: number[], width: number, lift: number[], beyond: number, over: number}} look beyond: mm from
 *   the corners of the mouth outwards; over: mm of the lip that it may cover
 */
export function addMoustache(beard, skin, fdp, look) {
  const roll = dice(SEED);
  const lip = lipLine(fdp);
  const end = Math.abs(fdp['8.3'][0]) + look.beyond;
  const top = (x) => {
    const share = Math.min(1, Math.abs(x) / end) ** 1.6;
    return (1 - share) * (fdp['9.15'][1] - 1) + share * (fdp['8.3'][1] + 3);
  };
  const ns = normals(skin.position, skin.index, skin.smooth);
  const place = scatter(skin, roll, ([x, y, z]) =>
    z > fdp['8.3'][2] - 12 && Math.abs(x) < end && y > lip(x) + 0.4 && y < top(x));
  const cards = [];
  for (let i = 0; i < look.count; i++) {
    const found = place();
    if (!found) throw new Error('there is no skin for a moustache');
    const { q, v } = found;
    const n = [...ns.subarray(3 * v, 3 * v + 3)];
    if (n[2] < AHEAD) continue; // the inside of the lip
    const out = q[0] / end;
    const direction = unit(along([1.3 * out + 0.1 * Math.sign(out) + 0.6 * (roll() - 0.5), -1, 0], n));
    const room = (q[1] - lip(q[0]) + look.over) / Math.max(0.2, -direction[1]);
    const length = Math.min(look.length[0] + (look.length[1] - look.length[0]) * roll(), room);
    const form = { length, width: look.width * (0.7 + 0.6 * roll()), radius: RADIUS, twist: (roll() - 0.5) * 0.5, lift: look.lift };
    cards.push({ ...layCard(q, n, direction, form), refs: skin.refs[v], kind: Math.floor(KINDS * roll()) });
  }
  return withCards(beard, cards);
}

/** Height of the upper lip's outer contour over x; beyond the corners it falls. */
function lipLine(fdp) {
  const points = ['8.4', '8.6', '8.1', '8.5', '8.3'].map((name) => fdp[name]).sort((a, b) => a[0] - b[0]);
  return (x) => {
    for (let i = 1; i < points.length; i++) {
      const [[x0, y0], [x1, y1]] = [points[i - 1], points[i]];
      if (x >= x0 && x <= x1) return y0 + ((y1 - y0) * (x - x0)) / (x1 - x0);
    }
    const [cx, cy] = x < 0 ? points[0] : points.at(-1);
    return cy - 1.2 * Math.abs(x - cx);
  };
}
