// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Grows a head of hair: cards of many hairs each, rooted all over the scalp, which follow the way the hair is combed. The scalp
 * below them is painted (paint-skin.mjs), so that no sheet of hair is needed, and the hairline is made of strands.
 */
import { cross, dot, plus, unit } from '../../lib/vector.mjs';
import { smoothstep } from '../../lib/zones.mjs';
import { dice, scatter } from '../cards.mjs';
import { noise } from '../paint/noise.mjs';
import { bodyOf } from './body.mjs';
import { beside, hangingHair } from './hang.mjs';
import { aboveLine, along, azimuth, skullOf } from './skull.mjs';

const SEED = 20261129;
const STEPS = 12; // of a hair, before it becomes a card
const SUNK = 0.8; // mm that a root lies below the skin
const LEAST = 4; // mm: a shorter hair is none
const LOCK = 16; // mm: hairs that start within it go alike
const LOCKED = 0.15; // of their way
const UNEVEN = 3; // mm by which the hairline is
const LOBES = -5; // mm: below, hair does not go through ears
const TWIST = 0.5; // of cards, out of the surface
const TRIES = 30; // for each card
const STEADIED = 12; // times that the normals along a hanging card are averaged
const EVEN = 0.3; // of the rows of a card lie at even distances, the others where it bends
const NARROW = 0.2; // of its width, at its root
const SKIPPED = 0.03; // of the picture: beside a parting all hairs of a card begin at once
const PARTED = 0.8; // mm from a parting, within which no hair grows

/** Columns of the picture: full cards, then sparse ones. */
export const FULL = 6;
export const SPARSE = 2;
/** Rows of the picture for coils, whose cards are about as long as wide: other ones in each. */
export const COILED = 4;

const flat = (v, n) => plus(v, n, -dot(v, n));

/**
 * @param {object} skin @param {object[]} below what else long hair lies on @param {Record<string, number[]>} fdp
 * @param {{line: number[][], cut?: number[][], ragged?: number, comb: object[], layers: object[], hangs?: Hanging, knot?: Knot, braids?: {wide: number, gap: number}, coiled?: boolean}} style
 *   line: the hairline, and cut: where hair ends, as [degrees round the skull, mm above the eyes]; ragged: how unevenly it does; comb: see combed; layers: see layerOf;
 *   braids: close to the head, from front to back: mm from one to the next, and the share of it in which no hair grows; coiled: its picture has coils
 * @typedef {{centre: number[], radius: number, count: number, width: number}} Knot hair that is wound into a ball
 * @typedef {{parting: {x: number, behind: number}, clear: number[][], front: number[][], curl?: number[], waves?: number[]}} Hanging long hair. parting: x of
 *   the line that hair falls from to both sides, as far back as z = behind; clear: half the width of the face that hair leaves free, as [mm above the eyes, mm];
 *   front: how far in front of the eyes it comes beside it, likewise;
 *   curl: mm by which tips bend inwards, over the last mm above the cut; waves: mm aside, and mm long
 * @returns {object} a part
 */
export function growHair(skin, below, fdp, style) {
  const roll = dice(SEED);
  const ear = earOf(fdp);
  const skull = style.hangs ? bodyOf([skin, ...below], ear) : skullOf(skin, ear);
  const cards = [];
  for (const layer of style.layers) cards.push(...layerOf(layer, { skin, ear, skull, style, roll }));
  if (style.knot) cards.push(...knotOf(style.knot, roll));
  return partOf(cards, skull, fdp['7.1'], style.coiled);
}

/** Whether a point belongs to an ear, of which hair leaves some free. */
export function earOf(fdp) {
  return (q) => {
    const side = q[0] > 0 ? 0 : 1;
    const [top, lobe] = ['10.1', '10.5'].map((name) => fdp[side ? name.replace(/\d$/, (x) => Number(x) + 1) : name]);
    const middle = top.map((x, k) => (x + lobe[k]) / 2);
    const out = Math.abs(q[0]) - 0.84 * Math.abs(middle[0]);
    return out > 0 && Math.hypot((q[1] - middle[1]) / 36, (q[2] - middle[2] + 6) / 26) < 1;
  };
}

/**
 * @param {{count: number, width: number, length: number[], crown?: number[], rise: number[], lay: number, lift: number[], fall?: number, rows: number, from?: number, to?: number, sparse?: boolean, wild?: number}} layer
 *   length: mm at the sides, least and most; crown: the same on the top; rise: how steeply hair leaves the skin, at the sides and on the top; lay: how soon it follows the comb;
 *   lift: mm that it keeps from the skin, at the sides and on the top; fall: how much tips hang; rows: of a card; from, to: mm above the hairline
 *   within which it is rooted; sparse: single hairs; wild: how far it strays from the comb
 */
