// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * What of a face's landmarks tells how lips and jaw stand: laid onto one face by what does not move (so the head's motion falls out), each
 * pair of landmarks as one. What the detector makes of a mouth is not where the mouth is; how much of each parameter it is has been learnt from
 * pictures of our heads (learn.mjs) and lies in habits.json.
 */
import { align, upright } from '../../../web/src/portrait/align.mjs';

const list = (text) => text.split(' ').map(Number);

/** Brow ridge to nose, temples: no muscle of the mouth moves them. */
export const STILL = list('10 109 338 67 297 103 332 54 284 21 251 162 389 127 356 151 9 8 108 337 69 299 104 333 168 6 197 195 5 4 1 33 263 133 362 188 412 174 399 193 417 122 351 196 419 234 454');

/** Landmarks in the middle, and pairs, right and left: of lips, chin, jaw, cheeks. */
export const MIDDLE = list('0 11 12 13 14 15 16 17 18 200 199 175 152 164 2');
export const PAIRS = [
  '61 291', '76 306', '62 292', '78 308', '185 409', '40 270', '39 269', '37 267', '184 408', '74 304', '73 303', '72 302', '183 407', '42 272', '41 271', '38 268',
  '191 415', '80 310', '81 311', '82 312', '146 375', '91 321', '181 405', '84 314', '77 307', '90 320', '180 404', '85 315', '96 325', '89 319', '179 403', '86 316',
  '95 324', '88 318', '178 402', '87 317', '148 377', '176 400', '149 378', '150 379', '136 365', '172 397', '57 287', '43 273', '106 335', '182 406', '83 313', '201 421', '208 428',
  '32 262', '140 369', '171 396', '194 418', '204 424', '202 422', '212 432', '216 436', '206 426', '92 322', '165 391', '167 393', '186 410', '214 434', '210 430', '211 431', '207 427', '187 411', '205 425', '50 280',
].map(list);
export const COUNT = 2 * MIDDLE.length + 3 * PAIRS.length;

const IRISES = [[469, 471], [474, 476]]; // across

/** @param {number[][]} landmarks as the detector gives them @param {number[][]} face of each of STILL its place on the face that all are laid onto */
export function laidFace(landmarks, face) {
  const up = upright(landmarks);
  const target = [];
  STILL.forEach((number, i) => (target[number] = face[i]));
  const { apply, turn } = align(up, target, STILL);
  const points = up.map(apply);
  const iris = IRISES.reduce((sum, [a, b]) => sum + Math.hypot(points[a][0] - points[b][0], points[a][1] - points[b][1]) / 2, 0);
  return { points, iris, yaw: Math.asin(Math.max(-1, Math.min(1, turn[2][0]))) };
}

/** @param {number[][]} points of laidFace @returns {Float64Array} COUNT numbers, in its unit */
export function shapeOf(points) {
  const out = [];
  for (const i of MIDDLE) out.push(points[i][1], points[i][2]);
  for (const [r, l] of PAIRS) out.push((points[l][0] - points[r][0]) / 2, (points[l][1] + points[r][1]) / 2, (points[l][2] + points[r][2]) / 2);
  return Float64Array.from(out);
}

/** The parameters (articulation.mjs) as the landmarks have them, in the unit of laidFace. */
export function plainly(points) {
  const [upper, lower, left, right, chin] = [13, 14, 308, 78, 152].map((i) => points[i]);
  return [-lower[1], upper[1], left[0] - right[0], lower[2], upper[2], -chin[1]];
}
