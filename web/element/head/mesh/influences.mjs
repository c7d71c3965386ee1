// SPDX-License-Identifier: MIT
import { faps, fapScale } from '../../../../protocol/fap.mjs';
import { BREATH } from '../model/model.mjs';
import { Normals } from './normals.mjs';

const TRIAL_MM = 2; // the normals' change is measured at about this displacement
const TRIAL_RADIANS = 0.15;
const LIDS = [19, 20]; // upper lids unfold as they come down: so their normals are right when they are down,
const DOWN = 1024; // at this value
const NOWHERE = [0, 0, 0];
const LEAST_NORMAL_CHANGE = 0.004; // at the trial displacement: smaller changes are invisible

/**
 * The numbers that the actions of a head are driven by. A *slot* is a FAP in one of its senses, in mm (or radians); a turn
 * has an angle. Both are linear in the FAP's value.
 */
export class Drive {
  /** @param {ReturnType<import('../model/model.mjs').readModel>} model */
  constructor(model) {
    this.fapu = model.fapu;
    this.turns = model.turns.map((turn) => (turn.sways ? { ...turn } : turn)); // its axis changes
    this.swaying = this.turns.flatMap(({ sways }, i) => (sways ? [i] : []));
    this.firstHeadTurn = model.turns.length - model.headTurns;
    this.slots = [];
    this.numbers = new Map();
    for (const part of model.parts) for (const move of part.moves) this.slot(move.fap, move.sign, move.from);
    this.slotValues = new Float32Array(Math.max(1, this.slots.length));
    this.angles = new Float32Array(Math.max(1, this.turns.length));
  }

  /** The number of a slot, made when it is new. */
  slot(fap, sign, from = 0) {
    const key = `${fap} ${sign} ${from}`;
    if (!this.numbers.has(key)) {
      this.numbers.set(key, this.slots.length);
      this.slots.push({ fap, sign, from, scale: fap === BREATH ? 1 : fapScale(fap, this.fapu) });
    }
    return this.numbers.get(key);
  }

  /** @param {Float32Array} values by FAP number, the breath at 0 @param {number[]} [lag] of Sway @returns {this} */
  set(values, lag) {
    this.slots.forEach(({ fap, sign, from, scale }, i) => {
      this.slotValues[i] = pastOf(values[fap], sign, from) * scale;
    });
    this.turns.forEach(({ fap, radians }, i) => (this.angles[i] = values[fap] * radians));
    const angle = lag ? Math.hypot(...lag) : 0;
    if (angle)
      for (const i of this.swaying) {
        this.turns[i].axis = lag.map((x) => x / angle);
        this.angles[i] = angle;
      }
    return this;
  }

  /** Applies the head's turns to a point that follows them wholly. */
  withHead(p) {
    for (let i = this.firstHeadTurn; i < this.turns.length; i++) p = turned(p, this.turns[i], this.angles[i]);
    return p;
  }
}

/** What of a FAP's value counts for a move of that sign, from that value on. */
export const pastOf = (value, sign, from = 0) =>
  sign === 'both' ? value : sign === 'positive' ? Math.max(0, value - from) : Math.min(0, value + from);

/** `p` turned about an axis (unit) through `pivot`. */
export function turned(p, { pivot, axis }, angle) {
  const [x, y, z] = [p[0] - pivot[0], p[1] - pivot[1], p[2] - pivot[2]];
  const [u, v, w] = axis;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const dot = (u * x + v * y + w * z) * (1 - c);
  return [
    pivot[0] + x * c + (v * z - w * y) * s + u * dot,
    pivot[1] + y * c + (w * x - u * z) * s + v * dot,
    pivot[2] + z * c + (u * y - v * x) * s + w * dot,
  ];
}

/**
 * Collects the moves and turns that act on each vertex of a part.
 * @typedef {{slot: number, delta: number[], normal: number[]}} VertexMove mm and change of the normal for one mm (radian)
 * @typedef {{turn: number, weight: number}} VertexTurn in the order of application
 * @param {import('../model/model.mjs').Part} part @param {Drive} drive
 * @returns {{normals: Float32Array, moves: VertexMove[][], turns: VertexTurn[][]}}
 */
