// SPDX-License-Identifier: GPL-3.0-or-later
/** Whether a photograph is fit for a set, and why not. */
import { displacements, openingOf } from '../../../web/element/pictures/space.mjs';
import { faceValues } from '../../../web/element/face/face-mixer.mjs';

const TURNED = 0.12; // rad, against the picture at rest
const REST_TURNED = 0.2; // rad: of that itself
const BLURRED = 0.5; // of the sharpness in the middle of all
const ENLARGED = 2.2; // times
const LIGHT = 2.5; // times brighter or darker than at rest
const LIDS = 0.87; // of the lids' distance at rest: closed ones are seen too far apart, but less
/** Shares of the mouth's width. Landmarks tell somewhat less than what lips do, of small openings half. */
const PARTED = 0.07; // at rest
const APART = 0.03; // of lips that should be closed, more than at rest
const OPEN = 0.1; // an opening that has to be seen
const LEAST_OPEN = 0.22; // of that
const [WIDE_OPEN, SOME] = [1.2, 0.05]; // times what is wanted, and more: of small openings
const ROUND = [-0.1, -0.02]; // corners that are to come nearer by so much, must by so much
const SPREAD = [0.08, -0.05];

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

/** Of the picture at rest. @returns {string|null} */
export function unfitRest(rest) {
  if (rest.turned > REST_TURNED) return 'the face is turned aside';
  if (rest.enlarged > ENLARGED) return `the face is too small: it would be enlarged ${rest.enlarged.toFixed(1)} times`;
  return rest.gap > PARTED * rest.wide ? 'the lips are apart: at rest they are closed' : null;
}

/**
 * @param {object} seen (look.mjs) @param {object} rest @param {{sharp: number, fapu: object}} of all pictures
 * @returns {string|null} what is wrong, whatever it shows
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

/** @returns {string|null} why the mouth is not that of the viseme @param {object} faps by number @param {object} fapu pixels */
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
