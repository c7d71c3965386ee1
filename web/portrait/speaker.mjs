// SPDX-License-Identifier: MIT
/**
 * A speaker's face as a net of places on the skin, with what each FAP does to them: a base head laid onto the landmarks
 * of the face at rest.
 */
import { readModel } from '../element/head/model/model.mjs';
import { fitShape, laid } from './fit.mjs';
import { morph } from './morph.mjs';
import { SPEECH } from './fap-moves.mjs';
import { movedBy, unitLength } from './moved.mjs';

const STEP = 1.25; // mm between the places
const TRIAL = 3; // mm: trial value of a FAP
const BOX = { left: -52, right: 52, below: -24, above: 34 }; // mm: below: from the chin; the others from between the eyes
const FACING = 0.45; // cosine: what looks more aside is left out
const LEAST = 0.004; // mm for a mm: what moves less stands
const LIDS = 0.02; // least weight of a lid for a point that counts as part of it

/** The base head's skin in the shape of the face; moved: what a FAP does to it, in mm for a mm. */
function skinOf(json, base, landmarks) {
  const model = readModel(json);
  const changed = morph(model, base, fitShape([{ landmarks }], base).target);
  const part = model.parts.find(({ name }) => name === 'skin');
  const skin = { ...part, position: changed.positions.get(part) };
  const lids = new Float64Array(skin.vertices);
  for (const { turn, vertices, weights } of skin.turns)
    if (model.turns[turn].name.startsWith('lid')) vertices?.forEach((v, i) => (lids[v] = Math.max(lids[v], weights[i])));
  const moved = (fap, mm) => {
    const unit = unitLength(model, fap);
    return movedBy(skin, changed.turns, fap, mm / unit, unit).map((x) => x / Math.abs(mm));
  };
  return { ...skin, moved, lids, fdp: changed.fdp, fapu: changed.fapu };
}

/** For places in steps over the face, seen from the front: the triangle that is nearest, and where in it. */
function seenPlaces({ position: p, index, lids, fdp }) {
  const [x0, y0] = [BOX.left, fdp['2.1'][1] + BOX.below];
  const [columns, rows] = [Math.floor((BOX.right - x0) / STEP) + 1, Math.floor((BOX.above - y0) / STEP) + 1];
  const depth = new Float64Array(columns * rows).fill(-Infinity);
  const found = new Array(columns * rows);
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [index[t], index[t + 1], index[t + 2]];
    const [ax, ay, bx, by, cx, cy] = [p[3 * a], p[3 * a + 1], p[3 * b], p[3 * b + 1], p[3 * c], p[3 * c + 1]];
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (area <= 0) continue; // from behind
    const [bz, cz] = [p[3 * b + 2] - p[3 * a + 2], p[3 * c + 2] - p[3 * a + 2]];
    const size = Math.hypot(area, (by - ay) * cz - bz * (cy - ay), bz * (cx - ax) - (bx - ax) * cz);
    const within = (from, count, ...values) => [Math.max(0, Math.ceil((Math.min(...values) - from) / STEP)),
      Math.min(count - 1, Math.floor((Math.max(...values) - from) / STEP))];
    const [i0, i1] = within(x0, columns, ax, bx, cx);
    const [j0, j1] = within(y0, rows, ay, by, cy);
    for (let j = j0; j <= j1; j++)
      for (let i = i0; i <= i1; i++) {
        const [x, y] = [x0 + i * STEP, y0 + j * STEP];
        const wb = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area;
        const wc = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area;
        if (wb < 0 || wc < 0 || wb + wc > 1) continue;
        const w = [1 - wb - wc, wb, wc];
        const z = w[0] * p[3 * a + 2] + wb * p[3 * b + 2] + wc * p[3 * c + 2];
        if (z <= depth[j * columns + i]) continue;
        depth[j * columns + i] = z;
        found[j * columns + i] = { corners: [a, b, c], w, facing: area / size, lid: Math.max(lids[a], lids[b], lids[c]) };
      }
  }
  return found.filter((one) => one && one.facing > FACING && one.lid < LIDS);
}

/**
 * @param {object} json a base head @param {import('./fit.mjs').Points} base its landmarks
 * @param {number[][]} landmarks of the speaker's face at rest @param {number[]} [moved] FAPs that may move
 * @returns {{count: number, place: Float64Array, fields: object[], mouth: number[], turn: number[][], scale: number,
 *   onto: number[]}} place: three numbers each,
 *   mm of the base head; fields: of each of `moved` what a mm of it does, up and down (`positive`, `negative`): which of
 *   those numbers it changes, and by how
 *   much; mouth: every second place that lips and jaw move; on: of each place the corners of its triangle of the skin, and
 *   their shares; the rest as pictured tells
 */
export function speakerOf(json, base, landmarks, moved = SPEECH.moved) {
  const skin = skinOf(json, base, landmarks);
  const places = seenPlaces(skin);
  const at = (values) => {
    const out = new Float64Array(3 * places.length);
    places.forEach(({ corners, w }, i) => {
      for (let k = 0; k < 3; k++) out[3 * i + k] = corners.reduce((sum, v, c) => sum + w[c] * values[3 * v + k], 0);
    });
    return out;
  };
  const moving = (fap, mm) => {
    const all = at(skin.moved(fap, mm));
    const which = Uint32Array.from(all.keys()).filter((i) => Math.abs(all[i]) > LEAST);
    return { at: which, mm: Float64Array.from(which, (i) => all[i]) };
  };
  const fields = moved.map((fap) => ({ positive: moving(fap, TRIAL), negative: moving(fap, -TRIAL) }));
  const stand = pictured(landmarks, base);
  const place = at(skin.position);
  const lips = [4, 5, 8, 9, 10, 11].map((fap) => fields[moved.indexOf(fap)].negative);
  const opened = new Set([fields[moved.indexOf(3)].positive, ...lips].flatMap(({ at: numbers, mm }) =>
    [...numbers].filter((_, i) => Math.abs(mm[i]) > 0.1).map((i) => Math.floor(i / 3))));
  const mouth = [...opened].filter((_, i) => i % 2);
  return { count: places.length, place, fields, mouth, skin, on: places, ...stand };
}

/**
 * Returns the projection of the base's mm into the picture: columns and rows are the first two of scale * turn * place, rows
 * downward, from `onto`.
 */
export function pictured(landmarks, base) {
  const { turn, points } = laid(landmarks, base);
  const [a, b] = [10, 152];
  const apart = (list) => Math.hypot(...[0, 1, 2].map((k) => list[a][k] - list[b][k]));
  const scale = apart(landmarks) / apart(points);
  const back = turn[0].map((_, k) => turn.map((row) => row[k])); // transposed: out of the head into the picture
  const shown = (p) => [scale * dot(back[0], p), -scale * dot(back[1], p)];
  const [u, v] = shown(points[a]);
  return { turn: back, scale, onto: [landmarks[a][0] - u, landmarks[a][1] - v] };
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
