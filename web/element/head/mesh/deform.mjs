// SPDX-License-Identifier: MIT
import { turned } from './influences.mjs';

/**
 * The deformation of protocol/head-model.md without a GPU: what the vertex shader does, for all vertices of a part.
 * @param {import('../model/model.mjs').Part} part
 * @param {ReturnType<import('./influences.mjs').influencesOf>} influences
 * @param {import('./influences.mjs').Drive} drive with the FAPs set
 * @returns {{position: Float32Array, normal: Float32Array}}
 */
export function deform(part, { normals, moves, turns }, { slotValues, angles, turns: axes, firstHeadTurn }) {
  const position = new Float32Array(part.position.length);
  const normal = new Float32Array(part.position.length);
  const flat = axes.map(({ axis }) => ({ axis, pivot: [0, 0, 0] }));
  for (let v = 0; v < part.vertices; v++) {
    const rest = part.position.subarray(3 * v, 3 * v + 3);
    const up = normals.subarray(3 * v, 3 * v + 3);
    let p = [...rest];
    let n = [...up];
    for (const { slot, delta, normal: change } of moves[v])
      for (let k = 0; k < 3; k++) {
        p[k] += slotValues[slot] * delta[k];
        n[k] += slotValues[slot] * change[k];
      }
    for (const { turn, weight } of turns[v]) {
      const angle = angles[turn] * weight;
      if (!angle) continue;
      if (turn < firstHeadTurn) {
        turned(rest, axes[turn], angle).forEach((value, k) => (p[k] += value - rest[k]));
        turned(up, flat[turn], angle).forEach((value, k) => (n[k] += value - up[k]));
      } else {
        p = turned(p, axes[turn], angle);
        n = turned(n, flat[turn], angle);
      }
    }
    position.set(p, 3 * v);
    const length = Math.hypot(...n) || 1;
    for (let k = 0; k < 3; k++) normal[3 * v + k] = n[k] / length;
  }
  return { position, normal };
}

/**
 * The deformation of protocol/head-model.md on the CPU, for machines without a GPU: a vertex shader has to test each move of a
 * vertex, while this loop visits active moves only.
 */
export class SoftwareDeform {
  #moves = new Map(); // slot -> {vertices, deltas (position and change of the normal: six numbers each)}
  #turns = new Map(); // turn -> {vertices, kinds, weights}
  #heads = []; // turns of the head that not every vertex makes wholly
  #moved = false; // whether it stands anywhere but at rest

  /**
   * @param {import('../model/model.mjs').Part} part @param {ReturnType<import('./influences.mjs').influencesOf>} influences
   * @param {Float32Array} normals as drawn @param {import('./influences.mjs').Drive} drive
   * @param {boolean} [whole] false: the turns of the head are made here, even if every vertex makes them wholly
   */
  constructor(part, { moves, turns }, normals, drive, whole = true) {
    this.rest = { position: part.position, normal: normals };
    this.position = part.position.slice();
    this.normal = normals.slice();
    const moveLists = new Map();
    const turnLists = new Map();
    const push = (lists, key, ...values) => (lists.get(key) ?? lists.set(key, []).get(key)).push(...values);
    moves.forEach((list, v) => list.forEach(({ slot, delta, normal }) => push(moveLists, slot, v, ...delta, ...normal)));
    turns.forEach((list, v) => list.forEach(({ turn, weight }) => push(turnLists, turn, v, weight)));
    for (const [slot, list] of moveLists) {
      const count = list.length / 7;
      const vertices = Uint16Array.from({ length: count }, (_, i) => list[7 * i]);
      const deltas = Float32Array.from({ length: 6 * count }, (_, i) => list[7 * Math.floor(i / 6) + 1 + (i % 6)]);
      this.#moves.set(slot, { vertices, deltas });
    }
    const first = drive.firstHeadTurn;
    for (const [turn, list] of turnLists) {
      const vertices = Uint16Array.from({ length: list.length / 2 }, (_, i) => list[2 * i]);
      const weights = [...new Set(list.filter((_, i) => i % 2))];
      const numbers = new Map(weights.map((weight, i) => [weight, i]));
      const kinds = Uint16Array.from({ length: vertices.length }, (_, i) => numbers.get(list[2 * i + 1]));
      if (turn < first) this.#turns.set(turn, { vertices, kinds, weights });
      else this.#heads.push({ turn, vertices, kinds, weights });
    }
    this.#heads.sort((a, b) => a.turn - b.turn);
    /** Every vertex goes wholly with the head: one matrix, in the shader, does that. */
    this.whole =
      whole &&
      this.#heads.length === drive.turns.length - first &&
      this.#heads.every(({ vertices, weights }) => vertices.length === part.vertices && weights.every((one) => one === 1));
    if (this.whole) this.#heads = [];
  }

