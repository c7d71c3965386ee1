// SPDX-License-Identifier: GPL-3.0-or-later
/** FAPs of a face with markers: each marker at a feature point of MPEG-4 moves the FAPs of that point, whatever the head does. */
import fs from 'node:fs';
import { FileError } from '../import/limits.mjs';
import { MARKERS } from './articulation.mjs';

const { faps } = JSON.parse(fs.readFileSync(new URL('../../../protocol/fap-table.json', import.meta.url), 'utf8'));

/** Feature points of the thesis's eight markers. The nose and the ears are what the others are measured by. */
const POINTS = { upperLip: '8.1', leftCorner: '8.3', rightCorner: '8.4', lowerLip: '8.2', chin: '2.1' };
/** Inner lips follow the outer ones that have markers. */
const INNER = { 51: 4, 52: 5, 53: 6, 54: 7, 55: 8, 56: 9, 57: 10, 58: 11, 59: 12, 60: 13 };
const FORWARD = { 8.1: 17, 8.2: 16 }; // push_t_lip, push_b_lip: of the inner points 2.2 and 2.3
const HEAD = { pitch: 48, yaw: 49, roll: 50 };
/** Lengths of a face as shares of its mouth's width: means of faccia's heads. */
const OF_MOUTH = { ES: 1.18, ENS: 0.99, MNS: 0.37, IRISD: 0.18 };
const DIRECTIONS = { up: [0, 1, 0], down: [0, -1, 0], left: [1, 0, 0], right: [-1, 0, 0], forward: [0, 0, 1] };
const COUNT = 68;

/** Feature points that a marker may stand at. */
export const featurePoints = new Set(faps.filter(({ unit, direction }) => unit && unit !== 'AU' && DIRECTIONS[direction]).map(({ fdp }) => fdp));

const sub = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

/** Axes of the head: to its left, up, forward; null: not seen. below: a place on the chin's side. tilt: of the plane of nose and ears (articulation.mjs) */
function axesOf([nose, leftEar, rightEar], below, tilt) {
  if (!nose || !leftEar || !rightEar) return null;
  const left = unit(sub(leftEar, rightEar));
  const back = sub(nose, rightEar);
  const forward = unit(sub(back, left.map((x) => x * dot(back, left))));
  const up = cross(forward, left);
  if (dot(sub(below, nose), up) > 0) return null;
  const [c, s] = [Math.cos(tilt), Math.sin(tilt)];
  return { left, up: up.map((x, k) => c * x - s * forward[k]), forward: forward.map((x, k) => c * x + s * up[k]) };
}

const within = ({ left, up, forward }, from, p) => [left, up, forward].map((axis) => dot(sub(p, from), axis));

/** Angles of the head since rest, 1e-5 rad, as FAP 48 to 50 count them. */
function turned(rest, now) {
  const m = [rest.left, rest.up, rest.forward].map((a) => [now.left, now.up, now.forward].map((b) => dot(a, b))); // rest's axes in rows
  const forward = m.map((row) => row[2]);
  const pitch = Math.atan2(-forward[1], Math.hypot(forward[0], forward[2]));
  const yaw = Math.atan2(forward[0], forward[2]);
  const roll = Math.atan2(m[1][0], m[1][1]);
  return { pitch, yaw, roll };
}

const mean = (list) => list[0].map((_, k) => list.reduce((sum, p) => sum + p[k], 0) / list.length);

/**
 * @param {import('./tracks.mjs').Tracks} tracks @param {Object<string, number>} numbers marker or feature point -> its number in the tracks
 * @param {{rest: number[], lengths?: Object<string, number>, tilt?: number}} choices rest: s from the beginning, from and to; lengths: mm of ES, ENS,
 *   MNS, MW, IRISD; tilt: rad
 * @returns {{frames: Map<number, number>[], lengths: object, used: string[]}} FAPs of each frame; what is not seen is left out
 */
