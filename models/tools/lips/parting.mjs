// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Derives LI and LS from the lips' edges (edges.mjs). An edge moves up and down with its lip, but also otherwise: a protruded upper lip comes
 * down over the teeth, more so if it is full, and a lower lip sinks as the corners draw together. Protrusion cannot be seen from
 * the front, nor can a jaw under closed lips.
 */
import { PARAMETERS } from './articulation.mjs';

const HANGS = 10.5; // mm per mm of PS, for a lip as high as the mouth is wide: the mean of Samuel, Amina, Luca, Mei and Mara, 7.6 to 13.1
const ROUND = { LI: -6, LS: -4 }; // mm of AR: narrower lips have moved forward, so the front view does not show their edges
const HELD = 0.15; // mm of uncertainty about AR (lay.mjs), median of a film: on even skin tracking underestimates the movement of the corners
const LEAP = 80; // mm/s of the jaw, RMS, when lips touch or part: real jaws are slower
const NEAR = 0.05; // s: maximum distance of pictures for measuring speed
const OPEN = 0.8; // mm between both edges: below it LI comes from the skin around, which shows pressing lips

export const AR = PARAMETERS.indexOf('AR');
const EM = PARAMETERS.indexOf('EM');

/** Returns how far an upper lip comes down per mm of PS. @param {number} fullness height relative to the mouth's width */
export const hangOf = (fullness) => HANGS * fullness;

/** Returns how far a lower lip sinks per mm of narrowing of the mouth, on the fitted head. @param {object} skin of speakerOf */
export function drawOf({ position, fdp, moved }) {
  const away = (v) => Math.hypot(...fdp['2.3'].map((x, k) => x - position[3 * v + k]));
  let middle = 0;
  for (let v = 1; 3 * v < position.length; v++) if (away(v) < away(middle)) middle = v;
  return [6, 7].reduce((sum, corner) => sum - moved(corner, -1)[3 * middle + 1] / 2, 0);
}

/**
 * @param {Float64Array} q of UNKNOWNS, from lay.mjs @param {{hang: number, draw: number}} ends of hangOf and drawOf
 * @param {(rises: number, falls: number) => object} look finds the edges, given their expected positions @returns {{q: number[], seen:
 *   boolean[]}} q, updated by the measurements; seen: whether LI, LS, AR, PI, PS, EM were measured
 */
export function parted(q, { hang, draw }, look) {
  const [LI, LS, , , PS] = q;
  const hangs = hang * Math.max(0, PS);
  const sinks = draw * Math.max(0, -q[AR]);
  const { rises, falls } = look(LS - hangs, LI + sinks);
  const out = [...q];
  if (rises !== null) out[1] = rises + hangs;
  const apart = (rises ?? LS - hangs) + (falls ?? LI + sinks);
  const closed = apart <= OPEN;
  if (falls !== null && !closed) out[0] = falls - sinks;
  const [low, high] = [q[AR] >= ROUND.LI && (closed || falls !== null), q[AR] >= ROUND.LS && rises !== null];
  return { q: out, seen: [low, high, true, false, false, !closed] };
}

const unseen = (rows, parameter) => rows.map((row) => ({ ...row, seen: row.seen.map((seen, p) => seen && p !== parameter) }));

/**
 * Decides for a whole film whether AR is visible: a still mouth gives the highest certainty, so using only certain pictures would suggest that corners hardly move.
 * @param {object[]} rows of watch.mjs, doubt: uncertainty about AR, mm @returns {{rows: object[], held: boolean}}
 */
export function heldCorners(rows) {
  const doubts = rows.filter(({ values }) => values).map(({ doubt }) => doubt).sort((a, b) => a - b);
  const held = !(doubts[doubts.length >> 1] > HELD);
  return { held, rows: held ? rows : unseen(rows, AR) };
}

/**
 * Decides the same for EM: on an even chin the tracked jaw follows the lips, and stops suddenly whenever they touch.
 * @param {object[]} rows of watch.mjs, mm @returns {{rows: object[], held: boolean}}
 */
export function heldJaw(rows) {
  const speeds = rows.flatMap(({ time, values, seen }, i) => {
    const before = rows[i - 1];
    const known = values && before?.values && time - before.time < NEAR;
    return known && seen[EM] !== before.seen[EM] ? [(values[EM] - before.values[EM]) / (time - before.time)] : [];
  });
  const held = !(Math.sqrt(speeds.reduce((sum, x) => sum + x * x, 0) / speeds.length) > LEAP);
  return { held, rows: held ? rows : unseen(rows, EM) };
}
