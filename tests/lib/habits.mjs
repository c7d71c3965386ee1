// SPDX-License-Identifier: GPL-3.0-or-later
/** A head with individual movements unknown to the tools, its poses, and a measure of how differently another head's skin moves. */
import { pose, unitLength } from '../../models/tools/lib/deform.mjs';
import { nearestVertex } from '../../models/tools/lib/mesh.mjs';
import { fitShape } from '../../web/portrait/fit.mjs';
import { EYES, LOWER_LIP, UPPER_LIP } from '../../web/portrait/landmarks.mjs';
import { POSES } from '../../web/portrait/actions/poses.mjs';

const skinOf = (head) => head.parts.find(({ name }) => name === 'skin');

/** Makes the skin around a place move with a FAP: mm per mm. */
function along(head, fap, sign, middle, reach, by) {
  const { position, moves } = skinOf(head);
  const [vertices, deltas] = [[], []];
  for (let v = 0; v < position.length / 3; v++) {
    const far = Math.hypot(...middle.map((x, k) => position[3 * v + k] - x));
    if (far >= reach) continue;
    vertices.push(v);
    deltas.push(...by.map((x) => x * (0.5 + 0.5 * Math.cos((Math.PI * far) / reach))));
  }
  moves.push({ fap, sign, vertices, deltas });
}

/** Adds individual movements: smiles pull the mouth corners and the skin beside them outwards, inner brows part as they rise, a frown lowers the middle brows, corners sink as the mouth opens. */
export function withHabits(head) {
  const { fdp } = head;
  for (const [out, corner, innerBrow, middleBrow, raise, inner, squeeze] of [[1, '8.3', '4.1', '4.3', 59, 31, 37], [-1, '8.4', '4.2', '4.4', 60, 32, 38]]) {
    const [x, y, z] = fdp[corner];
    along(head, raise, 'positive', fdp[corner], 18, [out * 0.4, 0, 0]);
    along(head, raise, 'positive', [x + out * 14, y + 10, z - 8], 22, [out * 0.5, 0.3, 0]);
    along(head, inner, 'positive', fdp[innerBrow], 18, [out * 0.35, 0, 0]);
    along(head, squeeze, 'positive', fdp[middleBrow], 20, [0, -0.6, 0]);
    along(head, 3, 'positive', fdp[corner], 20, [-out * 0.15, -0.2, 0]);
  }
  return head;
}

/** Intensities of the poses shown; the table defines the poses. */
const SHOWN = { smile: 0.8, 'brows-up': 1.1, 'brows-down': 0.9, open: 0.7, kiss: 0.9, sad: 0.5 };
/** Poses that no picture shows: half intensity, one side, combinations. */
const OTHERS = {
  'half a smile': { 6: 2, 7: 2, 53: 2, 54: 2, 12: 2.5, 13: 2.5, 59: 2.5, 60: 2.5, 41: 1, 42: 1 },
  'a smile to the left': { 6: 3, 53: 3, 12: 4, 59: 4, 41: 2 },
  'inner brows': { 31: 4, 32: 4 },
  'a smiling a': { 3: 7, 5: -6, 10: -5, 11: -5, 52: -5, 57: -5, 58: -5, 6: 2, 7: 2, 53: 2, 54: 2, 12: 3, 13: 3, 59: 3, 60: 3 },
};
export const posesOf = () => Object.fromEntries(Object.entries(SHOWN).map(([name, strength]) => [name, Object.fromEntries(Object.entries(POSES[name].faps).map(([fap, value]) => [fap, strength * value]))]));
const values = (head, poses) => Object.fromEntries(Object.entries(poses).map(([name, mm]) => [name, Object.fromEntries(Object.entries(mm).map(([fap, x]) => [fap, x / unitLength(head, fap)]))]));
export const othersOf = (head) => values(head, OTHERS);

/**
 * Measures how differently the skin moves from that of another head with the same FAPs, seen from the front, in mm of the other head.
 * @param {object} head @param {object} truth both unpacked @param {object} faps @param {number[][]} places pairs of the same place on both
 * @returns {{rms: number, moved: number}} over places that move by more than 0.3 mm on either head
 */
export function otherwise(head, truth, faps, places) {
  const gone = (one, scale) => {
    const { position } = skinOf(one);
    return pose(one, skinOf(one), faps).map((x, i) => scale * (x - position[i]));
  };
  const [a, b] = [gone(head, truth.fapu.ES / head.fapu.ES), gone(truth, 1)];
  let [sum, all, count] = [0, 0, 0];
  for (const [v, w] of places) {
    const [here, there] = [a.subarray(3 * v, 3 * v + 2), b.subarray(3 * w, 3 * w + 2)];
    if (Math.max(Math.hypot(...here), Math.hypot(...there)) < 0.3) continue;
    sum += Math.hypot(here[0] - there[0], here[1] - there[1]) ** 2;
    all += Math.hypot(...there) ** 2;
    count++;
  }
  return { rms: Math.sqrt(sum / count), moved: Math.sqrt(all / count) };
}

const MOVING = new Set([...UPPER_LIP.slice(1).flat(), ...LOWER_LIP.slice(1).flat(), ...Object.values(EYES).flatMap(({ outer, inner, lower, upper, iris }) => [outer, inner, ...lower, ...upper, ...iris])]);

/**
 * Pairs vertices of both skins where the detector finds the same landmarks, except lids and inner lips.
 * @param {object} head made from `truth` @param {object} base landmarks of the base head @param {object} own landmarks of the truth @param {number[][]} landmarks of its picture at rest
 */
export function samePlaces(head, truth, base, own, landmarks) {
  const { target } = fitShape([{ landmarks }], base);
  const which = [...own.at.keys()].filter((i) => i < 468 && !MOVING.has(i) && own.at[i] && target[i]);
  return which.map((i) => [nearestVertex(skinOf(head), target[i]), nearestVertex(skinOf(truth), own.at[i])]);
}
