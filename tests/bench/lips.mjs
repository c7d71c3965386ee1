// SPDX-License-Identifier: GPL-3.0-or-later
// How far FAP values put the lips of a head model from where others put them.
import { fapScale } from '../../protocol/fap.mjs';
import { turned } from '../../web/src/head/influences.mjs';
import { readModel } from '../../web/src/head/model.mjs';

const LIPS = [4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60];
/** A vertex is of the lips when a FAP of theirs carries it at least this far with it. */
const SHARE = 0.5;

/** The vertices of the lips of a head model (the object of its JSON), and what moves them beside the head. */
export function lipsOf(json) {
  const model = readModel(json);
  const skin = model.parts.find((part) => part.name === 'skin');
  const number = new Map();
  for (const { fap, vertices, deltas } of skin.moves)
    if (LIPS.includes(fap))
      vertices.forEach((v, i) => Math.hypot(...deltas.subarray(3 * i, 3 * i + 3)) >= SHARE && !number.has(v) && number.set(v, number.size));
  const moves = [];
  for (const { fap, sign, vertices, deltas } of skin.moves) {
    const scale = fapScale(fap, model.fapu);
    vertices.forEach((v, i) => number.has(v) && moves.push({ at: 3 * number.get(v), fap, sign, delta: Array.from(deltas.subarray(3 * i, 3 * i + 3), (d) => d * scale) }));
  }
  const turns = [];
  const last = model.turns.length - model.headTurns;
  for (const { turn, vertices, weights, weight } of skin.turns) {
    const all = vertices ?? Uint16Array.from({ length: skin.vertices }, (_, v) => v);
    if (turn < last)
      all.forEach((v, i) => {
        if (!number.has(v)) return;
        turns.push({ at: 3 * number.get(v), axes: model.turns[turn], weight: weights ? weights[i] : weight, rest: skin.position.slice(3 * v, 3 * v + 3) });
      });
  }
  return { count: number.size, moves, turns };
}

/** Where the vertices go, in mm from their places at rest. */
function shifts({ count, moves, turns }, values) {
  const out = new Float64Array(3 * count);
  for (const { at, fap, sign, delta } of moves) {
    const value = values[fap];
    if (value === 0 || (sign === 'positive' && value < 0) || (sign === 'negative' && value > 0)) continue;
    for (let k = 0; k < 3; k++) out[at + k] += value * delta[k];
  }
  for (const { at, axes, weight, rest } of turns) {
    const angle = values[axes.fap] * axes.radians * weight;
    if (angle) turned(rest, axes, angle).forEach((value, k) => (out[at + k] += value - rest[k]));
  }
  return out;
}

/** The distance in mm of every vertex of the lips. */
export function lipErrors(lips, values, others) {
  const a = shifts(lips, values);
  const b = shifts(lips, others);
  return Float64Array.from({ length: lips.count }, (_, v) => Math.hypot(a[3 * v] - b[3 * v], a[3 * v + 1] - b[3 * v + 1], a[3 * v + 2] - b[3 * v + 2]));
}
