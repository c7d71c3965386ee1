// SPDX-License-Identifier: MIT
// The colour of the irises in a picture, and the heads whose irises are the most similar.
import { lab } from './lab.mjs';
import { EYES } from './landmarks.mjs';
import { sample } from './skin.mjs';

const RING = [0.5, 0.62, 0.74]; // of the iris's radius: between the pupil and its rim
const TURNS = 24; // directions, of which those that a lid covers are left out
const LID = -0.35; // upward share of a direction, beyond which it may
const GLINT = 0.25; // share of the brightest, which reflect a lamp
const LIGHTNESS = 0.5; // what a difference in lightness counts, which the light changes most

/** @param {object} picture @param {number[][]} landmarks @returns {number[]} CIELAB */
export function irisOf(picture, landmarks) {
  const seen = Object.values(EYES).flatMap(({ iris: [middle, ...rim] }) => {
    const [x, y] = landmarks[middle];
    const radius = rim.reduce((sum, i) => sum + Math.hypot(landmarks[i][0] - x, landmarks[i][1] - y), 0) / rim.length;
    return Array.from({ length: TURNS }, (_, i) => (2 * Math.PI * i) / TURNS).filter((turn) => Math.sin(turn) > LID)
      .flatMap((turn) => RING.map((r) => r * radius).map((far) =>
        lab(sample(picture, x + far * Math.cos(turn), y + far * Math.sin(turn), [0, 0, 0]))));
  }).sort((a, b) => a[0] - b[0]);
  const dull = seen.slice(0, Math.ceil((1 - GLINT) * seen.length));
  return [0, 1, 2].map((k) => dull.map((c) => c[k]).sort((a, b) => a - b)[dull.length >> 1]);
}

/** Names of heads by how similar their irises are. @param {Record<string, {iris: number[]}>} table */
export function similarEyes({ picture, landmarks }, table) {
  const seen = irisOf(picture, landmarks);
  const far = ({ iris }) => Math.hypot(LIGHTNESS * (iris[0] - seen[0]), iris[1] - seen[1], iris[2] - seen[2]);
  return Object.keys(table).filter((name) => table[name].iris).sort((a, b) => far(table[a]) - far(table[b]));
}
