// SPDX-License-Identifier: GPL-3.0-or-later
/** Actions of a head from the animation table of an FDP node (fdp-node.mjs), in the place of those from zones. */
import { unitLength } from '../../lib/deform.mjs';
import { FAPS } from '../../lib/faps.mjs';
import { moveOf } from './targets.mjs';

/** What one mm (or radian) of the FAP does, from a target in mm. */
const PER = {
  radian: () => 1, // displacements are given for a radian already
  length: ({ scale }) => 1 / scale, // without a dimension
  unit: ({ fapu }, fap) => 1 / unitLength({ fapu }, fap), // for one unit of the FAP
};

/**
 * @param {object} animation of the scene @param {object[]} parts gathered @param {object} placed of placeHead
 * @param {(part: object) => null|[number, number][]} followed the skin's vertex and a share for each vertex of a part that has no actions of its own
 * @returns {{faps: number[], turns: object[], notes: string[], replace: Function}} replace: a part's moves and turns, given those from zones
 */
export function actFromTable({ moves, turns: given, notes }, parts, placed, followed) {
  const skin = parts.find(({ name }) => name === 'skin');
  const turns = given.filter(({ fap }) => !FAPS[fap].headTurn).map(({ key, fap, pivot, end, radians }) => {
    const [from, to] = [placed.place(pivot), placed.place(end)];
    const axis = to.map((x, k) => x - from[k]);
    const length = Math.hypot(...axis) || 1;
    return { key, name: `table_${fap}_${key.split(' ')[1]}`, fap, pivot: from, axis: axis.map((x) => x / length), radians };
  });

  /** Moves and turns that the table has for a part. */
  const ownOf = (part) => {
    const own = [...moves].flatMap(([name, move]) => {
      const field = !FAPS[move.fap].headTurn && part.targets[name]?.map((x) => x * PER[move.per](placed, move.fap));
      const made = field && moveOf(move.fap, move.sign, field);
      return made ? [{ ...made, ...(move.from ? { from: move.from } : {}) }] : [];
    });
    const shares = turns.flatMap(({ key, name }) => {
      const pieces = part.pieces.filter(({ mesh }) => mesh.turns?.includes(key));
      if (!pieces.length) return [];
      if (pieces.length === part.pieces.length) return [{ turn: name, weight: 1 }];
      const vertices = pieces.flatMap(({ at, count }) => Array.from({ length: count }, (_, i) => at + i));
      return [{ turn: name, vertices, weights: vertices.map(() => 1) }];
    });
    return { moves: own, turns: shares };
  };
  const owns = new Map(parts.map((part) => [part, ownOf(part)]));
  const fapOf = (turnName, list) => list.find(({ name }) => name === turnName).fap;
  const fapsOf = (own) => [...own.moves.map(({ fap }) => fap), ...own.turns.map(({ turn }) => fapOf(turn, turns))];
  const faps = [...new Set([...owns.values()].flatMap(fapsOf))].sort((a, b) => a - b);

  const replace = (part, zones, allTurns) => {
    const own = owns.get(part);
    const follows = followed(part);
    const skins = follows ? owns.get(skin).moves.flatMap(({ vertices, deltas, ...move }) => {
      const at = new Map(vertices.map((v, i) => [v, i]));
      const field = Float64Array.from({ length: 3 * follows.length }, (_, i) => {
        const [v, share] = follows[Math.floor(i / 3)];
        return at.has(v) ? share * deltas[3 * at.get(v) + (i % 3)] : 0;
      });
      const made = moveOf(move.fap, move.sign, field);
      return made ? [{ ...made, ...(move.from ? { from: move.from } : {}) }] : [];
    }) : [];
    const replaced = new Set(part === skin || follows ? faps : fapsOf(own));
    return {
      moves: [...zones.moves.filter(({ fap }) => !replaced.has(fap)), ...own.moves, ...skins],
      turns: [...own.turns, ...zones.turns.filter(({ turn }) => !replaced.has(fapOf(turn, allTurns)))], // those of the head last
    };
  };
  return { faps, turns: turns.map(({ key: _, ...turn }) => turn), notes, replace };
}
