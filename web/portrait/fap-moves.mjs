// SPDX-License-Identifier: MIT
/**
 * The six articulatory parameters, with two more for lips that get thin or full, as FAPs in mm: what
 * server/face/engines/fapmap.c says, for the
 * lips of a film to be laid onto.
 */

/** Of unknowns: those of articulation.mjs, then how much thinner than told the upper and the lower lip are, mm. */
export const UNKNOWNS = ['LI', 'LS', 'AR', 'PI', 'PS', 'EM', 'thinUpper', 'thinLower'];

const SIDE_OPENING = 0.8;
const SIDE_PER_MM = 0.03;
const SIDE_MIN = 0.55;
const CORNER_PER_JAW = -0.12;
const CORNER_PER_SPREAD = 0.12;
const CHIN_PER_PRESS = 0.5;
const CHIN_PER_PUSH = 0.2;
const CHEEK_PER_JAW = -0.06;
const CHEEK_PER_PUSH = -0.15;
const LIFT_PER_SPREAD = 0.12;
const OUTER_PER_INNER = 0.85;

const PAIRS = [[4, 5, 51, 52], [8, 10, 55, 57], [9, 11, 56, 58]];

/** FAPs that are moved, in the order of fapsOf. */
export const MOVED = [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 16, 17, 18, 39, 40, 41, 42, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60];
const AT = new Map(MOVED.map((fap, i) => [fap, i]));

/** @param {ArrayLike<number>} q of UNKNOWNS, mm @returns {Float64Array} of MOVED, mm */
export function fapsOf([LI, LS, AR, PI, PS, EM, thinUpper, thinLower]) {
  const out = new Float64Array(MOVED.length);
  const set = (list, mm) => list.forEach((fap) => (out[AT.get(fap)] += mm));
  const spread = AR / 2;
  const jaw = Math.max(0, EM);
  const push = Math.max(0, (PI + PS) / 2);
  const corner = CORNER_PER_JAW * jaw + CORNER_PER_SPREAD * spread;
  const side = Math.max(SIDE_MIN, SIDE_OPENING + SIDE_PER_MM * Math.min(0, AR));
  PAIRS.forEach(([upper, lower, upperOuter, lowerOuter], i) => {
    const [part, atCorner] = i ? [side, (1 - side) * corner] : [1, 0];
    const [up, down] = [part * LS + atCorner, part * LI - atCorner];
    set([upper], -up);
    set([lower], -down);
    set([upperOuter], -(up > 0 ? OUTER_PER_INNER * up : up) + thinUpper);
    set([lowerOuter], -(down > 0 ? OUTER_PER_INNER * down : down) + thinLower);
  });
  set([3], EM);
  set([6, 7, 53, 54], spread);
  set([12, 13, 59, 60], corner);
  set([16], PI);
  set([17], PS);
  set([18], CHIN_PER_PRESS * Math.max(0, -LI) + CHIN_PER_PUSH * push);
  set([39, 40], CHEEK_PER_JAW * jaw + CHEEK_PER_PUSH * push);
  set([41, 42], LIFT_PER_SPREAD * Math.max(0, spread));
  return out;
}

/**
 * The prior of the fit, from speech of four languages made here: the lower lip follows the jaw, lips are pushed forward as the
 * mouth gets narrow, mm per mm; and standard deviations in mm, wide for movements that are visible from the front.
 */
const WITH = { LI: ['EM', 0.8], PI: ['AR', -0.155], PS: ['AR', -0.215] };
const EXPECTED = [3, 4, 8, 0.6, 0.35, 8, 0.4, 0.4];
const LINKS = UNKNOWNS.map((name) => (WITH[name] ? { to: UNKNOWNS.indexOf(WITH[name][0]), share: WITH[name][1] } : null));

/** The unknowns of speech, for lay.mjs. */
export const SPEECH = { unknowns: UNKNOWNS, moved: MOVED, fapsOf, expected: EXPECTED, links: LINKS };
