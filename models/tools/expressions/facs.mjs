// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Action units as movements of feature points, and the units of every affect in the literature. FACS grades a unit from A (trace) to E (most); it has
 * no millimetres, so `most` is a convention of this file: about what adults reach.
 */

/** Least share of `most` for each grade; C and D are wide, as in FACS. */
const GRADES = { A: 0.08, B: 0.18, C: 0.33, D: 0.6, E: 0.85 };

const above = (x) => Math.max(0, x);

/**
 * Units by number: name, FAPs that carry it, what it is measured by, and how far it goes. A unit that moves the same point as another counts
 * only what the other does not explain: a smile lifts the upper lip (12), a fallen jaw draws the corners down (26).
 */
export const UNITS = {
  1: { name: 'inner brows up', faps: '31, 32', most: 9, of: (m) => m['inner brow up'] },
  2: { name: 'outer brows up', faps: '35, 36', most: 9, of: (m) => m['outer brow up'] },
  4: { name: 'brows together, or down', faps: '37, 38, 31, 32', most: 7, of: (m) => Math.max(m['brows together'], -m['inner brow up']) },
  5: { name: 'upper lids up', faps: '19, 20', most: 2.6, of: (m) => m['upper lid up'] },
  6: { name: 'cheeks up', faps: '41, 42', most: 6, of: (m) => m['cheek up'] },
  7: { name: 'lower lids up', faps: '21, 22', most: 3, of: (m) => m['lower lid up'] },
  9: { name: 'nose wrinkled: wings up', faps: '63', most: 3, of: (m) => m['nostril up'] - 0.12 * above(m['corner up']) },
  10: { name: 'upper lip up', faps: '4, 8, 9', most: 5, of: (m) => m['upper lip up'] - 0.6 * above(m['corner up']) },
  12: { name: 'corners up and out', faps: '12, 13, 6, 7', most: 12, of: (m) => Math.min(Math.hypot(above(m['corner up']), above(m['corner out'])), 2.5 * above(m['corner up'])) },
  15: { name: 'corners down', faps: '12, 13', most: 5, of: (m) => -m['corner up'] - 0.3 * above(m['jaw down']) },
  17: { name: 'chin up', faps: '18', most: 3, of: (m) => m['chin up'] },
  20: { name: 'lips stretched: corners out', faps: '6, 7', most: 12, of: (m) => m['corner out'] - 2.5 * above(m['corner up']) },
  24: { name: 'lips pressed, or tight (23)', faps: '4, 5, 8 to 11', most: 6, of: (m) => m['lips narrower'] - 0.4 * above(m['jaw down']) },
  25: { name: 'lips apart', faps: '4, 5, 8 to 11', most: 16, of: (m) => m['lips apart'] },
  26: { name: 'jaw down', faps: '3', most: 16, of: (m) => m['jaw down'] },
  51: { name: 'head turned (51, 52)', faps: '49', most: 20, degrees: true, of: (m) => m['head turned'] },
  53: { name: 'head up', faps: '48', most: 20, degrees: true, of: (m) => -m['head down'] },
  54: { name: 'head down', faps: '48', most: 20, degrees: true, of: (m) => m['head down'] },
  55: { name: 'head tilted (55, 56)', faps: '50', most: 20, degrees: true, of: (m) => m['head tilted'] },
  64: { name: 'eyes down', faps: '25, 26', most: 20, degrees: true, of: (m) => m['gaze down'] },
};

const FACE = Object.keys(UNITS).filter((unit) => !UNITS[unit].degrees);

/**
 * Units of each affect at full intensity: those that it has (with the least grade), and those that it may have (to the greatest). It has no others of
 * the face. FACS: Ekman, Friesen and Hager 2002, table 10-2. Du: S. Du, Y. Tao, A. M. Martinez, Compound facial expressions of emotion, PNAS 111, 2014, table 1.
 * Keltner: D. Keltner, Signs of appeasement, JPSP 68, 1995. Tracy: J. L. Tracy, R. W. Robins, Show your pride, Psychological Science 15, 2004.
 * Eisenberg: N. Eisenberg et al., Relation of sympathy and personal distress to prosocial behavior, JPSP 57, 1989. Where no study is named, the affect is
 * a weaker or mixed basic one by its definition.
 */
