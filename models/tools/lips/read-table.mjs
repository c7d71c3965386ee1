// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Reads marker tracks from text: TRC (Motion Analysis, OpenSim), and CSV tables with a column for each coordinate (NAME_x, NAME_y, NAME_z or
 * NAME.x...), with or without a time column; without names, the columns of eight markers.
 */
import { FileError } from '../import/limits.mjs';
import { Tracks } from './tracks.mjs';

const MOST_MARKERS = 512;

/** Yields lines with their numbers, without splitting the whole file. */
function* linesOf(text) {
  for (let at = text.startsWith('\ufeff') ? 1 : 0, number = 1; at < text.length; number++) {
    const end = text.indexOf('\n', at);
    const stop = end < 0 ? text.length : end;
    yield { line: text.slice(at, stop).replace(/\r$/, ''), number };
    at = stop + 1;
  }
}

/** Parses a number; null if empty. Errors report the position. */
function numberIn(field, line, column) {
  const word = (field ?? '').trim();
  if (!word || /^nan$/i.test(word)) return null;
  const value = Number(word);
  if (!Number.isFinite(value)) throw new FileError(`line ${line}, column ${column}`, `"${word.slice(0, 20)}" is not a number`);
  return value;
}

/** Returns a marker's position from its columns in a row of numbers. */
const placeIn = (row, columns) => {
  const p = columns.map((c) => row[c] ?? null);
  return p.includes(null) ? null : p;
};

function rising(time, last, line) {
  if (time === null) throw new FileError(`line ${line}`, 'there is no time');
  if (!(time > last)) throw new FileError(`line ${line}`, 'the time does not rise');
  return time;
}

/** @param {string} text @returns {Tracks} @throws {FileError} */
export function readTrc(text) {
  const lines = linesOf(text);
  const next = (what) => {
    const { value, done } = lines.next();
    if (done) throw new FileError('', `the file ends where ${what} should be`);
    return value;
  };
  if (!next('its first line').line.startsWith('PathFileType')) throw new FileError('line 1', 'this is no TRC file: it begins with PathFileType');
  const [keys, values] = [next('the names of its settings'), next('its settings')].map(({ line }) => line.trim().split(/\s+/));
  const settings = Object.fromEntries(keys.map((key, i) => [key, values[i]]));
  const rate = Number(settings.DataRate);
  if (!(rate > 0 && rate <= 10000)) throw new FileError('line 3', `DataRate is ${settings.DataRate}, and must be frames per second`);
  const names = next('the names of the markers').line.split('\t').slice(2).map((name) => name.trim()).filter(Boolean);
  if (!names.length || names.length > MOST_MARKERS) throw new FileError('line 4', `${names.length} markers: there must be 1 to ${MOST_MARKERS}`);
  next('the names of the coordinates');
  const tracks = new Tracks(names, rate, settings.Units);
  let last = -Infinity;
  for (const { line, number } of lines) {
    if (!line.trim()) continue;
    const row = line.split('\t').map((field, i) => numberIn(field, number, i + 1));
    if (row.length > 2 + 3 * names.length + 1) throw new FileError(`line ${number}`, `${row.length} fields, where ${2 + 3 * names.length} are wanted`);
    last = rising(row[1] ?? null, last, number);
    tracks.add(last, (m) => placeIn(row, [2 + 3 * m, 3 + 3 * m, 4 + 3 * m]));
  }
  return tracks;
}

/** Assigns columns to markers by their headings. */
function markersIn(headings, line, axes) {
  const markers = new Map();
  headings.forEach((heading, column) => {
    const [, name, axis] = /^(.+?)[ _.:]?([xyz])$/i.exec(heading) ?? [];
    if (!name) return;
    const columns = markers.get(name) ?? markers.set(name, []).get(name);
    columns['xyz'.indexOf(axis.toLowerCase())] = column;
  });
  for (const columns of markers.values()) columns.length = Math.min(columns.length, axes);
  for (const [name, columns] of markers) if (columns.filter((c) => c !== undefined).length < axes) markers.delete(name);
  if (!markers.size) throw new FileError(`line ${line}`, axes < 3 ? 'no two columns are named NAME_x and NAME_y' : 'no three columns are named NAME_x, NAME_y and NAME_z');
  if (markers.size > MOST_MARKERS) throw new FileError(`line ${line}`, `${markers.size} markers: at most ${MOST_MARKERS}`);
  return markers;
}

/** @param {string} text @param {{fps?: number, unit?: string, flat?: boolean}} options flat: pixels of one camera @returns {Tracks} @throws {FileError} */
export function readCsv(text, { fps, unit, flat = false }) {
  let shape = null;
  let frame = 0;
  let last = -Infinity;
  for (const { line, number } of linesOf(text)) {
    if (!line.trim()) continue;
    const separator = shape?.separator ?? [';', '\t', ','].find((c) => line.includes(c)) ?? ',';
    const fields = line.split(separator).map((field) => field.trim().replace(/^"(.*)"$/, '$1'));
    if (!shape) {
      shape = { separator, ...shapeOf(fields, number, flat) };
      if (shape.time < 0 && !(fps > 0)) throw new FileError(`line ${number}`, 'there is no column "time": --fps says how many frames a second there are');
      shape.tracks = new Tracks([...shape.markers.keys()], fps ?? 0, flat ? undefined : unit);
      if (shape.named) continue;
    }
    const row = fields.map((field, i) => numberIn(field, number, i + 1));
    last = rising(shape.time < 0 ? frame / fps : (row[shape.time] ?? null), last, number);
    const columns = [...shape.markers.values()];
    shape.tracks.add(last, (m) => (flat ? placeIn(row, columns[m])?.concat(0) : placeIn(row, columns[m])) ?? null);
    frame++;
  }
  if (!shape) throw new FileError('', 'the file is empty');
  return shape.tracks;
}

/** Finds the columns of time and markers: by the names in the first line or, if it has numbers, in the order of the thesis. */
function shapeOf(fields, line, flat) {
  if (fields.some((field) => field && !Number.isFinite(Number(field)))) {
    const time = fields.findIndex((field) => ['time', 't'].includes(field.toLowerCase()));
    return { named: true, time, markers: markersIn(fields, line, flat ? 2 : 3) };
  }
  if (flat) throw new FileError(`line ${line}`, 'the first line must name the columns: NAME_x, NAME_y');
  const from = fields.length % 3;
  if (from > 1 || fields.length < 3) throw new FileError(`line ${line}`, `${fields.length} numbers without names: three for each marker are wanted, and a time before them`);
  const names = Array.from({ length: Math.floor(fields.length / 3) }, (_, m) => [`marker ${m + 1}`, [0, 1, 2].map((k) => from + 3 * m + k)]);
  return { named: false, time: from ? 0 : -1, markers: new Map(names) };
}