function layerOf(layer, { skin, ear, skull, style, roll }) {
  const { from = 0, to = 1e3 } = layer;
  const inside = (q) => {
    const above = aboveLine(style.line, q) + (layer.sparse ? 0 : UNEVEN * noise(q[0] / 6, q[1] / 6, q[2] / 6));
    if (above < from || above > to || ear(q) || betweenBraids(style.braids, q)) return false;
    if (!style.hangs) return true;
    const aside = Math.abs(beside(style.hangs.parting, q));
    return aside < (layer.parting ?? Infinity) && (aside > PARTED || q[2] < style.hangs.parting.behind);
  };
  const place = scatter(skin, roll, (q) => aboveLine(style.line, q) > from - 12 && !ear(q));
  const out = [];
  for (let i = 0; out.length < layer.count && i < TRIES * layer.count; i++) {
    const { q } = place();
    if (!inside(q)) continue;
    const hair = (style.hangs ? hangingHair : hairFrom)(q, layer, { skull, ear, style, roll, combed });
    if (!hair) continue;
    out.push({ ...hair, width: layer.width * (0.45 + 0.9 * roll()), twist: (roll() - 0.5) * (style.hangs ? 0.5 : 1) * TWIST, rows: layer.rows, skip: layer.parting ? SKIPPED : 0,
      kind: layer.sparse ? FULL + Math.floor(SPARSE * roll()) : Math.floor(FULL * roll()) });
  }
  return out;
}

const ROUND = 90; // mm: how far the skull's top is from its middle
const WOUND = [1.6, 2.8]; // rad that hair goes round a knot

/** Whether a point is bare between two braids, which lie beside each other as meridians do. */
function betweenBraids(braids, q) {
  if (!braids) return false;
  const across = (ROUND * Math.atan2(q[0], Math.max(1, q[1] + 30))) / braids.wide;
  return Math.abs(across - Math.round(across)) > (1 - braids.gap) / 2;
}

/** Hair that is wound into a ball: cards round it, each about its own axis, the axes near to each other. */
function knotOf({ centre, radius, count, width }, roll) {
  return Array.from({ length: count }, () => {
    const axis = unit([0.9 * (roll() - 0.5), 0.35 + 0.5 * roll(), 0.8 + 0.4 * (roll() - 0.5)]);
    const first = unit(flat([roll() - 0.5, roll() - 0.5, roll() - 0.5], axis));
    const [aside, tilt] = [cross(axis, first), 1.5 * (roll() - 0.5)];
    const [wound, far] = [WOUND[0] + (WOUND[1] - WOUND[0]) * roll(), radius * (0.86 + 0.18 * roll())];
    const spine = Array.from({ length: STEPS + 1 }, (_, i) => {
      const turn = (wound * i) / STEPS;
      const out = unit(plus(plus(first.map((x) => x * Math.cos(turn)), aside, Math.sin(turn)), axis, tilt));
      return plus(centre, out, far);
    });
    return { spine, about: centre, width: width * (0.6 + 0.8 * roll()), twist: 0.3 * (roll() - 0.5) * TWIST, rows: 6, skip: 0, kind: Math.floor(FULL * roll()) };
  });
}

function hairFrom(root, layer, { skull, ear, style, roll }) {
  const { ragged = 5 } = style;
  const n = skull.normal(root);
  const top = smoothstep(40, 85, root[1]);
  const bounds = [0, 1].map((k) => layer.length[k] + top * ((layer.crown ?? layer.length)[k] - layer.length[k]));
  const length = bounds[0] + (bounds[1] - bounds[0]) * roll();
  const here = ([sides, crown = sides]) => sides + top * (crown - sides);
  const lift = here(layer.lift) * (0.6 + 0.8 * roll());
  const lock = [0, 1, 2].map((k) => LOCKED * noise(root[0] / LOCK + 40 * k, root[1] / LOCK, root[2] / LOCK)); // shared by neighbours
  const stray = lock.map((x) => x + (roll() - 0.5) * 2 * (layer.wild ?? 0.2));
  const first = combed(style.comb, root, n);
  let way = unit(plus(plus(first, stray), n, here(layer.rise) * (0.7 + 0.6 * roll())));
  let q = skull.lifted(root, -SUNK);
  const spine = [q];
  const step = length / STEPS;
  let gone = 0;
  for (let i = 0; i < STEPS; i++) {
    q = plus(q, way, step);
    const s = (i + 1) / STEPS;
    const least = lift * Math.sin(Math.PI * Math.min(0.5, s * 0.9));
    const short = least - skull.height(q);
    if (short > 0) q = skull.lifted(q, short);
    if (style.cut && q[1] < along(style.cut, azimuth(q)) + ragged * (stray[0] + stray[1] + noise(root[0] / 9, root[1] / 9, root[2] / 9))) break;
    if (q[1] < LOBES && ear(q)) break;
    gone += step;
    spine.push(q);
    const out = skull.normal(q);
    const wanted = unit(plus(plus(combed(style.comb, q, out), stray, 0.7), [0, -1, 0], (layer.fall ?? 0) * s));
    way = unit(plus(way.map((x) => (1 - layer.lay) * x), wanted, layer.lay));
    const leaves = dot(way, out);
    if (leaves > 0 && s > 0.3) way = unit(plus(way, out, -leaves * layer.lay)); // it lies down
  }
  return gone >= LEAST && spine.length > 2 ? { spine } : null;
}

