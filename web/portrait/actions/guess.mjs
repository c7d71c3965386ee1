// SPDX-License-Identifier: MIT
/**
 * Guesses the pose in a picture by the displacement of its landmarks from rest: for pictures without a name, and for a camera
 * that keeps the best of many.
 */
import { readModel } from '../../element/head/model/model.mjs';
import { laid } from '../fit.mjs';
import { BROWS, LIP_CORNERS, LOWER_LIP, STEADY, UPPER_LIP } from '../landmarks.mjs';
import { movedBy, unitLength } from '../moved.mjs';
import { POSES } from './poses.mjs';

const CHIN = [152, 148, 377, 175, 199, 200, 18, 83, 313];
const MOUTH = [...UPPER_LIP, ...LOWER_LIP, ...Object.values(LIP_CORNERS)].flat();
const TOLD = [...new Set([...MOUTH, ...Object.values(BROWS).flat(), ...CHIN])];
const SEEN = 0.6; // of what lips do the detector tells
const FIT = 0.6; // cosine: what is less like a pose is another, or none
const STRONG = 0.25; // of what the program asks for
const STILL = 0.7; // mm: what no pose moves more
const OTHER = 1.5; // mm: faces that differ more, in the middle of what poses leave alone, are two people's

export class PoseGuess {
  #signs; // name -> displacements of the landmarks (columns and rows), mm

  /**
   * @param {object} json the base head
   * @param {object} points its landmarks
   * @param {number[][]} landmarks of the face at rest
   */
  constructor(json, points, landmarks) {
    this.points = points;
    this.face = laid(landmarks, points).points;
    const known = [...new Set([...TOLD, ...STEADY])].filter((i) => points.at[i]);
    const model = readModel(json);
    const skin = model.parts.find(({ name }) => name === 'skin');
    const vertices = known.map((i) => nearest(skin.position, points.at[i]));
    const most = new Float64Array(known.length);
    const all = new Map(Object.entries(POSES).map(([name, { faps }]) => {
      const sum = new Float64Array(2 * known.length);
      for (const [fap, value] of Object.entries(faps)) {
        const gone = movedBy(skin, model.turns, Number(fap), value, unitLength(model, Number(fap)));
        vertices.forEach((v, i) => {
          for (let k = 0; k < 2; k++) sum[2 * i + k] += SEEN * gone[3 * v + k];
        });
      }
      most.forEach((mm, i) => (most[i] = Math.max(mm, Math.hypot(sum[2 * i], sum[2 * i + 1]))));
      return [name, sum];
    }));
    this.which = known.slice(0, TOLD.filter((i) => points.at[i]).length);
    this.#signs = new Map([...all].map(([name, sum]) => [name, sum.subarray(0, 2 * this.which.length)]));
    this.still = known.filter((_, i) => most[i] < STILL);
  }

  /** Returns the median difference from rest, in mm, of landmarks that no pose moves. */
  unlike(landmarks) {
    const { points } = laid(landmarks, this.points);
    const off = this.still
      .map((i) => Math.hypot(...[0, 1].map((k) => points[i][k] - this.face[i][k])))
      .sort((a, b) => a - b);
    return off[off.length >> 1];
  }

  /** Whether it is another person. */
  isOther(landmarks) {
    return this.unlike(landmarks) > OTHER;
  }

  /**
   * @returns {{name: string, strength: number, like: number}[]} strength: of what the program asks for; like: -1 to 1, best
   *   first
   */
  looks(landmarks) {
    const { points } = laid(landmarks, this.points);
    const gone = this.which.flatMap((i) => [0, 1].map((k) => points[i][k] - this.face[i][k]));
    const far = Math.hypot(...gone);
    return [...this.#signs].map(([name, sign]) => {
      const both = sign.reduce((sum, mm, n) => sum + mm * gone[n], 0);
      const own = Math.hypot(...sign);
      return { name, strength: both / own ** 2, like: both / (own * far + 1e-9) };
    }).sort((a, b) => b.like - a.like);
  }

  /** @returns {string|null} the pose that it is most like; null: it is at rest, or none of them */
  best(landmarks) {
    const [first] = this.looks(landmarks);
    return first.like > FIT && first.strength > STRONG ? first.name : null;
  }
}

function nearest(position, place) {
  let [best, least] = [0, Infinity];
  for (let v = 0; v < position.length; v += 3) {
    const far = Math.hypot(position[v] - place[0], position[v + 1] - place[1], position[v + 2] - place[2]);
    if (far < least) [best, least] = [v / 3, far];
  }
  return best;
}
