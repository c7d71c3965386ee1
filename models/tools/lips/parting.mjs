// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * LI and LS by the lips' ends (edges.mjs). An end goes up and down with its lip, but not only: an upper lip that is pushed comes down over the teeth, the
 * further the fuller it is, and a lower one sinks as the corners draw together. How far lips have come forward is never seen from the
 * front, and a jaw not under lips that are closed over it.
 */
import { PARAMETERS } from './articulation.mjs';

const HANGS = 10.5; // mm for a mm of PS, of a lip as high as the mouth is wide: the mean of Samuel, Amina, Luca, Mei and Mara, 7.6 to 13.1
const ROUND = { LI: -6, LS: -4 }; // mm of AR: narrower lips have come forward, and where they end a front does not show
const HELD = 0.15; // mm of doubt about AR (lay.mjs), the median of a film: on even skin there is less to hold on to, and corners are seen to move less than they do
const LEAP = 80; // mm/s of the jaw, root mean square, where lips come to touch or part: jaws are slower
const NEAR = 0.05; // s: pictures that are farther apart show no speed
const OPEN = 0.8; // mm between both ends: under it LI is left to the skin around, which sees lips press

export const AR = PARAMETERS.indexOf('AR');
const EM = PARAMETERS.indexOf('EM');

/** How far an upper lip comes down for a mm of PS. @param {number} fullness how high it is, the mouth's width being 1 */
export const hangOf = (fullness) => HANGS * fullness;

/** How far a lower lip sinks for a mm that the mouth gets narrower, on the head that is laid on. @param {object} skin of speakerOf */
export function drawOf({ position, fdp, moved }) {
  const away = (v) => Math.hypot(...fdp['2.3'].map((x, k) => x - position[3 * v + k]));
  let middle = 0;
  for (let v = 1; 3 * v < position.length; v++) if (away(v) < away(middle)) middle = v;
  return [6, 7].reduce((sum, corner) => sum - moved(corner, -1)[3 * middle + 1] / 2, 0);
}

/**
 * @param {Float64Array} q of UNKNOWNS, as lay.mjs has them @param {{hang: number, draw: number}} ends of hangOf and drawOf
 * @param {(rises: number, falls: number) => object} look where the ends are, by where they are expected
 * @returns {{q: number[], seen: boolean[]}} q with what was seen; and of LI, LS, AR, PI, PS, EM whether it was
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
 * Whether AR is seen is told of a film as a whole: a still mouth is the surest, and who believed the sure pictures alone would take it that corners
 * hardly move. @param {object[]} rows of watch.mjs, doubt: mm about AR @returns {{rows: object[], held: boolean}}
 */
export function heldCorners(rows) {
  const doubts = rows.filter(({ values }) => values).map(({ doubt }) => doubt).sort((a, b) => a - b);
  const held = !(doubts[doubts.length >> 1] > HELD);
  return { held, rows: held ? rows : unseen(rows, AR) };
}

/**
 * So is whether EM is: on a chin that is too even the jaw is taken to go with the lips, and comes to rest wherever they touch, at once.
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