export const AFFECTS = {
  joy: { has: '6C 12C 25A', may: '7 10A 26B', source: 'FACS' },
  sadness: { has: '1C 4B 15C 17B', may: '7B', source: 'FACS' },
  anger: { has: '4D 5B 7B 17B 24B', may: '9B 15B', source: 'FACS' },
  fear: { has: '1C 2B 4C 5C 7B 20C 25A', may: '15B 26B', source: 'FACS' },
  disgust: { has: '9C 10C 15A 17B', may: '4D 6D 7 25B', source: 'FACS' },
  surprise: { has: '1C 2C 5B 25B 26C', may: '', source: 'FACS' },
  distress: { has: '1C 4B 20A 25A', may: '2B 5B 7B 15C 17B 26B', source: 'Du, sadly fearful' },
  embarrassment: { has: '12A 24A 64B 51A', may: '1B 4A 6B 7C 10B 17B', source: 'Keltner' },
  'happy-for': { has: '6C 12C 25A', may: '1B 2B 7 10A 26B', source: 'Du, happily surprised' },
  gloating: { has: '6B 12B 25A', may: '2C 4B 7 9B 10B 17A', source: 'Du, happily disgusted' },
  resentment: { has: '4C 7B 15A 17B', may: '6B 9C 24B', source: 'Du, sadly angry, angrily disgusted' },
  relief: { has: '12B', may: '1B 2B 6C 7C 10A 25B 26B', source: '' },
  jealousy: { has: '4C 15A', may: '1B 5B 7C 17C 20A 24B', source: 'Du, sadly and fearfully angry' },
  envy: { has: '4C 7B 15A', may: '6B 9B 17C 24B', source: 'Du, sadly angry' },
  'sorry-for': { has: '1C 4A 55A', may: '7B 15C 17C', source: 'Eisenberg' },
  hope: { has: '1B 2B 12A', may: '5A 6B 7B 10A 25B 26B', source: '' },
  satisfaction: { has: '6B 12B', may: '7C 10A', source: '' },
  'fear-confirmed': { has: '1C 4B 20A 25A', may: '2A 7B 15C 17B 26A', source: 'Du, sadly fearful' },
  disappointment: { has: '1B 4A 15B', may: '7B 9A 17C 20A 24B', source: 'Du, sadly disgusted' },
  pride: { has: '12B 53B', may: '2B 6B 7C 17B', source: 'Tracy' },
  shame: { has: '54B 64C', may: '1C 4B 7B 15C 17C 24B', source: 'Keltner' },
  reproach: { has: '4C 24A', may: '2B 7B 15B 17B', source: '' },
  liking: { has: '6B 12B 55A', may: '1B 2B 7C 10A', source: '' },
  disliking: { has: '4B 9B 10A', may: '6B 7C 15B 17C 25A', source: 'Du, angrily disgusted' },
  gratitude: { has: '6B 12B 54A', may: '1B 2A 7C 10A 25B 26A', source: '' },
  gratification: { has: '6C 12C 25A', may: '7D 10A 26A', source: '' },
  remorse: { has: '1C 4B 15B 54A', may: '7B 17C', source: '' },
  love: { has: '6B 12B 55B', may: '1B 2A 7C 10A', source: '' },
  hate: { has: '4D 7C 10A 17B', may: '5A 6B 9C 15B 24C', source: 'Du, hatred' },
};

/** Returns the grade of a unit, '' where it is absent. `slack` > 1 makes every grade easier to reach. */
export function gradeOf(unit, moves, slack = 1) {
  const share = (UNITS[unit].of(moves) / UNITS[unit].most) * slack;
  return Object.keys(GRADES).findLast((grade) => share >= GRADES[grade]) ?? '';
}

/** Units of a list as `6C 12`, each with its grade or that one. */
const listed = (text, otherwise) => Object.fromEntries(text.split(' ').filter(Boolean).map((entry) => [parseInt(entry, 10), /[A-E]$/.exec(entry)?.[0] ?? otherwise]));

/**
 * Compares an affect with its units.
 * @param {Record<string, number>} moves see measuring
 * @param {number} [slack] of faces other than the one on which the expressions were set, above 1
 * @returns {string[]} what is wrong
 */
export function faultsOf(affect, moves, slack = 1) {
  const [has, may] = [listed(AFFECTS[affect].has, 'A'), listed(AFFECTS[affect].may, 'E')];
  const measured = (unit) => `AU ${unit}, ${UNITS[unit].name}, is ${UNITS[unit].of(moves).toFixed(1)} ${UNITS[unit].degrees ? '°' : 'mm'}`;
  const missing = Object.keys(has).filter((unit) => gradeOf(unit, moves, slack) < has[unit]);
  const over = FACE.filter((unit) => !(unit in has) && gradeOf(unit, moves, 1 / slack) > (may[unit] ?? ''));
  return [
    ...missing.map((unit) => `${affect}: ${measured(unit)}, less than ${has[unit]}`),
    ...over.map((unit) => `${affect}: ${measured(unit)}, ${may[unit] ? `more than ${may[unit]}` : 'which it must not have'}`),
  ];
}

const COLUMNS = FACE.map(Number);

/** The table of all affects in Markdown. @param {Record<string, Record<string, number>>} moves by affect */
export function tableOf(moves) {
  const cell = (unit, all) => (gradeOf(unit, all) ? `${UNITS[unit].of(all).toFixed(1)} ${gradeOf(unit, all)}` : '');
  const posture = (all) => [51, 53, 54, 55, 64].filter((unit) => gradeOf(unit, all)).join(', ');
  const rows = Object.entries(moves).map(([affect, all]) => [affect, ...COLUMNS.map((unit) => cell(unit, all)), posture(all), AFFECTS[affect].source]);
  const lines = [['affect', ...COLUMNS, 'head, eyes', 'as in'], Array(COLUMNS.length + 3).fill('---'), ...rows];
  return lines.map((cells) => `| ${cells.join(' | ')} |`);
}

/** The table of units in Markdown. */
export function unitsTable() {
  const rows = FACE.map((unit) => [unit, UNITS[unit].name, UNITS[unit].faps, UNITS[unit].most]);
  return [['unit', 'movement', 'FAPs', 'mm at most'], Array(4).fill('---'), ...rows].map((cells) => `| ${cells.join(' | ')} |`);
}
