// SPDX-License-Identifier: GPL-3.0-or-later
/** Wisps: cards over a sheet of hair and across its borders, so that it has no outline like a cap's. */
import { fibres } from '../../../web/element/head/shading/surfaces.mjs';
import { normals } from '../lib/mesh.mjs';
import { unit } from '../lib/vector.mjs';
import { along, dice, KINDS, layCard, scatter, withCards } from './cards.mjs';

const MIDDLE = [0, 25, -70]; // of the skull, mm
const RADIUS = 95; // of what hair lies on
const TURNS = 48; // cells of directions, round and up
const UNDER = 5; // mm: what lies so far below other hair shows no wisps
const STANDING = 2; // mm: a hair whose tip is so much farther from the skull than its root and its lift stands on end
const SEED = 20260101;

/**
 * @param {object} part the hair @param {object} skin @param {(u: number, v: number) => boolean} opaque where hair is seen
 * @param {{count: number, border: number, before: number[], toward: number[], length: number[], width: number, lift: number[],
 *   near: number, above: number}} look
 *   count: over the sheet; border: on its borders, if these are within `near` mm of the skin and `above` mm high, rooted `before`
 *   mm before them;
 *   toward: where the tips point, of the two ways along the fibres; lift: mm above the hair, at root and tip
 */
export function addWisps(part, skin, look, opaque) {
  const roll = dice(SEED);
  const about = surfaceOf(part, look.toward);
  const cards = [];
  const add = (q, n, direction, [least, most], lift) => {
    const length = least + (most - least) * roll();
    const aside = (roll() - 0.5) * 0.5;
    const side = [n[1] * direction[2] - n[2] * direction[1], n[2] * direction[0] - n[0] * direction[2], n[0] * direction[1] - n[1] * direction[0]];
    const turned = unit(direction.map((x, k) => x + aside * side[k]));
    const form = { length, width: look.width * (0.75 + 0.5 * roll()), radius: RADIUS, twist: (roll() - 0.5) * 1.6,
      lift: lift.map((x) => x * (0.4 + 1.2 * roll())) };
    const card = layCard(q, n, turned, form);
    const kind = Math.floor(KINDS * roll());
    if (far(card.spine.at(-1)) - far(q) < form.lift[1] + STANDING) cards.push({ ...card, refs: [], kind });
  };
  const outer = outermost(part.position);
  const place = scatter(part, roll);
  for (let i = 0; i < look.count; i++) {
    const { q, v, at } = place();
    if (outer(q) && opaque(...at.uv)) add(q, ...about(v), look.length, look.lift);
  }
  const ends = borderOf(part, skin, opaque, look.near);
  for (let i = 0, most = cards.length + look.border; i < MOST_TRIES && cards.length < most; i++) {
    const { q, v, at } = place();
    if (q[1] < look.above || !outer(q) || !ends(q, at)) continue;
    const [n, direction] = about(v);
    const back = look.before[0] + (look.before[1] - look.before[0]) * roll();
    add(q.map((x, k) => x - back * direction[k]), n, direction, look.length.map((x) => 0.7 * x), [look.lift[0], 0.5 * look.lift[1]]);
  }
  return withCards(part, cards);
}

/** @returns {(v: number) => number[][]} the normal and the direction of the hair at a vertex */
function surfaceOf(part, toward) {
  const ns = normals(part.position, part.index, part.smooth);
  const fs = fibres({ ...part, position: Float32Array.from(part.position), vertices: part.position.length / 3 });
  return (v) => {
    const away = MIDDLE.map((x, k) => part.position[3 * v + k] - x);
    const found = [...ns.subarray(3 * v, 3 * v + 3)];
    const outward = found.reduce((sum, x, k) => sum + x * away[k], 0);
    const round = unit(away);
    const n = unit(found.map((x, k) => 0.5 * (outward < 0 ? -x : x) + 0.5 * round[k])); // leaves are folded
    const fibre = unit(along([...fs.subarray(3 * v, 3 * v + 3)], n));
    const sign = fibre.reduce((sum, x, k) => sum + x * toward[k], 0) < 0 ? -1 : 1;
    return [n, fibre.map((x) => sign * x)];
  };
}

const far = (q) => Math.hypot(...MIDDLE.map((x, k) => q[k] - x));

const MOST_TRIES = 12000;
const BESIDE = 3; // mm: so far from its border a point still counts as on it
const AROUND = 8; // directions

/**
 * Whether hair is seen to end at a point of a sheet, on the skin.
 * @returns {(q: number[], at: {uv: number[], scale: number}) => boolean}
 */
function borderOf(part, skin, opaque, near) {
  return (q, { uv: [u, v], scale }) => {
    if (!opaque(u, v)) return false;
    const bare = Array.from({ length: AROUND }, (_, i) => (2 * Math.PI * i) / AROUND)
      .filter((angle) => !opaque(u + BESIDE * scale * Math.cos(angle), v + BESIDE * scale * Math.sin(angle)));
    if (!bare.length) return false;
    const p = skin.position;
    for (let i = 0; i < p.length; i += 3) if (Math.hypot(q[0] - p[i], q[1] - p[i + 1], q[2] - p[i + 2]) < near) return true;
    return false;
  };
}

/** Whether no other hair lies far above a point, seen from the middle of the skull. */
function outermost(p) {
  const cell = (q) => {
    const d = unit(MIDDLE.map((x, k) => q[k] - x));
    const round = Math.floor(((Math.atan2(d[0], d[2]) / Math.PI + 1) / 2) * TURNS);
    return Math.floor(((d[1] + 1) / 2) * (TURNS / 2)) * (TURNS + 1) + round;
  };
  const farthest = new Map();
  for (let i = 0; i < p.length; i += 3) {
    const q = [...p.subarray(i, i + 3)];
    farthest.set(cell(q), Math.max(far(q), farthest.get(cell(q)) ?? 0));
  }
  return (q) => far(q) > (farthest.get(cell(q)) ?? 0) - UNDER;
}
