// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * A part of a head has one picture. Splits a part with several pictures into several parts, `skin` and `skin_2`, after its movements are computed, so that shared
 * borders move together.
 */

/** Groups the vertices of a part's pieces by picture, the main one first; pieces without a picture join it. @returns {{look: number, vertices: number[]}[]} */
function byPicture({ pieces, material }, { materials }, main) {
  const groups = new Map();
  const all = ({ at, count }) => Array.from({ length: count }, (_, i) => at + i);
  for (const piece of pieces) {
    const picture = materials[piece.mesh.material]?.picture;
    if (!picture) continue;
    if (!groups.has(picture)) groups.set(picture, { look: piece.mesh.material, vertices: [] });
    groups.get(picture).vertices.push(...all(piece));
  }
  if (groups.size < 2) return null;
  const list = [...groups.values()].sort((a, b) => Number(b.vertices.includes(main)) - Number(a.vertices.includes(main)) || b.vertices.length - a.vertices.length);
  const plain = pieces.filter(({ mesh }) => !materials[mesh.material]?.picture).flatMap(all);
  list[0].vertices.push(...plain);
  if (main < 0) list.sort((a, b) => Number(b.look === material) - Number(a.look === material));
  return list;
}

/** Extracts some of a part's vertices with their triangles, moves and turns. */
function cutOut(part, name, vertices) {
  const number = new Map(vertices.map((v, i) => [v, i]));
  const index = [];
  for (let t = 0; t < part.index.length; t += 3) {
    const corners = [part.index[t], part.index[t + 1], part.index[t + 2]];
    if (corners.every((v) => number.has(v))) index.push(...corners.map((v) => number.get(v)));
  }
  const gather = (list, width) => Float64Array.from({ length: width * vertices.length }, (_, i) => list[width * vertices[Math.floor(i / width)] + (i % width)]);
  const first = new Map();
  const smooth = vertices.map((v, i) => {
    const place = part.smooth[v];
    if (!first.has(place)) first.set(place, i);
    return first.get(place);
  });
  const chosen = (list) => [...list.keys()].filter((i) => number.has(list[i]));
  const moves = part.moves.flatMap((move) => {
    const kept = chosen(move.vertices);
    return kept.length ? [{ ...move, vertices: kept.map((i) => number.get(move.vertices[i])), deltas: kept.flatMap((i) => [0, 1, 2].map((k) => move.deltas[3 * i + k])) }] : [];
  });
  const turns = part.turns.flatMap((turn) => {
    if (!turn.vertices) return [turn];
    const kept = chosen(turn.vertices);
    return kept.length ? [{ ...turn, vertices: kept.map((i) => number.get(turn.vertices[i])), weights: kept.map((i) => turn.weights[i]) }] : [];
  });
  return { ...part, name, material: name, position: gather(part.position, 3), uv: gather(part.uv, 2), index, smooth, moves, turns };
}

/**
 * @param {object} part with its moves and turns; its pieces as gathered (parts.mjs) @param {object} scene @param {number} main a vertex that the first part must contain; -1: any
 * @param {number} look its material @returns {{part: object, look: number}[]}
 */
export function divide(part, scene, main, look) {
  const groups = byPicture({ pieces: part.pieces, material: look }, scene, main);
  if (!groups) return [{ part, look }];
  return groups.map((group, i) => ({ part: cutOut(part, i ? `${part.name}_${i + 1}` : part.name, group.vertices), look: group.look }));
}
