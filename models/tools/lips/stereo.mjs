// SPDX-License-Identifier: GPL-3.0-or-later
/** Places of markers from their tracks in two calibrated cameras, by linear triangulation (R. Hartley and A. Zisserman, "Multiple View Geometry", 12.2). */
import { FileError } from '../import/limits.mjs';
import { Tracks } from './tracks.mjs';

const MOST_PIXELS = 4; // farther from what both cameras saw, a place is a mistake of the tracker

/** @param {string} text JSON: {"cameras": [{"projection": 3 rows of 4}, {...}], "unit"} @returns {{projections: number[][][], unit: string}} */
export function readCameras(text) {
  let read;
  try {
    read = JSON.parse(text);
  } catch (error) {
    throw new FileError('', error.message);
  }
  const { cameras, unit = 'mm' } = read ?? {};
  if (!Array.isArray(cameras) || cameras.length !== 2) throw new FileError('cameras', 'two cameras are wanted');
  const projections = cameras.map((camera, i) => {
    const rows = camera?.projection;
    if (!Array.isArray(rows) || rows.length !== 3 || !rows.every((row) => Array.isArray(row) && row.length === 4 && row.every(Number.isFinite)))
      throw new FileError(`cameras[${i}].projection`, 'three rows of four numbers are wanted: pixels of a place, as homogeneous coordinates');
    return rows;
  });
  return { projections, unit };
}

/** Solves three equations; null if they have no single solution. */
function solve3(a, b) {
  const det = (m) => m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  const all = det(a);
  const size = Math.hypot(...a.flat()) ** 3;
  if (!(Math.abs(all) > 1e-12 * size)) return null;
  return [0, 1, 2].map((k) => det(a.map((row, i) => row.map((x, j) => (j === k ? b[i] : x)))) / all);
}

const seenAt = (projection, place) => {
  const [x, y, w] = projection.map((row) => row[0] * place[0] + row[1] * place[1] + row[2] * place[2] + row[3]);
  return [x / w, y / w];
};

/** @param {number[][][]} projections @param {number[][]} points pixels in each camera @returns {number[]|null} the place, null: they do not agree */
export function triangulate(projections, points) {
  const a = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  const b = [0, 0, 0];
  projections.forEach((p, c) => {
    for (const k of [0, 1]) {
      const row = [0, 1, 2, 3].map((j) => points[c][k] * p[2][j] - p[k][j]);
      for (let i = 0; i < 3; i++) {
        for (let j = 0; j < 3; j++) a[i][j] += row[i] * row[j];
        b[i] -= row[i] * row[3];
      }
    }
  });
  const place = solve3(a, b);
  return place && projections.every((p, c) => Math.hypot(...seenAt(p, place).map((x, k) => x - points[c][k])) <= MOST_PIXELS) ? place : null;
}

/** @param {Tracks[]} flat tracks of two cameras, in pixels, of the same frames @param {{projections: number[][][], unit: string}} cameras @returns {Tracks} */
export function inSpace([left, right], { projections, unit }) {
  if (left.times.length !== right.times.length) throw new FileError('', `the cameras have ${left.times.length} and ${right.times.length} frames`);
  const late = left.times.findIndex((time, i) => Math.abs(time - right.times[i]) > 0.005);
  if (late >= 0) throw new FileError(`frame ${late + 1}`, 'the cameras have it at different times');
  const names = left.names.filter((name) => right.names.includes(name));
  if (!names.length) throw new FileError('', 'no marker has the same name in both cameras');
  const numbers = names.map((name) => [left.names.indexOf(name), right.names.indexOf(name)]);
  const tracks = new Tracks(names, left.rate, unit);
  left.times.forEach((time, frame) =>
    tracks.add(time, (m) => {
      const points = [left.at(frame, numbers[m][0]), right.at(frame, numbers[m][1])];
      return points.includes(null) ? null : triangulate(projections, points);
    }));
  return tracks;
}
