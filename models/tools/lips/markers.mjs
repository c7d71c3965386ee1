// SPDX-License-Identifier: GPL-3.0-or-later
/** Selects the eight markers to use from a file: by a map (JSON: {"nose": "NOSE", ...}), by their names, or in the thesis's order. */
import { FileError } from '../import/file-error.mjs';
import { articulation, MARKERS } from './articulation.mjs';

/** @param {string} text @returns {Object<string, string|number>} ours -> the file's name, or its number from 1 */
export function readMap(text) {
  let map;
  try {
    map = JSON.parse(text);
  } catch (error) {
    throw new FileError('', error.message);
  }
  if (typeof map !== 'object' || map === null || Array.isArray(map)) throw new FileError('', 'an object is wanted: a name in the file for each marker');
  for (const [key, name] of Object.entries(map)) {
    if (!MARKERS.includes(key)) throw new FileError(key, `there is no such marker: ${MARKERS.join(', ')}`);
    if (typeof name !== 'string' && !(Number.isInteger(name) && name > 0)) throw new FileError(key, 'must be a name, or a number from 1');
  }
  const lacking = MARKERS.filter((key) => !Object.hasOwn(map, key));
  if (lacking.length) throw new FileError(lacking[0], 'is missing');
  return map;
}

/** @returns {number[]} index in names of each of MARKERS */
function numbersOf(names, map) {
  const find = (wanted) => {
    if (typeof wanted === 'number') return wanted <= names.length ? wanted - 1 : -1;
    const same = names.findIndex((name) => name === wanted || name.split(':').at(-1).toLowerCase() === wanted.toLowerCase()); // "Subject:NOSE"
    return same;
  };
  if (map) {
    const numbers = MARKERS.map((key) => find(map[key]));
    const missing = numbers.indexOf(-1);
    if (missing >= 0) throw new FileError('', `there is no marker ${JSON.stringify(map[MARKERS[missing]])} for ${MARKERS[missing]}: it has ${names.slice(0, 40).join(', ')}`);
    return numbers;
  }
  const named = MARKERS.map(find);
  if (!named.includes(-1)) return named;
  if (names.length === MARKERS.length) return MARKERS.map((_, i) => i);
  throw new FileError('', `it has ${names.length} markers, and only eight have an order of their own: --markers says which is which (${names.slice(0, 40).join(', ')})`);
}

/**
 * @param {import('./tracks.mjs').Tracks} tracks @param {number} tilt rad (articulation.mjs) @returns {object[]} rows (curves.mjs) of all ten parameters;
 *   a lost marker leaves out only the parameters that need it
 */
export function rowsOfMarkers(tracks, map, tilt) {
  const numbers = numbersOf(tracks.names, map);
  if (!tracks.times.length) throw new FileError('', 'there are no frames');
  const rows = tracks.times.map((time, frame) => {
    const values = articulation(numbers.map((number) => tracks.at(frame, number)), tilt);
    const seen = values?.map(Number.isFinite);
    return seen?.includes(true) ? { time, values, confidence: 1, seen } : { time, values: null, confidence: 0 };
  });
  const whole = rows.every(({ seen }) => !seen?.includes(false));
  return whole ? rows.map(({ time, values, confidence }) => ({ time, values, confidence })) : rows.map((row) => ({ ...row, seen: row.seen ?? numbers.map(() => false) }));
}
