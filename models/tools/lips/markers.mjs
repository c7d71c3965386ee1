// SPDX-License-Identifier: GPL-3.0-or-later
/** Selects the eight markers to use from a file: by a map (JSON: {"nose": "NOSE", ...}), by their names, or in the thesis's order. */
import { FileError } from '../import/limits.mjs';
import { articulation, MARKERS } from './articulation.mjs';
import { featurePoints } from './fap-tracks.mjs';

/** @param {string} text @returns {Object<string, string|number>} ours, or a feature point of MPEG-4 -> the file's name, or its number from 1 */
export function readMap(text) {
  let map;
  try {
    map = JSON.parse(text);
  } catch (error) {
    throw new FileError('', error.message);
  }
  if (typeof map !== 'object' || map === null || Array.isArray(map)) throw new FileError('', 'an object is wanted: a name in the file for each marker');
  for (const [key, name] of Object.entries(map)) {
    if (!MARKERS.includes(key) && !featurePoints.has(key)) throw new FileError(key, `there is no such marker: ${MARKERS.join(', ')}, or a feature point such as 4.1`);
    if (typeof name !== 'string' && !(Number.isInteger(name) && name > 0)) throw new FileError(key, 'must be a name, or a number from 1');
  }
  const lacking = MARKERS.filter((key) => !Object.hasOwn(map, key));
  if (lacking.length) throw new FileError(lacking[0], 'is missing');
  return map;
}

/** Index in names of a marker called so, or with that number; -1: there is none. */
function find(names, wanted) {
  if (typeof wanted === 'number') return wanted <= names.length ? wanted - 1 : -1;
  return names.findIndex((name) => name === wanted || name.split(':').at(-1).toLowerCase() === wanted.toLowerCase()); // "Subject:NOSE"
}

/** @returns {Object<string, number>} index in names of each of MARKERS, and of each feature point: those of the map, or those that a name is */
export function allNumbersOf(names, map) {
  const points = map ? Object.entries(map).filter(([key]) => !MARKERS.includes(key)) : [...featurePoints].filter((point) => find(names, point) >= 0).map((point) => [point, point]);
  const numbers = points.map(([key, wanted]) => [key, find(names, wanted)]);
  const missing = numbers.findIndex(([, number]) => number < 0);
  if (missing >= 0) throw new FileError('', `there is no marker ${JSON.stringify(points[missing][1])} for ${points[missing][0]}`);
  return Object.fromEntries([...MARKERS.map((key, i) => [key, numbersOf(names, map)[i]]), ...numbers]);
}

/** @returns {number[]} index in names of each of MARKERS */
function numbersOf(names, map) {
  if (map) {
    const numbers = MARKERS.map((key) => find(names, map[key]));
    const missing = numbers.indexOf(-1);
    if (missing >= 0) throw new FileError('', `there is no marker ${JSON.stringify(map[MARKERS[missing]])} for ${MARKERS[missing]}: it has ${names.slice(0, 40).join(', ')}`);
    return numbers;
  }
  const named = MARKERS.map((name) => find(names, name));
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