  /** Whether anything acts on it here. */
  get acts() {
    return this.#moves.size + this.#turns.size + this.#heads.length > 0;
  }

  /**
   * @param {import('./influences.mjs').Drive} drive with the FAPs set
   * @returns {boolean} whether `position` and `normal` have changed
   */
  update({ slotValues, angles, turns: axes }) {
    const { position, normal, rest } = this;
    const moves = [...this.#moves].filter(([slot]) => slotValues[slot]);
    const turns = [...this.#turns].filter(([turn]) => angles[turn]);
    const heads = this.#heads.filter(({ turn }) => angles[turn]);
    const moved = moves.length + turns.length + heads.length > 0;
    if (!moved && !this.#moved) return false;
    this.#moved = moved;
    position.set(rest.position);
    normal.set(rest.normal);
    for (const [slot, { vertices, deltas }] of moves) add(position, normal, vertices, deltas, slotValues[slot]);
    for (const [turn, list] of turns) turnBy(position, normal, rest.position, rest.normal, list, axes[turn], angles[turn]);
    for (const { turn, ...list } of heads) turnBy(position, normal, position, normal, list, axes[turn], angles[turn]);
    return true;
  }
}

function add(position, normal, vertices, deltas, value) {
  for (let i = 0, d = 0; i < vertices.length; i++, d += 6) {
    const v = 3 * vertices[i];
    position[v] += value * deltas[d];
    position[v + 1] += value * deltas[d + 1];
    position[v + 2] += value * deltas[d + 2];
    normal[v] += value * deltas[d + 3];
    normal[v + 1] += value * deltas[d + 4];
    normal[v + 2] += value * deltas[d + 5];
  }
}

/**
 * Adds what a turn does with `p` and `n`. Weights come from bytes, so there are few: each has a matrix.
 * @param {{vertices: Uint16Array, kinds: Uint16Array, weights: number[]}} list kinds: which of the weights a vertex has
 */
function turnBy(position, normal, p, n, { vertices, kinds, weights }, { pivot, axis }, angle) {
  const matrices = new Float64Array(9 * weights.length);
  weights.forEach((weight, i) => matrices.set(matrixOf(axis, angle * weight), 9 * i));
  const [cx, cy, cz] = pivot;
  for (let i = 0; i < vertices.length; i++) {
    const m = 9 * kinds[i];
    const v = 3 * vertices[i];
    const x = p[v] - cx;
    const y = p[v + 1] - cy;
    const z = p[v + 2] - cz;
    const a = n[v];
    const b = n[v + 1];
    const c = n[v + 2];
    position[v] += matrices[m] * x + matrices[m + 3] * y + matrices[m + 6] * z;
    position[v + 1] += matrices[m + 1] * x + matrices[m + 4] * y + matrices[m + 7] * z;
    position[v + 2] += matrices[m + 2] * x + matrices[m + 5] * y + matrices[m + 8] * z;
    normal[v] += matrices[m] * a + matrices[m + 3] * b + matrices[m + 6] * c;
    normal[v + 1] += matrices[m + 1] * a + matrices[m + 4] * b + matrices[m + 7] * c;
    normal[v + 2] += matrices[m + 2] * a + matrices[m + 5] * b + matrices[m + 8] * c;
  }
}

/** A rotation less the identity, column by column. */
function matrixOf(axis, angle) {
  const at = { pivot: [0, 0, 0], axis };
  return [[1, 0, 0], [0, 1, 0], [0, 0, 1]].flatMap((e) => turned(e, at, angle).map((value, k) => value - e[k]));
}