/**
 * The direction that hair is combed in at a point, along the skin.
 * @param {(({toward: number[]}|{whorl: number[]}) & {weight?: number, above?: number[]})[]} comb
 *   toward: everywhere the same, aside: on the right half the mirror image; whorl: away from a point of the crown; above: heights in mm between which the weight grows
 */
function combed(comb, q, n, side = 1) {
  let sum = [0, 0, 0];
  for (const { toward, aside, whorl, weight = 1, above } of comb) {
    const share = weight * (above ? smoothstep(above[0], above[1], q[1]) : 1);
    if (!share) continue;
    sum = plus(sum, toward ?? (aside && [side * aside[0], aside[1], aside[2]]) ?? unit(flat(q.map((x, k) => x - whorl[k]), n)), share);
  }
  return unit(flat(sum, n));
}

/**
 * Where the rows of a card lie on its spine, in steps: an outline of few triangles is round if they stand where it bends.
 * @returns {number[]}
 */
export function rowsOf(spine, count) {
  const ways = spine.slice(1).map((q, i) => unit(plus(q, spine[i], -1)));
  const bends = ways.map((way, i) => (i ? Math.acos(Math.min(1, dot(way, ways[i - 1]))) : 0));
  const all = bends.reduce((sum, x) => sum + x, 0) || 1;
  const shares = ways.map((_, i) => EVEN / ways.length + ((1 - EVEN) * (bends[i] + (bends[i + 1] ?? 0))) / 2 / all);
  const whole = shares.reduce((sum, x) => sum + x, 0);
  const rows = [];
  let [i, gone] = [0, 0];
  for (let row = 0; row < count; row++) {
    const wanted = (whole * row) / (count - 1);
    while (i < shares.length - 1 && gone + shares[i] < wanted) gone += shares[i++];
    rows.push(Math.min(spine.length - 1, i + (wanted - gone) / shares[i]));
  }
  return rows;
}

/** Normals along a card, the same without sudden turns, which would crumple it. */
function steady(normals) {
  let out = normals;
  for (let pass = 0; pass < STEADIED; pass++)
    out = out.map((n, i) => unit(plus(plus(n, out[Math.max(0, i - 1)], 0.5), out[Math.min(out.length - 1, i + 1)], 0.5)));
  return out;
}

/** Cards become triangles: narrow at the root, widest in the middle. */
function partOf(cards, skull, pivot, coiled) {
  const [position, uv, index, refs, lags] = [[], [], [], [], []];
  cards.forEach(({ spine, sway, about, width, twist, rows, skip, kind }, card) => {
    const first = position.length / 3;
    const [cells, cell] = coiled ? [COILED, card % COILED] : [1, 0];
    const outward = sway ? steady(spine.map(skull.lying ?? skull.normal)) : null;
    const places = sway ? rowsOf(spine, rows) : Array.from({ length: rows }, (_, row) => (row / (rows - 1)) * (spine.length - 1));
    places.forEach((at, row) => {
      const share = at / (spine.length - 1);
      const i = Math.min(spine.length - 2, Math.floor(at));
      const q = plus(spine[i], plus(spine[i + 1], spine[i], -1), at - i);
      const way = unit(plus(spine[Math.min(spine.length - 1, i + 1)], spine[Math.max(0, i - (at === i ? 1 : 0))], -1));
      let n = skull.normal(q);
      if (about) n = unit(plus(q, about, -1));
      else if (outward) n = unit(plus(outward[i].map((x) => (1 - at + i) * x), outward[i + 1], at - i));
      const side = unit(plus(cross(way, n), n, twist));
      const half = (width / 2) * (row || !sway ? 0.75 + 0.25 * Math.sin(Math.PI * share) : NARROW);
      for (const sign of [-1, 1]) {
        position.push(...plus(q, side, sign * half));
        uv.push((kind + 0.5 + sign * 0.47) / (FULL + SPARSE), (cell + 0.995 - skip - (0.99 - skip) * share) / cells);
        refs.push([]);
        if (sway) lags.push(sway[i] + (at - i) * (sway[i + 1] - sway[i]));
      }
      if (row) {
        const a = first + 2 * row - 2;
        index.push(a, a + 1, a + 2, a + 1, a + 3, a + 2);
      }
    });
  });
  return { name: 'hair', position: Float64Array.from(position), uv, index, refs, smooth: null, moves: [], turns: [], ...(lags.length ? { sway: { pivot, weights: lags } } : {}) };
}