export function influencesOf(part, drive) {
  const normals = new Normals(part);
  const moves = Array.from({ length: part.vertices }, () => []);
  const turns = Array.from({ length: part.vertices }, () => []);
  const trial = part.position.slice();
  const restore = (vertices) => {
    for (const v of vertices) for (let k = 0; k < 3; k++) trial[3 * v + k] = part.position[3 * v + k];
  };

  /** Adds what `displaced` says about the normals, over what is explained already, as a move in `slot`. */
  const addNormals = (vertices, slot, amount, deltaOf, explained) => {
    for (const [v, normal] of normals.displaced(vertices, trial)) {
      const before = explained(v);
      const change = [normal[0] - before[0], normal[1] - before[1], normal[2] - before[2]];
      const delta = deltaOf(v);
      if (!delta && Math.hypot(change[0], change[1], change[2]) < LEAST_NORMAL_CHANGE) continue;
      moves[v].push({ slot, delta: delta ?? NOWHERE, normal: change.map((value) => value / amount) });
    }
    restore(vertices);
  };
  const restNormal = (v) => normals.rest.subarray(3 * v, 3 * v + 3);

  for (const { fap, sign, from, vertices, deltas } of part.moves) {
    const largest = deltas.reduce((max, value) => Math.max(max, Math.abs(value)), 1e-6);
    const amount = ((sign === 'negative' ? -1 : 1) * TRIAL_MM) / largest;
    const own = new Map();
    vertices.forEach((v, i) => {
      own.set(v, [...deltas.subarray(3 * i, 3 * i + 3)]);
      for (let k = 0; k < 3; k++) trial[3 * v + k] += amount * deltas[3 * i + k];
    });
    addNormals(vertices, drive.slot(fap, sign, from), amount, (v) => own.get(v), restNormal);
  }

  for (const { turn, vertices, weights, weight } of part.turns) {
    const list = vertices ?? Uint16Array.from({ length: part.vertices }, (_, v) => v);
    const weightOf = new Map();
    list.forEach((v, i) => {
      weightOf.set(v, weights ? weights[i] : weight);
      turns[v].push({ turn, weight: weights ? weights[i] : weight });
    });
    const { fap, radians } = drive.turns[turn];
    if (!weights || turn >= drive.firstHeadTurn || !radians) continue;
    // Between neighbours that turn by different angles the skin shears, which turning the normal alone would miss.
    const angle = LIDS.includes(fap) ? DOWN * radians : (faps[fap].bidirectional ? 1 : Math.sign(radians)) * TRIAL_RADIANS;
    const axis = { ...drive.turns[turn], pivot: [0, 0, 0] };
    for (const v of list)
      turned(part.position.subarray(3 * v, 3 * v + 3), drive.turns[turn], angle * weightOf.get(v)).forEach(
        (value, k) => (trial[3 * v + k] = value),
      );
    const scale = fapScale(fap, drive.fapu);
    const amount = (angle / radians) * scale;
    addNormals(list, drive.slot(fap, 'both'), amount, () => null, (v) =>
      turned(restNormal(v), axis, angle * (weightOf.get(v) ?? 0)),
    );
  }
  turns.forEach((list) => list.sort((a, b) => a.turn - b.turn));
  return { normals: normals.rest, moves, turns };
}

/** Stored instead of the number of head turns when the vertex follows all of them fully, so that one matrix suffices. */
export const WHOLE_HEAD = 63;

/**
 * Packs the influences into one texture of RGBA floats: a move takes two texels (slot and delta, change of the normal),
 * a turn one (turn, weight). Each vertex gets (first move, moves, first turn, turns + 64 * turns of the head).
 * `needs` says what there is of each kind.
 */
export function packInfluences({ moves, turns }, { firstHeadTurn, turns: all }) {
  const headTurns = all.length - firstHeadTurn;
  const vertices = new Float32Array(4 * moves.length);
  const texels = [];
  moves.forEach((list, v) => {
    vertices[4 * v] = texels.length / 4;
    vertices[4 * v + 1] = list.length;
    for (const { slot, delta, normal } of list) texels.push(slot, ...delta, 0, ...normal);
  });
  const shared = new Map(); // many vertices turn alike
  turns.forEach((list, v) => {
    const key = list.map(({ turn, weight }) => `${turn}:${weight}`).join();
    if (!shared.has(key)) {
      shared.set(key, texels.length / 4);
      for (const { turn, weight } of list) texels.push(turn, weight, 0, 0);
    }
    const ofHead = list.filter(({ turn }) => turn >= firstHeadTurn);
    const whole = ofHead.length === headTurns && ofHead.every(({ weight }) => weight === 1);
    vertices[4 * v + 2] = shared.get(key);
    vertices[4 * v + 3] = list.length - ofHead.length + 64 * (whole ? WHOLE_HEAD : ofHead.length);
  });
  const width = 1024; // as in the shader
  const height = Math.max(1, Math.ceil(texels.length / 4 / width));
  const data = new Float32Array(4 * width * height);
  data.set(texels);
  const needs = {
    MOVES: Number(moves.some((list) => list.length)),
    OWN_TURNS: Number(turns.some((list) => list.some(({ turn }) => turn < firstHeadTurn))),
    PARTIAL_HEAD: Number(turns.some((list) => list.some(({ turn, weight }) => turn >= firstHeadTurn && weight !== 1))),
  };
  return { vertices, data, width, height, needs };
}
