// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * The actions of the FAPs as fields over all base vertices: moves (a displacement for one unit of length) and
 * turns (a weight). Parts take their share of a field at the base vertices they are made of, so brows follow
 * the skin under them.
 */
import { FAPS } from './faps.mjs';

export class Actions {
  /** @param {{p: Float64Array, fdpVertex: Object<string, number>, fapu: Object<string, number>}} face */
  constructor(face) {
    this.face = face;
    this.moves = [];
    this.turns = [];
  }

  /**
   * Adds a move. `at(v, x, y, z)` returns the displacement of a base vertex or null. The field is scaled so
   * that the FAP's feature point follows the FAP exactly in the FAP's direction.
   */
  move(fap, sign, at) {
    const { p, fdpVertex } = this.face;
    const field = new Float64Array(p.length);
    for (let v = 0; v < p.length / 3; v++) {
      const d = at(v, p[v * 3], p[v * 3 + 1], p[v * 3 + 2]);
      if (d) field.set(d, v * 3);
    }
    const { direction, point } = FAPS[fap];
    const at0 = fdpVertex[point] * 3;
    const length = direction.reduce((sum, x, k) => sum + x * field[at0 + k], 0);
    if (!(length > 0)) throw new Error(`FAP ${fap} does not move its feature point ${point}`);
    for (let i = 0; i < field.length; i++) field[i] /= length;
    this.moves.push({ fap, sign, field });
  }

  /** Adds an unscaled move: a second part of an action that must not affect the feature point. */
  plainMove(fap, sign, at) {
    const { p } = this.face;
    const field = new Float64Array(p.length);
    for (let v = 0; v < p.length / 3; v++) {
      const d = at(v, p[v * 3], p[v * 3 + 1], p[v * 3 + 2]);
      if (d) field.set(d, v * 3);
    }
    this.moves.push({ fap, sign, field });
  }

  /** Adds a turn with its weight at each base vertex; `rigid` gives whole parts one weight, `spared` parts none. */
  turn({ name, fap, pivot, axis, radians, at = () => 0, rigid = {}, spared = [] }) {
    const { p } = this.face;
    const weights = new Float64Array(p.length / 3);
    for (let v = 0; v < weights.length; v++) weights[v] = at(v, p[v * 3], p[v * 3 + 1], p[v * 3 + 2]);
    this.turns.push({ name, fap, pivot, axis, radians, weights, rigid, spared });
  }
}

/** Returns the displacement by weight along a direction, or null if it is zero. */
export function along(weight, direction) {
  return Math.abs(weight) < 1e-5 ? null : direction.map((x) => x * weight);
}
