// SPDX-License-Identifier: MIT
/**
 * From pictures of a face at rest and in poses to what the skin does in each: FAPs as the base has them, and what is left
 * over.
 */
import { laid, PARTED, partedLips } from '../fit.mjs';
import { Layer } from '../lay.mjs';
import { unitLength } from '../moved.mjs';
import { PortraitError } from '../problem.mjs';
import { pictured, speakerOf } from '../speaker.mjs';
import { bend } from './bend.mjs';
import { PoseGuess } from './guess.mjs';
import { modelOf, MOVED } from './model.mjs';
import { POSES } from './poses.mjs';

const SEEN_AT = { // landmarks
  cornerLeft: 291, cornerRight: 61, browInnerLeft: 336, browInnerRight: 107, browMiddleLeft: 334, browMiddleRight: 105,
  browOuterLeft: 300, browOuterRight: 70,
};
const JAW = 3;
// FAPs that are hardly visible from the front: they do not measure the strength of a pose
const DIM = [16, 17, 18, 39, 40, 41, 42, 44, 45, 46, 61, 62, 63];
const STRENGTH = [0.2, 2.5]; // of what the program asks for
const LOST = 0.8; // of the picture's contrast: what is less like the face at rest is not it

/** @throws {PortraitError} where the lips of the picture at rest are parted */
export function restsClosed(landmarks) {
  if (partedLips(landmarks) > PARTED) throw new PortraitError('parted', 'poses are seen against a picture at rest with closed lips');
}

/** A face at rest, to see others against. */
export class Follower {
  /**
   * @param {object} json the base head
   * @param {object} points its landmarks
   * @param {{picture: object, landmarks: number[][]}} rest
   */
  constructor(json, points, { picture, landmarks }) {
    this.points = points;
    this.guess = new PoseGuess(json, points, landmarks);
    this.face = this.guess.face;
    this.speaker = speakerOf(json, points, landmarks, MOVED);
    this.jaw = json.fapu.MNS / this.speaker.skin.fapu.MNS; // the field of the jaw is in the base's mm
    this.rest = new Layer(this.speaker, modelOf([]));
    this.look = this.rest.seen(picture, this.speaker, this.rest.still);
    this.contrast = Math.sqrt(this.look.at(-1)[0].reduce((sum, x) => sum + (x * x || 0), 0) / this.speaker.count);
  }

  /** Fits the pose of the head and the base's FAPs to a picture. @param {Layer} layer of the pose @param {object} view */
  lay(layer, { picture, landmarks }) {
    const stand = pictured(landmarks, this.points);
    return layer.lay(picture, this.look, { stand, q: this.#guess(layer, laid(landmarks, this.points).points) });
  }

  /** Lips and jaw go farther than steps find the way: where the detector sees them gone. */
  #guess({ still, model: { unknowns } }, points) {
    const q = still.slice();
    const gone = (i, k) => points[i][k] - this.face[i][k];
    const put = (name, mm) => (q[unknowns.indexOf(name)] = mm);
    const wide = (p) => p[291][0] - p[61][0];
    put('EM', Math.max(0, -gone(152, 1)));
    put('LI', Math.max(0, -gone(14, 1)));
    put('LS', Math.max(0, gone(13, 1)));
    put('AR', wide(points) - wide(this.face));
    for (const [unknown, at] of Object.entries(SEEN_AT)) put(unknown, gone(at, 1));
    return q;
  }

  /** Computes the displacements by FAPs: mm to the left and up. @param {Map<number, number>} faps mm */
  #moved(faps) {
    const out = new Float64Array(2 * this.speaker.count);
    MOVED.forEach((fap, f) => {
      const amount = (faps.get(fap) ?? 0) * (fap === JAW ? this.jaw : 1);
      const { at, mm } = this.speaker.fields[f][amount >= 0 ? 'positive' : 'negative'];
      at.forEach((n, i) => {
        if (n % 3 < 2) out[2 * Math.floor(n / 3) + (n % 3)] += Math.abs(amount) * mm[i];
      });
    });
    return out;
  }

  /**
   * @param {string} name of a pose @param {{picture: object, landmarks: number[][]}} view landmarks: of look.mjs
   * @returns {{name: string, faps: Map<number, number>, strength: number, shift: Float64Array}} faps: what the program would
   *   ask for, mm; shift: what the face does beyond them, mm to the left and up of each place
   * @throws {PortraitError} also where it is not this face, or not that pose
   */
  follow(name, { picture, landmarks }) {
    if (this.guess.isOther(landmarks)) throw new PortraitError('other_face', 'it is another face than the one at rest, or a turned one');
    const layer = new Layer(this.speaker, modelOf(POSES[name].moves));
    const found = this.lay(layer, { picture, landmarks });
    if (found.unlike > LOST * this.contrast)
      throw new PortraitError('unlike', 'it does not look like the face at rest (another light, or another face)');
    const seen = layer.model.fapsOf(found.q);
    const is = new Map(MOVED.map((fap, f) => [fap, fap === JAW ? seen[f] / this.jaw : seen[f]]));
    const asked = new Map(Object.entries(POSES[name].faps).map(([fap, value]) =>
      [Number(fap), value * unitLength(this.speaker.skin, Number(fap))]));
    const tells = MOVED.flatMap((fap) => (asked.has(fap) && !DIM.includes(fap) ? [[is.get(fap), asked.get(fap)]] : []));
    const [both, own] = tells.reduce(([sum, square], [mm, wanted]) => [sum + mm * wanted, square + wanted * wanted], [0, 0]);
    const strength = both / own;
    if (strength < STRENGTH[0] || strength > STRENGTH[1])
      throw new PortraitError('other_pose', `it does not show this pose (${Math.round(100 * strength)} % of it)`);
    const faps = new Map([...asked].map(([fap, mm]) => [fap, strength * mm]));
    const [there, expected] = [is, faps].map((amounts) => this.#moved(amounts));
    const more = bend(layer, picture, this.look, found);
    return { name, faps, strength, shift: there.map((x, i) => x - expected[i] + more[i]) };
  }
}
