// SPDX-License-Identifier: MIT
// Measures how far a face has moved since it was drawn. The stage leaves out pictures that would look the same.
import { AU, FAP_COUNT, fapScale } from '../../../protocol/fap.mjs';
import { BREATH } from '../head/model/model.mjs';

const EYE_MM = 12; // from the middle of an eyeball to the pupil
const HEAD_MM = 250; // from the joints of the neck to the top of the hair
const BREATH_MM = 5;
const EYEBALLS = [23, 24, 25, 26];
const HEAD = [48, 49, 50];

/** The most that one unit of each value moves any point of the face, in mm. @param {Record<string, number>} fapu mm */
function reachesOf(fapu) {
  const reaches = new Float32Array(FAP_COUNT + 1);
  for (let fap = 3; fap <= FAP_COUNT; fap++) reaches[fap] = fapScale(fap, fapu);
  for (const fap of EYEBALLS) reaches[fap] = AU * EYE_MM;
  for (const fap of HEAD) reaches[fap] = AU * HEAD_MM;
  reaches[BREATH] = BREATH_MM;
  return reaches;
}

export class VisibleChange {
  #reaches;
  #drawn = null;

  /** @param {Record<string, number>} fapu of the face, in mm */
  constructor(fapu) {
    this.#reaches = reachesOf(fapu);
  }

  /** Notes the face that is drawn. @param {Float32Array} values by FAP number, the breath at 0 */
  drawn(values) {
    (this.#drawn ??= new Float32Array(values.length)).set(values);
  }

  /** Returns the farthest that any point may have moved since then, in mm. @param {Float32Array} values as above */
  since(values) {
    if (!this.#drawn) return Infinity;
    let most = 0;
    for (let fap = 0; fap < this.#reaches.length; fap++)
      most = Math.max(most, this.#reaches[fap] * Math.abs(values[fap] - this.#drawn[fap]));
    return most;
  }
}
