// SPDX-License-Identifier: MIT
// The 68 face animation parameters of MPEG-4. Arrays are indexed by FAP number, 1..68; entry 0 is unused.
import table from './fap-table.json' with { type: 'json' };

export const FAP_COUNT = 68;

/** Radians of one angle unit (AU). */
export const AU = 1e-5;

/**
 * @typedef {{number: number, name: string, group: number, unit: string, bidirectional: boolean,
 *   direction: string, fdp: string, quant_step: number, i_steps: number, p_steps: number, min: number, max: number}} Fap
 * @type {Fap[]} indexed by FAP number
 */
export const faps = [];
for (const fap of table.faps) faps[fap.number] = Object.freeze(fap);

/** The number of the FAP of that name, or 0. */
export const fapByName = (name) => table.faps.find((fap) => fap.name === name)?.number ?? 0;

/** The value limited to the FAP's range (FAP 1 and 2: unchanged). */
export const clampFap = (number, value) =>
  number <= 2 ? value : Math.min(faps[number].max, Math.max(faps[number].min, value));

/**
 * Returns the size of one unit of a FAP on a face: mm, or radians for AU; 0 for FAP 1 and 2.
 * @param {number} number
 * @param {Record<string, number>} fapu distances in mm on the neutral face, not divided by 1024
 */
export function fapScale(number, fapu) {
  const { unit } = faps[number];
  if (unit === 'NONE') return 0;
  return unit === 'AU' ? AU : fapu[unit] / 1024;
}
