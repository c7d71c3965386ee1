// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * MPEG-4's FDP node (ISO/IEC 14496-1): feature points in the order of their numbers, and the animation table (FAT), which says for each FAP where
 * vertices go, piece by piece, and which Transforms turn. See protocol/mpeg4.md.
 */
import { FAPS } from '../../lib/faps.mjs';
import { FileError } from '../limits.mjs';
import { apply, linear } from './matrix.mjs';

const COUNTS = { 2: 14, 3: 14, 4: 6, 5: 4, 6: 4, 7: 1, 8: 10, 9: 15, 10: 10, 11: 6 };
/** All feature points, as the node lists them. */
export const POINTS = Object.entries(COUNTS).flatMap(([group, count]) => Array.from({ length: count }, (_, i) => `${group}.${i + 1}`));
export const ABSENT = 1e30; // coordinates beyond stand for a point that the face does not have
const AU = 1e-5; // rad
const ROTATION = 1;
const TRANSLATION = 3;

const listOf = (value) => (Array.isArray(value) ? value : value ? [value] : []);
const nodeOf = (value) => (Array.isArray(value) ? value[0] : value);
const numberOf = (value) => (Array.isArray(value) ? value[0] : value);

/** The first FDP under the nodes. */
function findFdp(roots, budget) {
  const [seen, todo] = [new Set(), [...roots].reverse()];
  while (todo.length) {
    const node = todo.pop();
    if (!node?.type || seen.has(node)) continue;
    if (node.type === 'FDP') return node;
    seen.add(node);
    budget.work(10, () => `line ${node.line}`);
    for (const value of Object.values(node.fields)) for (const one of listOf(value)) if (one?.type) todo.push(one);
  }
  return null;
}

/** @returns {Record<string, number[]>} by number */
function pointsOf(coordinates, width) {
  const list = nodeOf(coordinates)?.fields?.point ?? [];
  const { line } = nodeOf(coordinates) ?? {};
  if (!list.length) return {};
  if (list.length !== width * POINTS.length) throw new FileError(`line ${line}`, `an FDP has ${POINTS.length} feature points, of ${width} numbers each`);
  return Object.fromEntries(POINTS.flatMap((name, i) => {
    const p = list.slice(width * i, width * i + width);
    return p.every((x) => Math.abs(x) < ABSENT) ? [[name, p]] : [];
  }));
}

/** A FaceDefMesh, checked. */
function tableOf(fap, node, fail) {
  const [borders, vertices, displacements] = ['intervalBorders', 'coordIndex', 'displacements'].map((name) => listOf(node.fields[name]));
  const at = `FaceDefMesh of FAP ${fap}`;
  if (borders.length < 2 || borders.some((x, i) => !Number.isFinite(x) || (i && x <= borders[i - 1]))) fail(node, `${at}: intervalBorders must increase`);
  if (!borders.includes(0)) fail(node, `${at}: one of intervalBorders must be 0`);
  if (displacements.length !== 3 * vertices.length * (borders.length - 1)) fail(node, `${at}: displacements must have a vector for each interval of each vertex`);
  return { fap, borders, vertices, displacements, line: node.line };
}

/** The vectors of one interval, three numbers for each vertex. */
const vectorsOf = ({ borders, vertices, displacements }, j) => {
  const pieces = borders.length - 1;
  return Float64Array.from({ length: 3 * vertices.length }, (_, i) => displacements[3 * (Math.floor(i / 3) * pieces + j) + (i % 3)]);
};

/**
 * By the printed rule, the vectors of intervals below 0 say whither a vertex goes as the FAP falls; some tables hold slopes throughout. A FAP moves
 * a vertex roughly to and fro, so the intervals beside 0 tell.
 */
function areSlopes(tables) {
  let sum = 0;
  for (const table of tables) {
    const zero = table.borders.indexOf(0);
    if (!zero || zero === table.borders.length - 1) continue;
    const [below, above] = [vectorsOf(table, zero - 1), vectorsOf(table, zero)];
    const [dot, a, b] = below.reduce(([d, x, y], value, i) => [d + value * above[i], x + value * value, y + above[i] * above[i]], [0, 0, 0]);
    sum += dot / (Math.sqrt(a * b) || 1);
  }
  return sum > 0;
}

/** A table as moves of a head: what changes in slope from a value of the FAP on. @returns {{sign: string, from: number, vectors: Float64Array}[]} */
function movesOf(table, slopes) {
  const { borders } = table;
  if (borders.length === 2) return [{ sign: 'both', from: 0, vectors: vectorsOf(table, 0) }];
  const zero = borders.indexOf(0);
  const out = [];
  const add = (sign, from, j, before, turned) => {
    const own = vectorsOf(table, j).map((x) => (turned ? -x : x));
    out.push({ sign, from, vectors: before ? own.map((x, i) => x - before[i]) : own });
    return own;
  };
  for (let j = zero, before = null; j < borders.length - 1; j++) before = add('positive', borders[j], j, before, false);
  for (let j = zero - 1, before = null; j >= 0; j--) before = add('negative', -borders[j + 1], j, before, !slopes);
  return out;
}

/**
 * @param {import('./vrml-text.mjs').Node[]} roots @param {Map<string, object>} defined @param {import('../limits.mjs').Budget} budget
 * @returns {null|{node: object, act: Function, found: Function}} act: gives a mesh the moves of its set; found: what a scene gets
 */
