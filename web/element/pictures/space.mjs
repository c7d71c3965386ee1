// SPDX-License-Identifier: MIT
// Maps FAPs to the space in which pictures are compared, and to displacements of the anchors.

const AJAR = 60; // FAP units of opening (MNS/1024): the smaller the opening, the more a difference counts
const SEEN = 150; // opening at which the whole tongue is visible
const clamp = (x) => Math.min(1, Math.max(0, x));

/** FAP units between the lips; negative where they press. @param {ArrayLike<number>} faps by number */
export const openingOf = (faps) => -(faps[4] + faps[5]);

/**
 * Coordinates of the mouth: opening, corners, outer contour, jaw, protrusion, and the visible share of the tongue. Lengths in
 * FAP units of MNS, weighted by visibility.
 */
function mouth(f) {
  const opening = Math.max(0, openingOf(f));
  const seen = clamp(opening / SEEN);
  return [
    200 * Math.log1p(opening / AJAR),
    0.2 * (f[8] + f[9] + f[10] + f[11]),
    0.5 * f[51],
    0.5 * f[52],
    1.2 * (f[53] + f[54]),
    0.4 * (f[59] + f[60]),
    0.3 * f[3],
    0.8 * f[16],
    0.5 * f[17],
    0.25 * seen * f[44],
    0.3 * seen * f[45],
    0.15 * seen * f[46],
  ];
}

const lids = (upper, lower) => (f) => [f[upper] + f[lower]];
const SPACES = { mouth, eye_l: lids(19, 21), eye_r: lids(20, 22) };

/** @param {string} region @returns {(faps: ArrayLike<number>) => number[]} */
export const spaceOf = (region) => SPACES[region];

export const isRegion = (name) => Object.hasOwn(SPACES, name);

/**
 * Returns the displacements of a mouth's five anchors from rest: right and left corner, middle of upper and lower lip, chin.
 * @param {ArrayLike<number>} f FAPs by number @param {{MNS: number, MW: number}} fapu in pixels
 * @returns {number[][]} columns to the right, rows down
 */
export function displacements(f, { MNS, MW }) {
  const [x, y] = [MW / 1024, MNS / 1024];
  return [
    [-f[54] * x, -f[60] * y],
    [f[53] * x, -f[59] * y],
    [0, f[51] * y],
    [0, -f[52] * y],
    [0, (f[3] - f[18]) * y],
  ];
}
