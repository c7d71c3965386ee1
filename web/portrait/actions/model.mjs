// SPDX-License-Identifier: MIT
/**
 * The unknowns that lay.mjs fits in a pose: those of speech, and corners, cheeks, nose and brows of each side. All in mm.
 */
import { SPEECH } from '../fap-moves.mjs';

/** The further unknowns: their FAPs, and the share of each. */
const MORE = {
  cornerLeft: { 12: 1, 59: 1 }, cornerRight: { 13: 1, 60: 1 }, aside: { 6: 1, 53: 1, 7: -1, 54: -1 },
  cheekLeft: { 41: 1 }, cheekRight: { 42: 1 }, nostrilLeft: { 61: 1 }, nostrilRight: { 62: 1 }, noseUp: { 63: 1 },
  browInnerLeft: { 31: 1 }, browInnerRight: { 32: 1 }, browMiddleLeft: { 33: 1 }, browMiddleRight: { 34: 1 },
  browOuterLeft: { 35: 1 }, browOuterRight: { 36: 1 },
  squeezeLeft: { 37: 1 }, squeezeRight: { 38: 1 },
};
// mm, standard deviation; of the others:
const FAR = { cheekLeft: 2, cheekRight: 2, nostrilLeft: 1.5, nostrilRight: 1.5, noseUp: 1.5 };
const USUAL = 5;
const IDLE = 0.15; // of what a pose does not ask for

export const MOVED = [...new Set([...SPEECH.moved, ...Object.values(MORE).flatMap((faps) => Object.keys(faps).map(Number))])];
const NAMES = [...SPEECH.unknowns, ...Object.keys(MORE)];

function fapsOf(q) {
  const out = new Float64Array(MOVED.length);
  out.set(SPEECH.fapsOf(q)); // they come first
  Object.values(MORE).forEach((faps, i) => {
    const mm = q[SPEECH.unknowns.length + i];
    for (const [fap, share] of Object.entries(faps)) out[MOVED.indexOf(Number(fap))] += share * mm;
  });
  return out;
}

/** @param {string[]} moves unknowns that a pose has */
export function modelOf(moves) {
  const wide = NAMES.map((name, i) => SPEECH.expected[i] ?? FAR[name] ?? USUAL);
  const expected = NAMES.map((name, i) => (moves.includes(name) ? wide[i] : Math.min(wide[i], IDLE)));
  return { unknowns: NAMES, moved: MOVED, fapsOf, expected, links: NAMES.map((_, i) => SPEECH.links[i] ?? null) };
}
