// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Landmarks given in a points file as vertices of the mesh. Many meshes come with such a list, which makes the detector unnecessary. Two schemes
 * are supported: the 468 points (478 with irises) of the canonical face mesh, and the 68 points of iBUG's 300-W (51 without the jaw).
 */
import { align } from '../../../web/portrait/align.mjs';
import { COUNT } from '../../../web/portrait/landmarks.mjs';
import { rbf } from '../../../web/element/head/model/rbf.mjs';
import { FileError } from './file-error.mjs';

const list = (text) => text.split(' ').map(Number);
const JAW = 17;
/** The 68 points as face mesh landmarks: from the right ear over the chin to the left, brows, nose, eyes, lips. The jaw's points follow the outline in the picture, so they are spread along the oval. */
const IBUG = [
  ...list('127 234 93 132 58 136 150 176 152 400 379 365 288 361 323 454 356'), ...list('70 63 105 66 107'), ...list('336 296 334 293 300'),
  ...list('168 197 5 4'), ...list('75 97 2 326 305'), ...list('33 160 158 133 153 144'), ...list('362 385 387 263 373 380'),
  ...list('61 39 37 0 267 269 291 405 314 17 84 181'), ...list('78 82 13 312 308 317 14 87'),
];
export const SCHEMES = { mediapipe: Array.from({ length: COUNT }, (_, i) => i), ibug: IBUG };
const FEWEST = 12;
const UNLIKE = 12; // RMS distance from the mean face, mm

/** @returns {number[]} for each entry of the list the landmark */
export function landmarksOf({ scheme, vertices }) {
  const numbers = SCHEMES[scheme];
  return scheme === 'ibug' && vertices?.length === numbers.length - JAW ? numbers.slice(JAW) : numbers;
}

/**
 * @param {Map<number, number[]>} told landmark -> where it is, in the file's coordinates @param {object} template the mean face
 * @param {Record<string, (p: number[]) => number[]>} turns that a file may want @param {{fewest?: number, most?: number}} limits most: mm from where the mean face has them, root mean square
 * @returns {{name: string, turn: Function, onto: object, which: number[], points: (number[]|null)[], all: number[][]}} points: told ones in a head's directions; all: of each landmark, laid by those
 */
export function layTold(told, template, turns, { fewest = FEWEST, most = UNLIKE } = {}) {
  const which = [...told.keys()].filter((i) => template.at[i]);
  if (which.length < fewest) throw new FileError('landmarks', `${which.length} are too few: ${fewest} are wanted`);
  const mean = template.at.map((p) => p ?? [0, 0, 0]);
  const onto = align(mean, template.at.map((_, i) => told.get(i) ?? [0, 0, 0]), which);
  const off = Math.sqrt(which.reduce((sum, i) => sum + onto.apply(mean[i]).reduce((s, x, k) => s + (x - told.get(i)[k]) ** 2, 0), 0) / which.length) / onto.scale;
  if (!(off < most)) throw new FileError('landmarks', `they are no face: ${off.toFixed(0)} mm from a mean one (is another scheme meant, are left and right the face's own, do they count from 0?)`);
  const along = (turn) => [0, 1, 2].reduce((sum, k) => sum + turn(onto.turn.map((row) => row[k]))[k], 0);
  const [name, turn] = Object.entries(turns).reduce((best, one) => (along(one[1]) > along(best[1]) ? one : best));
  const points = template.at.map((_, i) => (told.has(i) ? turn(told.get(i)) : null));
  const turned = which.map((i) => [mean[i], points[i]]);
  const whole = align(mean, points.map((p) => p ?? [0, 0, 0]), which);
  const warp = rbf(turned.flatMap(([p]) => whole.apply(p)), turned.flatMap(([, p]) => p), { smooth: 0.02 });
  return { name, turn, onto: whole, which, points, off, all: template.at.map((p) => (p ? warp.at(whole.apply(p)) : null)) };
}
