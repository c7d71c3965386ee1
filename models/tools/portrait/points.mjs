// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Finds the landmarks of a built head: their positions detected in its portrait, and the points of the skin visible there.
 */
import { align, upright } from '../../../web/portrait/align.mjs';
import { STEADY } from '../../../web/portrait/landmarks.mjs';
import { WORN } from '../../../web/portrait/portrait.mjs';
import { hairOf, lightOf } from '../../../web/portrait/hair.mjs';
import { luma } from '../../../web/portrait/lab.mjs';
import { irisOf } from '../../../web/portrait/iris.mjs';
import { linear, tonesOf } from '../../../web/portrait/skin.mjs';
import { textures } from './images.mjs';
import { hairForm, measure } from '../../../web/portrait/traits.mjs';
import { seenAt } from '../lib/portrait.mjs';

const ASIDE = 5; // pixels: a landmark this close to the skin counts as on it
const DEPTH = 18; // mm: a point farther from the detector's estimate is wrong (seen between the lids, for example)

/** Returns the point of the skin at a column and row: the nearest of all triangles there, or else the nearest corner beside it. */
function placeUnder(skin, screen, [u, v], guess) {
  let [best, depth] = [null, Infinity];
  const { position: p, index } = skin;
  for (let t = 0; t < index.length; t += 3) {
    const corners = [index[t], index[t + 1], index[t + 2]];
    const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners.map((c) => screen[c]);
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (area >= 0) continue; // seen from behind
    const wa = ((bx - u) * (cy - v) - (by - v) * (cx - u)) / area;
    const wb = ((cx - u) * (ay - v) - (cy - v) * (ax - u)) / area;
    const w = [wa, wb, 1 - wa - wb];
    if (w.some((x) => x < 0)) continue;
    const far = w[0] * az + w[1] * bz + w[2] * cz;
    if (far >= depth) continue;
    depth = far;
    best = [0, 1, 2].map((k) => corners.reduce((sum, c, i) => sum + w[i] * p[c * 3 + k], 0));
  }
  if (best && (guess === null || Math.abs(best[2] - guess) < DEPTH)) return best;
  let least = ASIDE;
  best = null;
  screen.forEach(([x, y], i) => {
    const far = Math.hypot(x - u, y - v);
    if (far < least && (guess === null ? p[i * 3 + 2] > -60 : Math.abs(p[i * 3 + 2] - guess) < DEPTH)) [least, best] = [far, [p[i * 3], p[i * 3 + 1], p[i * 3 + 2]]];
  });
  return best;
}

const LIT = 0.4; // where it cannot be measured

/** By how much the hair's painted colour is darker than it is drawn. */
export async function litOf(head, picture, landmarks) {
  const hair = head.parts.find(({ name }) => name.startsWith('hair'));
  const { colour } = hairOf(picture, landmarks);
  if (!hair || !colour) return LIT;
  const image = await textures.read(head.textures[head.materials[hair.material].texture]);
  return Math.round(100 * (lightOf(image, linear) / luma(colour))) / 100;
}

/**
 * @param {object} head unpacked (lib/deform.mjs) @param {{width: number, height: number, data: Uint8Array}} picture its neutral portrait
 * @param {(picture: object) => Promise<number[][]>} eye
 * @returns {Promise<import('../../../web/portrait/fit.mjs').Points>}
 */
export async function pointsOf(head, picture, eye) {
  const landmarks = await eye(picture);
  const skin = head.parts.find(({ name }) => name === 'skin');
  const corners = Array.from({ length: skin.position.length / 3 }, (_, i) => [...skin.position.slice(3 * i, 3 * i + 3)]);
  const screen = seenAt(head, picture, corners);
  const first = landmarks.map((place) => placeUnder(skin, screen, place, null));
  const up = upright(landmarks);
  const onto = align(up, first.map((p) => p ?? [0, 0, 0]), STEADY.filter((i) => first[i] && Math.abs(first[i][0]) < 55));
  const seen = up.map(onto.apply);
  const at = landmarks.map((place, i) => placeUnder(skin, screen, place, seen[i][2]));
  const worn = WORN.filter((word) => head.parts.some(({ name }) => name.startsWith(word)));
  return { at, seen, ...tonesOf(picture, landmarks), iris: irisOf(picture, landmarks), worn, hair: hairForm(measure(picture, landmarks)), lit: await litOf(head, picture, landmarks) };
}
