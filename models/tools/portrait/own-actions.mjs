// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * A person's own actions: what a face does in poses beyond its head (pose-moves.mjs) becomes part of the moves of the FAPs that the poses are.
 * For each vertex the least squares over all poses, each FAP near its feature point; the point itself, lips and lids stay where FAPs say.
 */
import { encode, encodeDeltas } from '../lib/codec.mjs';
import { pose as posed, unitLength, unpack } from '../lib/deform.mjs';
import { FAPS } from '../lib/faps.mjs';
import { BOUND, FREE } from './pose-moves.mjs';

const WIDE = 8; // mm: of the radial function that spreads what a landmark does
const ALONE = 0.6; // of that function's weight: where no landmark is near, nothing is done
const REACH = 45; // mm: a FAP's
const DAMPING = 2; // mm^2: of the least squares
const POINT = 14; // mm round a feature point
const [CLEAR, FULL] = [2.5, 9]; // mm from lips and lids: up to where nothing is changed, and from where all
const LEAST = 0.02; // mm per mm of a FAP
const PARTS = /^(skin|brows|beard)/;

const step = (t) => (t <= 0 ? 0 : t >= 1 ? 1 : t * t * (3 - 2 * t));
const gauss = (far, wide) => Math.exp(-0.5 * (far / wide) ** 2);
const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** x = b of a symmetric positive matrix, two columns of b. */
function solve(a, b) {
  const n = a.length;
  for (let c = 0; c < n; c++)
    for (let r = c + 1; r < n; r++) {
      const factor = a[r][c] / a[c][c];
      if (!factor) continue;
      for (let k = c; k < n; k++) a[r][k] -= factor * a[c][k];
      for (let k = 0; k < 2; k++) b[r][k] -= factor * b[c][k];
    }
  for (let r = n - 1; r >= 0; r--)
    for (let k = 0; k < 2; k++) {
      for (let c = r + 1; c < n; c++) b[r][k] -= a[r][c] * b[c][k];
      b[r][k] /= a[r][r];
    }
  return b;
}

/** The FAPs of the poses, each in one sense: {fap, sign, mm by pose}. */
function actionsOf(head, poses, table) {
  const actions = new Map();
  [...poses].forEach(([name, { amount }], i) => {
    for (const [fap, value] of Object.entries(table[name].faps)) {
      if (!FAPS[fap].direction || !head.fdp[FAPS[fap].point]) continue;
      const sign = value > 0 ? 'positive' : 'negative';
      const key = `${fap} ${sign}`;
      const action = actions.get(key) ?? actions.set(key, { fap: Number(fap), sign, mm: new Float64Array(poses.size), at: head.fdp[FAPS[fap].point] }).get(key);
      action.mm[i] = value * amount * unitLength(head, fap);
    }
  });
  return [...actions.values()];
}

/** What each pose wants of a place: [x, y] mm; null where it wants nothing. */
function wantedAt(p, places, rests) {
  const near = [];
  let sum = ALONE;
  for (const i of FREE) {
    const d = places[i] ? far(p, places[i]) : Infinity;
    if (d > 3 * WIDE) continue;
    const weight = gauss(d, WIDE);
    near.push([i, weight]);
    sum += weight;
  }
  if (!near.length) return null;
  return rests.map((rest) => [0, 1].map((k) => near.reduce((total, [i, weight]) => total + (weight / sum) * rest[i][k], 0)));
}

/** The deltas of all actions at one place, per mm of each FAP. */
function deltasAt(p, wanted, actions, share) {
  const weights = actions.map(({ at }) => gauss(far(p, at), REACH / 2));
  const matrix = wanted.map((_, r) => wanted.map((__, c) => (r === c ? DAMPING : 0) + actions.reduce((sum, { mm }, f) => sum + mm[r] * mm[c] * weights[f] ** 2, 0)));
  const dual = solve(matrix, wanted.map((q) => q.map((x) => x * share)));
  return actions.map(({ mm }, f) => [0, 1].map((k) => weights[f] ** 2 * dual.reduce((sum, q, r) => sum + mm[r] * q[k], 0)));
}

/**
 * @param {object} json the head (protocol/head-model.md) @param {(number[]|null)[]} places of each landmark on it, mm
 * @param {Map<string, {amount: number, rest: number[][]}>} poses of restsOf @param {object} table poses.json's poses
 * @returns {object} the head with the person's own actions
 */
export function withOwnActions(json, places, poses, table) {
  const head = unpack(json);
  const actions = actionsOf(head, poses, table);
  const rests = [...poses.values()].map(({ rest }) => rest);
  const lipsAndLids = [...BOUND.map((i) => places[i]).filter(Boolean), ...Object.entries(head.fdp).filter(([name]) => /^([238]\.[1-9])$/.test(name) && name !== '2.1').map(([, p]) => p)];
  const shareAt = (p) => step((Math.min(...lipsAndLids.map((q) => far(p, q))) - CLEAR) / (FULL - CLEAR));
  const at = (p) => {
    const wanted = wantedAt(p, places, rests);
    const share = wanted && shareAt(p);
    return share ? { share, deltas: deltasAt(p, wanted, actions, share) } : null;
  };
  const atPoints = actions.map(({ at: p, fap }, f) => {
    const found = at(p);
    return found ? found.deltas[f].reduce((sum, x, k) => sum + x * FAPS[fap].direction[k], 0) / found.share : 0;
  });
  const parts = json.parts.map((part, n) => (PARTS.test(part.name) ? withDeltas(part, head.parts[n], actions, at, atPoints) : part));
  return { ...json, parts };
}

function withDeltas(part, open, actions, at, atPoints) {
  const found = actions.map(() => new Map());
  for (let v = 0; v < open.position.length / 3; v++) {
    const p = [...open.position.slice(3 * v, 3 * v + 3)];
    const here = at(p);
    here?.deltas.forEach(([x, y], f) => {
      const { direction } = FAPS[actions[f].fap];
      const back = here.share * gauss(far(p, actions[f].at), POINT) * atPoints[f]; // the feature point follows its FAP, no less, no more
      const delta = [x - back * direction[0], y - back * direction[1], -back * direction[2]];
      if (Math.hypot(...delta) > LEAST) found[f].set(v, delta);
    });
  }
  const moves = part.moves.map((move, i) => [move, open.moves[i]]); // no two of ours are of one FAP and sense
  actions.forEach(({ fap, sign }, f) => {
    if (!found[f].size) return;
    const i = moves.findIndex(([move]) => move.fap === fap && move.sign === sign);
    const old = i < 0 ? { vertices: [], deltas: [] } : moves[i][1];
    old.vertices.forEach((v, n) => {
      const more = found[f].get(v) ?? [0, 0, 0];
      found[f].set(v, more.map((x, k) => x + old.deltas[3 * n + k]));
    });
    const vertices = [...found[f].keys()].sort((a, b) => a - b);
    const move = { fap, sign, vertices: encode('uint16', vertices), deltas: encodeDeltas(vertices.flatMap((v) => found[f].get(v))) };
    if (i < 0) moves.push([move, null]);
    else moves[i] = [move, null];
  });
  return { ...part, moves: moves.map(([move]) => move) };
}

/** Where landmarks go in a pose of the head, mm: for measuring. @param {number[]} vertices of the skin, by landmark */
export function headMoves(head, vertices, faps) {
  const skin = head.parts.find(({ name }) => name === 'skin');
  const now = posed(head, skin, faps);
  return vertices.map((v) => (v === null ? null : [0, 1, 2].map((k) => now[3 * v + k] - skin.position[3 * v + k])));
}