export function fapsOfMarkers(tracks, numbers, { rest, lengths = {}, tilt = 0 }) {
  const at = (frame, name) => tracks.at(frame, numbers[name]);
  const axes = tracks.times.map((_, frame) => {
    const below = ['chin', 'lowerLip', 'upperLip'].map((name) => at(frame, name)).find(Boolean);
    return below ? axesOf(['nose', 'leftEar', 'rightEar'].map((name) => at(frame, name)), below, tilt) : null;
  });
  const still = tracks.times.flatMap((time, i) => (axes[i] && time - tracks.times[0] >= rest[0] && time - tracks.times[0] <= rest[1] ? [i] : []));
  if (!still.length) throw new FileError('', `no frame from ${rest.join(' to ')} s has the nose, both ears and a marker below: --rest says another`);
  const upright = axes[still[0]];
  const rests = {};
  for (const name of Object.keys(numbers)) {
    const seen = still.filter((frame) => at(frame, name)).map((frame) => within(axes[frame], at(frame, 'nose'), at(frame, name)));
    if (seen.length) rests[name] = mean(seen);
  }
  if (!lengths.MW && !(rests.leftCorner && rests.rightCorner)) throw new FileError('', 'the width of the mouth is not known: the corners are not seen at rest');
  const MW = lengths.MW ?? Math.hypot(...sub(rests.leftCorner, rests.rightCorner));
  const all = { ...Object.fromEntries(Object.entries(OF_MOUTH).map(([name, share]) => [name, share * MW])), MW, ...lengths };
  const moved = Object.keys(rests).filter((name) => POINTS[name] || !MARKERS.includes(name));
  const taken = new Set(moved.map((name) => POINTS[name] ?? name));
  const frames = tracks.times.map((_, frame) => {
    const out = new Map();
    if (!axes[frame]) return out;
    for (const [name, angle] of Object.entries(turned(upright, axes[frame]))) out.set(HEAD[name], Math.round(angle * 1e5));
    for (const name of moved) {
      const place = at(frame, name);
      if (!place) continue;
      const by = sub(within(axes[frame], at(frame, 'nose'), place), rests[name]);
      const point = POINTS[name] ?? name;
      const put = (number, value) => {
        const { min, max } = faps[number - 1];
        out.set(number, Math.max(min, Math.min(max, Math.round(value))));
      };
      for (const { number, fdp, direction, unit: length } of faps) {
        if (fdp !== point || !all[length] || !DIRECTIONS[direction]) continue;
        const value = (dot(by, DIRECTIONS[direction]) / all[length]) * 1024;
        put(number, value);
        if (INNER[number] && !taken.has(faps[INNER[number] - 1].fdp)) put(INNER[number], value);
      }
      if (FORWARD[point] && !taken.has(faps[FORWARD[point] - 1].fdp)) put(FORWARD[point], (by[2] / all.MNS) * 1024);
    }
    return out;
  });
  return { frames, lengths: all, used: moved };
}

/** Resamples at a frame rate, the nearest frame for each, and writes a .fap file (version 2.1). @param {number[]} times s */
export function toFap(name, times, frames, fps) {
  const count = Math.max(1, Math.floor((times.at(-1) - times[0]) * fps + 1e-6) + 1);
  const lines = [`2.1 ${name} ${fps} ${count}`];
  let near = 0;
  for (let k = 0; k < count; k++) {
    const time = times[0] + k / fps;
    while (near + 1 < times.length && Math.abs(times[near + 1] - time) <= Math.abs(times[near] - time)) near++;
    const values = frames[near];
    const flags = Array.from({ length: COUNT }, (_, i) => Number(values.has(i + 1)));
    lines.push(flags.join(' '), [k, ...flags.flatMap((flag, i) => (flag ? [values.get(i + 1)] : []))].join(' '));
  }
  return `${lines.join('\n')}\n`;
}
