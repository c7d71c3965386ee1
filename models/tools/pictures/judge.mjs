// SPDX-License-Identifier: GPL-3.0-or-later
/** Checks whether a photograph is suitable for a set, and gives the reason if not. */
import { displacements, openingOf } from '../../../web/element/pictures/space.mjs';
import { faceValues } from '../../../web/element/face/face-mixer.mjs';

const TURNED = 0.12; // rad, against the picture at rest
const REST_TURNED = 0.2; // rad: of that itself
const BLURRED = 0.5; // of the median sharpness
const ENLARGED = 2.2; // times
const LIGHT = 2.5; // times brighter or darker than at rest
const LIDS = 0.87; // of the lids' distance at rest: the detector overestimates closed lids, but stays below this
/** Shares of the mouth's width. Landmarks underestimate lip movements, small openings by half. */
const PARTED = 0.07; // at rest
const APART = 0.03; // for lips that should be closed, beyond the opening at rest
const OPEN = 0.1; // minimum visible opening
const LEAST_OPEN = 0.22; // of that
const [WIDE_OPEN, SOME] = [1.2, 0.05]; // maximum ratio to the expected opening, and margin for small openings
const ROUND = [-0.1, -0.02]; // corners that must approach each other, and the least amount
const SPREAD = [0.08, -0.05];

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

/** Checks the picture at rest. @returns {string|null} */
export function unfitRest(rest) {
  if (rest.turned > REST_TURNED) return 'the face is turned aside';
  if (rest.enlarged > ENLARGED) return `the face is too small: it would be enlarged ${rest.enlarged.toFixed(1)} times`;
  return rest.gap > PARTED * rest.wide ? 'the lips are apart: at rest they are closed' : null;
}

/**
 * Checks a picture independently of its pose.
 * @param {object} seen (look.mjs) @param {object} rest @param {{sharp: number, fapu: object}} of all pictures
 * @returns {string|null} what is wrong in any pose
 */
export function unfit(seen, rest, { sharp, bright }) {
  if (seen.turned > TURNED) return `the face is turned by ${Math.round((seen.turned * 180) / Math.PI)} degrees against that at rest`;
  if (seen.enlarged > ENLARGED) return `the face is too small: it would be enlarged ${seen.enlarged.toFixed(1)} times`;
  if (seen.sharp < BLURRED * sharp) return 'it is blurred';
  const light = seen.bright / bright;
  if (light > LIGHT || light < 1 / LIGHT) return `it is ${light > 1 ? `${light.toFixed(1)} times brighter` : `${(1 / light).toFixed(1)} times darker`} than that at rest`;
  return null;
}

export const blinkUnfit = (seen, rest) => (seen.lids > LIDS * rest.lids ? 'the eyes are not closed' : null);

/** @returns {string|null} why the mouth does not match the viseme @param {object} faps by number @param {object} fapu pixels */
export function mouthUnfit(seen, rest, faps, fapu) {
  const values = faceValues(faps);
  const opening = (openingOf(values) * fapu.MNS) / 1024 / rest.wide;
  const [[right], [left]] = displacements(values, fapu);
  const spread = (left - right) / rest.wide;
  const gap = seen.gap / rest.wide;
  const wider = (seen.wide - rest.wide) / rest.wide;
  if (opening <= 0 && gap > rest.gap / rest.wide + APART) return 'the lips are apart: they must touch';
  if (opening > OPEN && gap < LEAST_OPEN * opening) return 'the mouth is hardly open';
  if (opening < OPEN && gap > WIDE_OPEN * Math.max(0, opening) + SOME) return 'the mouth is too wide open';
  if (spread < ROUND[0] && wider > ROUND[1]) return 'the lips are not rounded';
  if (spread > SPREAD[0] && wider < SPREAD[1]) return 'the lips are rounded: they must be spread';
  return null;
}

export const usual = (all) => median(all.map(({ sharp }) => sharp));
