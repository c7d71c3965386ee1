// SPDX-License-Identifier: GPL-3.0-or-later
/** Lays told landmarks of a mesh on a mean face, which makes the detector unnecessary. */
import { align } from '../../../../web/portrait/align.mjs';
import { rbf } from '../../../../web/element/head/model/rbf.mjs';
import { FileError } from '../limits.mjs';

const FEWEST = 12;
const UNLIKE = 12; // RMS distance from the mean face, mm

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