export function readFdp(roots, defined, budget) {
  const node = findFdp(roots, budget);
  if (!node) return null;
  const fail = ({ line }, what) => {
    throw new FileError(`line ${line}`, what);
  };
  const [bySet, byTransform, notes, moves, turns] = [new Map(), new Map(), [], new Map(), []];
  const add = (map, key, value) => (map.get(key) ?? map.set(key, []).get(key)).push(value);
  const graphNode = (one, type) => {
    const named = nodeOf(one.fields.faceSceneGraphNode);
    const own = named?.use ? defined.get(named.use) : named;
    if (own?.type !== type) fail(named?.line ? named : one, `faceSceneGraphNode must be ${type === 'Transform' ? 'a' : 'an'} ${type} of the face`);
    return own;
  };
  const high = new Set();
  let count = 0; // of turned Transforms
  for (const one of listOf(node.fields.faceDefTables)) {
    if (one?.type !== 'FaceDefTables') fail(one ?? node, 'faceDefTables must have FaceDefTables');
    const fap = numberOf(one.fields.fapID);
    if (fap === 1 || fap === 2) {
      high.add(fap);
      continue;
    }
    if (!FAPS[fap]) fail(one, 'fapID must be a FAP, 1 to 68');
    for (const mesh of listOf(one.fields.faceDefMesh)) add(bySet, graphNode(mesh, 'IndexedFaceSet'), tableOf(fap, mesh, fail));
    for (const turn of listOf(one.fields.faceDefTransform)) add(byTransform, graphNode(turn, 'Transform'), { fap, number: ++count, ...turn });
  }
  if (high.size) notes.push('visemes and expressions of the animation table (FAP 1, 2) are not taken: those of speech take their place');
  const slopes = areSlopes([...bySet.values()].flat());

  /** Displacements of some vertices of a set, for a mesh made of it. */
  const spread = (mesh, vertices, vectors, at) => {
    const points = new Map(vertices.map((v, i) => [v, i]));
    budget.keep(3 * mesh.from.length, at);
    const out = new Float64Array(3 * mesh.from.length);
    mesh.from.forEach((v, own) => {
      const i = points.get(v);
      if (i !== undefined) out.set(vectors.subarray(3 * i, 3 * i + 3), 3 * own);
    });
    return out;
  };
  const target = (mesh, move, deltas) => {
    const name = `@${move.fap} ${move.sign} ${move.from} ${move.per}`;
    moves.set(name, move);
    const before = mesh.targets[name];
    mesh.targets[name] = before ? before.map((x, i) => x + deltas[i]) : deltas;
  };

  const act = (mesh, set, matrix, above) => {
    for (const table of bySet.get(set) ?? []) {
      const points = (nodeOf(set.fields.coord)?.fields.point ?? []).length / 3;
      if (table.vertices.some((v) => !Number.isInteger(v) || v < 0 || v >= points)) fail(table, `coordIndex must be of the ${points} points of the set`);
      for (const { sign, from, vectors } of movesOf(table, slopes))
        target(mesh, { fap: table.fap, sign, from, per: FAPS[table.fap].unit === 'AU' ? 'radian' : 'length' }, spread(mesh, table.vertices, linear(matrix, vectors), `line ${table.line}`));
    }
    for (const { node: transform, matrix: inner, parent } of above)
      for (const one of byTransform.get(transform) ?? []) {
        const kind = numberOf(one.fields.fieldId);
        if (kind === ROTATION) {
          const [x, y, z, angle] = one.fields.rotationDef ?? [0, 0, 1, 1];
          const pivot = [...apply(inner, transform.fields.center ?? [0, 0, 0])];
          const key = `${one.fap} ${one.number}`;
          if (!turns.some((turn) => turn.key === key)) turns.push({ key, fap: one.fap, pivot, end: [...linear(parent, [x, y, z])].map((d, k) => pivot[k] + d), radians: angle * AU });
          (mesh.turns ??= []).push(key);
        } else if (kind === TRANSLATION) {
          const d = linear(parent, one.fields.translationDef ?? [0, 0, 0]);
          budget.keep(mesh.position.length, () => `line ${one.line}`);
          target(mesh, { fap: one.fap, sign: 'both', from: 0, per: 'unit' }, Float64Array.from(mesh.position, (_, i) => d[i % 3]));
        } else notes.push(`line ${one.line}: a change of scale by FAP ${one.fap} is left out`);
      }
  };

  /** @param {number[]} matrix of the FDP */
  const found = (matrix) => {
    const points = pointsOf(node.fields.featurePointsCoord, 3);
    const fdp = Object.fromEntries(Object.entries(points).map(([name, p]) => [name, [...apply(matrix, p)]]));
    return {
      ...(Object.keys(fdp).length ? { points: { frame: 'file', fdp, parts: {}, influences: [] } } : {}),
      animation: moves.size || turns.length ? { moves, turns, notes } : null,
    };
  };
  return { node, act, found };
}

/** Feature points, their places on the texture, and the texture's file, of a scene as text. @returns {{featurePointsCoord: object, textureCoord: object, url: string|null, line: number}} */
export function calibrationOf({ roots }, budget) {
  const node = findFdp(roots, budget);
  if (!node) throw new FileError('', 'there is no FDP in it');
  const featurePointsCoord = pointsOf(node.fields.featurePointsCoord, 3);
  if (!Object.keys(featurePointsCoord).length) throw new FileError(`line ${node.line}`, 'the FDP has no feature points');
  const picture = listOf(node.fields.faceSceneGraph).flatMap((one) => [one, ...listOf(one?.fields?.children)]).map((one) => nodeOf(nodeOf(one?.fields?.appearance)?.fields?.texture)).find((one) => one?.type === 'ImageTexture');
  return { featurePointsCoord, textureCoord: pointsOf(node.fields.textureCoord, 2), url: listOf(picture?.fields.url)[0] ?? null, line: picture?.line ?? node.line };
}
