// SPDX-License-Identifier: GPL-3.0-or-later
// The inner contour of a drawn mouth: area, width, height and roundness of the opening, and its shares of teeth and tongue; and the same of people.
import { COLOURS, mouthCamera, SPAN } from './mouth-seen.mjs';

const SIZE = [520, 376];
const MM = SPAN / SIZE[0];
const SKIN = 0;
const SEAM = 0.35; // mm: a column of the opening that is lower is the line between touching lips

/**
 * @typedef {object} Shape
 * @property {number} area mm² @property {number} width mm between the outermost columns that are open @property {number} height mm, the highest column
 * @property {number} round height / width: 1 is a circle @property {number} teeth, upper, lower, tongue, dark: shares of the opening
 * @property {number} ofLips the opening's width as a share of the distance between the corners of the mouth
 */

/**
 * @param {{counts: Function}} page a head page @param {string} loaded the flat head's name there @param {number[][]} frames FAPs
 * @returns {Promise<Shape[]>}
 */
export async function shapesIn(page, loaded, head, frames) {
  const found = await page.counts(loaded, frames, mouthCamera(head, 0, SIZE), Object.values(COLOURS), SIZE[0] / 2);
  return found.map((one, i) => shapeOf(one, lipsWidth(head, frames[i])));
}

/** Distance between the corners of the outer contour, mm. */
const lipsWidth = ({ fdp, fapu }, faps) => fdp['8.3'][0] - fdp['8.4'][0] + (((faps[53] ?? 0) + (faps[54] ?? 0)) * fapu.MW) / 1024;

function shapeOf({ areas: [, ...areas], columns }, lips) {
  const all = areas.reduce((sum, n) => sum + n, 0);
  const heights = columns.map((runs) => runs.reduce((sum, [part, pixels]) => sum + (part > SKIN ? pixels : 0), 0) * MM);
  const open = heights.flatMap((mm, x) => (mm > SEAM ? [x] : []));
  const width = open.length ? (open.at(-1) - open[0] + 1) * MM : 0;
  const height = open.length ? Math.max(...heights) : 0;
  const [upper, lower, tongue, dark] = areas.map((n) => (all ? n / all : 0));
  return { area: all * MM * MM, width, height, round: width ? height / width : 0, upper, lower, teeth: upper + lower, tongue, dark, ofLips: width / lips };
}

/**
 * What people's lips do, by phone: area in mm² of the lips' end of the vocal tract, gap in mm between the lips in the middle, corners: change of the mouth's width
 * in mm, ofLips: width of the opening as a share of the lips'.
 * Fant: X-rays of a Russian speaker, held vowels (Acoustic Theory of Speech Production, 1960; as in Praat's VocalTract.cpp). Story: MRI of an American man (Story,
 * Titze and Hoffman, JASA 100, 1996). Film: landmarks on video of English and German speakers; stills of speakers of the GRID corpus (CC BY 4.0).
 */
export const PEOPLE = {
  p: { gap: [0, 0], from: 'closed' },
  b: { gap: [0, 0], from: 'closed' },
  m: { gap: [0, 0], from: 'closed' },
  f: { gap: [1.5, 2.3], from: 'film' },
  v: { gap: [1.5, 2.3], from: 'film' },
  i: { area: [158, 800], from: 'Story, Fant' },
  ɪ: { area: [118, 118], from: 'Story' },
  e: { area: [1000, 1000], from: 'Fant' },
  ɛ: { area: [160, 160], from: 'Story' },
  æ: { area: [394, 394], from: 'Story' },
  a: { area: [503, 790], from: 'Story, Fant' },
  ɯ: { area: [650, 650], from: 'Fant, Russian ы' },
  o: { area: [14, 400], from: 'Story, Fant' },
  ɔ: { area: [88, 88], from: 'Story' },
  u: { area: [60, 86], corners: -1.8, from: 'Fant, Story, film' },
  w: { corners: -3, ofLips: [0.22, 0.43], from: 'film, stills' },
};

const between = ([low, high], digits = 0) => (low === high ? low.toFixed(digits) : `${low.toFixed(digits)} to ${high.toFixed(digits)}`);

/** People's numbers of a phone, in words. */
export function told(ipa) {
  const one = PEOPLE[ipa];
  if (!one) return '';
  const { area, gap, corners, ofLips, from } = one;
  return [area && `${between(area)} mm²`, gap && `gap ${between(gap, 1)} mm`, corners && `corners ${corners} mm`, ofLips && `${between(ofLips, 2)} of the lips`].filter(Boolean).join(', ') + ` (${from})`;
}

const percent = (x) => `${Math.round(100 * x)} %`;

export const shapeHeading = '| phone | mm² | width, mm | of the lips | height, mm | height / width | upper teeth | lower teeth | tongue | people |\n|---|---|---|---|---|---|---|---|---|---|';

/** A row of a Markdown table. @param {Shape} shape */
export const shapeRow = (name, ipa, s) =>
  `| ${name} | ${s.area.toFixed(0)} | ${s.width.toFixed(1)} | ${s.ofLips.toFixed(2)} | ${s.height.toFixed(1)} | ${s.round.toFixed(2)} | ${percent(s.upper)} | ${percent(s.lower)} | ${percent(s.tongue)} | ${told(ipa)} |`;
