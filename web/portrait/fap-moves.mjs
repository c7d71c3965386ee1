// SPDX-License-Identifier: MIT
/**
 * The six articulatory parameters, with two more for lips that get thin or full, as FAPs in mm: what
 * server/face/engines/fapmap.c says, for the
 * lips of a film to be laid onto.
 */

/** Of unknowns: those of articulation.mjs, then how much thinner than told the upper and the lower lip are, mm. */
export const UNKNOWNS = ['LI', 'LS', 'AR', 'PI', 'PS', 'EM', 'thinUpper', 'thinLower'];

const SIDE_OPENING = 0.8;
const ROUND = {
  narrow: 2, push: 1.2, flareFrom: 2, flareFull: 2.8, met: 1, apart: 2.5,
  side: 2.5, share: 0.4, innerCorner: 3, drop: 1.5, low: 0.9, lowSide: 2, bulge: 0.7,
};
const CORNER_PER_JAW = -0.12;
const CORNER_PER_SPREAD = 0.12;
const CHIN_PER_PRESS = 0.5;
const CHIN_PER_PUSH = 0.2;
const CHEEK_PER_JAW = -0.06;
const CHEEK_PER_PUSH = -0.15;
const LIFT_PER_SPREAD = 0.12;
const OUTER_PER_INNER = 0.75;
const THIN_PER_SPREAD = 0.12;
const [LOW_PER_SPREAD, LOW_FROM] = [0.25, 3];

const PAIRS = [[4, 5, 51, 52], [8, 10, 55, 57], [9, 11, 56, 58]];

/** FAPs that are moved, in the order of fapsOf. */
export const MOVED = [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 16, 17, 18, 39, 40, 41, 42, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60];
const AT = new Map(MOVED.map((fap, i) => [fap, i]));

const ramp = (x) => {
  const t = Math.min(1, Math.max(0, x));
  return t * t * (3 - 2 * t);
};

/** How rounded the lips are, 0 to 1. */
const roundness = (AR, push, LS, EM) =>
  ramp(-AR / ROUND.narrow) * ramp(push / ROUND.push) * ramp((ROUND.flareFull - LS) / (ROUND.flareFull - ROUND.flareFrom)) *
  ramp((EM - ROUND.met) / (ROUND.apart - ROUND.met));

/** @param {ArrayLike<number>} q of UNKNOWNS, mm @returns {Float64Array} of MOVED, mm */
export function fapsOf([LI, LS, AR, PI, PS, EM, thinUpper, thinLower]) {
  const out = new Float64Array(MOVED.length);
  const set = (list, mm) => list.forEach((fap) => (out[AT.get(fap)] += mm));
  const spread = AR / 2;
  const jaw = Math.max(0, EM);
  const push = Math.max(0, (PI + PS) / 2);
  const corner = CORNER_PER_JAW * jaw + CORNER_PER_SPREAD * spread;
  const round = roundness(AR, (PI + PS) / 2, LS, EM);
  const open = LI + LS;
  const sides = SIDE_OPENING * (1 - ROUND.share * round) * open - ROUND.side * round;
  const side = open > 0 ? Math.max(0, sides) / open : SIDE_OPENING;
  const wider = ROUND.bulge * round - THIN_PER_SPREAD * Math.max(0, AR);
  PAIRS.forEach(([upper, lower, upperOuter, lowerOuter], i) => {
    const [part, atCorner] = i ? [side, (1 - side) * corner] : [1, 0];
    const [up, down] = [part * LS + atCorner, part * LI - atCorner];
    const low = (i ? ROUND.lowSide : ROUND.low) * round + LOW_PER_SPREAD * Math.max(0, AR) * ramp(open / LOW_FROM);
    set([upper], low - up);
    set([lower], -down - low - (i ? 0 : ROUND.drop * round));
    set([upperOuter], -(up > 0 ? OUTER_PER_INNER * up : up) - wider + thinUpper);
    set([lowerOuter], -(down > 0 ? OUTER_PER_INNER * down : down) - wider + thinLower);
  });
  set([3], EM);
  set([6, 7], spread - ROUND.innerCorner * round);
  set([53, 54], spread);
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
