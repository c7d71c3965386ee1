// SPDX-License-Identifier: MIT
// Calibration: fits a head to the feature points of a person (ISO/IEC 14496-2, annex C: FDP) and keeps its FAPs working.
// Space is warped so that the head's own points get there. What an action does is warped along with it, so that what met
// before meets afterwards; then it is scaled so that its feature point follows the FAP exactly, in the units of the new face.
import { faps } from '../../../../protocol/fap.mjs';
import { checkCalibration, ModelError } from './check.mjs';
import { turned } from '../mesh/influences.mjs';
import { BREATH } from './model.mjs';
import { rbf, WarpError } from './rbf.mjs';

const HOLDS_FROM = 60; // mm from all points that are given: there a point of the head stays
const ROUND_ABOUT = 0.2; // of the skin's box: distance outside it at which the warp ends
const WHOLE = { points: 8, share: 0.6 }; // least number of points, and share of the face that they span, to scale the head
const JAW = 3; // its FAP: it turns, and glides
const LID_FAPS = [19, 20, 21, 22];
const EYES = [
  { part: 'eye_l', pupil: '3.5', faps: [23, 25] },
  { part: 'eye_r', pupil: '3.6', faps: [24, 26] },
];
const EYE_SCALE = [0.75, 1.3];
const TEETH_SCALE = [0.8, 1.25];
const SHELL = [1.12, 1.45]; // radii of the eyeball: lids keep their distance from it; beyond, nothing does
const IN_MOUTH = ['teeth_upper', 'teeth_lower', 'tongue'];
const INSIDE = /^(6|9\.([89]|10|11))\b/; // feature points of tongue and teeth go with the mouth
/** Points of the inner lips that touch on a neutral face: they are one. */
const TOUCHING = [['2.2', '2.3'], ['2.6', '2.8'], ['2.7', '2.9']];
const TRIAL = 4; // mm, or the largest delta: displacement by which an action is sampled
const TRIAL_FAP = 300; // of a FAP that turns: a usual value
const RESCALED = [0.3, 3.3]; // bounds of an action's rescaling: beyond them it would be another action
const DIRECTIONS = { up: [0, 1, 0], down: [0, -1, 0], left: [1, 0, 0], right: [-1, 0, 0], forward: [0, 0, 1] };

const minus = (a, b) => a.map((value, k) => value - b[k]);
const plus = (a, b) => a.map((value, k) => value + b[k]);
const times = (a, factor) => a.map((value) => value * factor);
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const mean = (points) => times(points.reduce(plus), 1 / points.length);
const clamp = (value, [least, most]) => Math.min(most, Math.max(least, value));
const place = (list, v) => [list[3 * v], list[3 * v + 1], list[3 * v + 2]];

/** ISO/IEC 14496-2, FAPU, in mm and not divided by 1024. @param {Record<string, number[]>} fdp */
export function measureUnits(fdp) {
  const eyes = (fdp['3.5'][1] + fdp['3.6'][1]) / 2;
  return {
    IRISD: (fdp['3.1'][1] - fdp['3.3'][1] + fdp['3.2'][1] - fdp['3.4'][1]) / 2,
    ES: fdp['3.5'][0] - fdp['3.6'][0],
    ENS: eyes - fdp['9.15'][1],
    MNS: fdp['9.15'][1] - fdp['2.2'][1],
    MW: fdp['8.3'][0] - fdp['8.4'][0],
  };
}

/** Returns the targets of the points given; touching points move together. */
function targetsOf(fdp, given) {
  const to = Object.fromEntries(Object.entries(given).filter(([name]) => fdp[name]));
  for (const pair of TOUCHING) {
    const there = pair.filter((name) => to[name]);
    if (!there.length || !pair.every((name) => fdp[name])) continue;
    const shift = mean(there.map((name) => minus(to[name], fdp[name])));
    for (const name of pair) to[name] = plus(fdp[name], shift);
  }
  return to;
}

/** Fits one scale and a shift of the whole head, if the points suffice. @returns {{scale: number, map: Function}} */
function whole(fdp, to) {
  const names = Object.keys(to);
  const span = (list, k) => Math.max(...list.map((p) => p[k])) - Math.min(...list.map((p) => p[k]));
  const from = names.map((name) => fdp[name]);
  const wide = names.length >= WHOLE.points && [0, 1].every((k) => span(from, k) >= WHOLE.share * span(Object.values(fdp), k));
  if (!wide) return { scale: 1, map: (p) => p };
  const [a, b] = [mean(from), mean(names.map((name) => to[name]))];
  let [up, down] = [0, 0];
  for (const name of names) {
    up += dot(minus(fdp[name], a), minus(to[name], b));
    down += dot(minus(fdp[name], a), minus(fdp[name], a));
  }
  const scale = up / down;
  return { scale, map: (p) => plus(b, times(minus(p, a), scale)) };
}

function cornersOf(parts) {
  const low = [Infinity, Infinity, Infinity];
  const high = low.map((value) => -value);
  for (const { position } of parts)
    for (let i = 0; i < position.length; i++) {
      low[i % 3] = Math.min(low[i % 3], position[i]);
      high[i % 3] = Math.max(high[i % 3], position[i]);
    }
  const reach = Math.max(...minus(high, low)) * ROUND_ABOUT;
  return Array.from({ length: 8 }, (_, i) => low.map((value, k) => ((i >> k) & 1 ? high[k] + reach : value - reach)));
}

/** The warp of space, without regard to eyes and teeth. */
function warpOf(model, to, all, prefix) {
  const { fdp, parts } = model;
  const pairs = [];
  const given = Object.keys(to).filter((name) => !INSIDE.test(name));
  for (const name of given) pairs.push([fdp[name], to[name], name]);
  for (const name of Object.keys(fdp))
    if (!to[name] && !INSIDE.test(name) && given.every((other) => Math.hypot(...minus(fdp[name], fdp[other])) > HOLDS_FROM))
      pairs.push([fdp[name], all.map(fdp[name]), name]);
  for (const corner of cornersOf(parts)) pairs.push([corner, all.map(corner), null]);
  try {
    return rbf(pairs.flatMap(([from]) => from), pairs.flatMap(([, target]) => target), { kernel: 'biharmonic' });
  } catch (error) {
    if (!(error instanceof WarpError)) throw error;
    const name = pairs[error.point]?.[2];
    throw new ModelError(prefix + (name ? `featurePointsCoord.${name}` : 'featurePointsCoord'), error.message);
  }
}

/** The eyeballs: each a ball that moves and grows, but is not bent. */
function eyesOf(model, to, warp) {
  return EYES.flatMap(({ part: name, pupil, faps: own }) => {
    const part = model.parts.find((one) => one.name === name);
    if (!part) return [];
    const turn = model.turns.find(({ fap }) => own.includes(fap));
    const points = Array.from({ length: part.vertices }, (_, v) => place(part.position, v));
    const from = turn?.pivot ?? mean(points);
    const radii = points.map((p) => Math.hypot(...minus(p, from))).sort((a, b) => a - b);
    const radius = radii[radii.length >> 1];
    const across = (k) => {
      const step = [0, 1, 2].map((i) => (i === k ? radius : 0));
      return Math.hypot(...minus(warp.at(plus(from, step)), warp.at(minus(from, step)))) / (2 * radius);
    };
    const scale = clamp((across(0) + across(1)) / 2, EYE_SCALE);
    const front = model.fdp[pupil];
    const at = to[pupil] ? minus(to[pupil], times(minus(front, from), scale)) : warp.at(from);
    return [{ name, from, to: at, radius, scale }];
  });
}

/** Near an eyeball the distance from it is kept: lids neither dive into it nor leave it. */
function withShells(warp, eyes) {
  const shares = ({ from, radius }, p) => {
    const far = Math.hypot(...minus(p, from)) / radius;
    return 0.5 + 0.5 * Math.cos(Math.PI * clamp((far - SHELL[0]) / (SHELL[1] - SHELL[0]), [0, 1]));
  };
  return (p) => {
    let q = warp.at(p);
    for (const eye of eyes) {
      const share = shares(eye, p);
      if (!share) continue;
      const out = minus(q, eye.to);
      const length = Math.hypot(...out) || 1;
      const want = length + share * (eye.scale * Math.hypot(...minus(p, eye.from)) - length);
      q = plus(eye.to, times(out, want / length));
    }
    return q;
  };
}

/** Makes the maps of positions: one for the skin and what is attached to it, one for each rigid part. */
function mapsOf(model, calibration, prefix) {
  const to = targetsOf(model.fdp, calibration.featurePointsCoord);
  const all = whole(model.fdp, to);
  const warp = warpOf(model, to, all, prefix);
  const eyes = eyesOf(model, to, warp);
  const soft = withShells(warp, eyes);
  const ball = ({ from, to: at, scale }) => ({ scale, map: (p) => plus(at, times(minus(p, from), scale)) });
  const rigid = new Map(eyes.map((eye) => [eye.name, ball(eye)]));
  const fdp = Object.fromEntries(Object.entries(model.fdp).map(([name, p]) => [name, soft(p)]));
  const wider = (fdp['8.3'][0] - fdp['8.4'][0]) / model.fapu.MW;
  const scale = clamp(wider, TEETH_SCALE);
  const [lips, lipsNow] = [model.fdp, fdp].map((points) => mean([points['2.2'], points['2.3']]));
  const mouth = { scale, map: (p) => plus(lipsNow, times(minus(p, lips), scale)) };
  for (const name of IN_MOUTH) rigid.set(name, mouth);
  for (const name of Object.keys(fdp)) if (INSIDE.test(name)) fdp[name] = mouth.map(model.fdp[name]);
  EYES.forEach(({ part, pupil }) => {
    if (rigid.has(part) && fdp[pupil]) fdp[pupil] = rigid.get(part).map(model.fdp[pupil]);
  });
  return { soft, rigid, fdp, size: all.scale };
}

const UNIT_POINTS = { IRISD: ['3.1', '3.3'], ES: ['3.5', '3.6'], ENS: ['3.5', '9.15'], MNS: ['9.15', '2.2'], MW: ['8.3', '8.4'] };

function unitsOf(fdp, before, prefix) {
  const fapu = measureUnits(fdp);
  for (const [name, value] of Object.entries(fapu))
    if (!(value > before[name] / 4 && value < before[name] * 4))
      throw new ModelError(
        `${prefix}featurePointsCoord`,
        `${name} (${UNIT_POINTS[name].join(' to ')}) would be ${value.toFixed(1)} mm; here it is ${before[name].toFixed(1)} mm`,
      );
  return fapu;
}

/** Moves the pivots of turns; turns measured in a length keep the path of their feature point. */
function newTurns(model, { soft, rigid, fdp }, fapu) {
  return model.turns.map((turn) => {
    const eye = EYES.find(({ faps: own }) => own.includes(turn.fap));
    const lid = LID_FAPS.includes(turn.fap);
    const ball = eye ?? (lid && EYES[(turn.fap - 19) % 2]);
    const pivot = ball && rigid.has(ball.part) ? rigid.get(ball.part).map(turn.pivot) : soft(turn.pivot);
    const { unit } = faps[turn.fap];
    const point = faps[turn.fap].fdp.split('/')[0];
    if (unit === 'AU' || lid || !fdp[point] || !DIRECTIONS[faps[turn.fap].direction]) return { ...turn, pivot };
    const direction = DIRECTIONS[faps[turn.fap].direction];
    const way = (p, one) => dot(minus(turned(p, one, TRIAL_FAP * one.radians), p), direction);
    const want = (way(model.fdp[point], turn) * fapu[unit]) / model.fapu[unit];
    const now = { ...turn, pivot };
    for (let i = 0; i < 8; i++) now.radians *= clamp(want / way(fdp[point], now), RESCALED) || 1;
    return now;
  });
}

/** A lid's vertex turns by as much as takes it where its closed place gets to. */
function lidWeights(part, share, turn, turnNow, position, soft) {
  const full = 1024 * turn.radians;
  const flat = (p) => minus(p, times(turnNow.axis, dot(p, turnNow.axis)));
  return Float32Array.from(share.vertices, (v, i) => {
    const closed = soft(turned(place(part.position, v), turn, full * share.weights[i]));
    const [a, b] = [place(position, v), closed].map((p) => flat(minus(p, turnNow.pivot)));
    return Math.atan2(dot(turnNow.axis, cross(a, b)), dot(a, b)) / full;
  });
}

function movePart(part, model, turns, { soft, rigid }) {
  const stiff = rigid.get(part.name);
  const map = stiff?.map ?? soft;
  const position = new Float32Array(part.position.length);
  for (let v = 0; v < part.vertices; v++) position.set(map(place(part.position, v)), 3 * v);
  const moves = part.moves.map((move) => {
    if (stiff || move.fap === JAW) return move; // mm by mm, as before: the condyle glides straight forward
    const largest = move.deltas.reduce((most, value) => Math.max(most, Math.abs(value)), 1e-6);
    const amount = ((move.sign === 'negative' ? -1 : 1) * TRIAL) / largest;
    const deltas = new Float32Array(move.deltas.length);
    move.vertices.forEach((v, i) => {
      const moved = map(plus(place(part.position, v), times(place(move.deltas, i), amount)));
      deltas.set(times(minus(moved, place(position, v)), 1 / amount), 3 * i);
    });
    return { ...move, deltas };
  });
  const shares = part.turns.map((share) =>
    share.weights && LID_FAPS.includes(model.turns[share.turn].fap)
      ? { ...share, weights: lidWeights(part, share, model.turns[share.turn], turns[share.turn], position, soft) }
      : share,
  );
  return { ...part, position, moves, turns: shares };
}

/** Returns how far a FAP moves its feature point along its direction, per mm; null: the point is no vertex of the skin. */
function following(skin, fdp, fap, sign) {
  const direction = DIRECTIONS[faps[fap].direction];
  const point = fdp[faps[fap].fdp.split('/')[0]];
  if (!direction || !point || faps[fap].unit === 'AU') return null;
  let [best, least] = [-1, 0.25];
  for (let v = 0; v < skin.vertices; v++) {
    const far = Math.hypot(...minus(place(skin.position, v), point));
    if (far < least) [best, least] = [v, far];
  }
  if (best < 0) return null;
  let sum = 0;
  for (const move of skin.moves) {
    if (move.fap !== fap || move.from || !(move.sign === 'both' || move.sign === sign)) continue;
    const i = move.vertices.indexOf(best);
    if (i >= 0) sum += dot(place(move.deltas, i), direction);
  }
  return sum || null;
}

/** A lid that has farther to go than before turns farther: its shares stay within 0 and 1. */
function settleLids(parts, turns) {
  const most = turns.map(() => 1);
  const lids = ({ turn, weights }) => weights && LID_FAPS.includes(turns[turn].fap);
  for (const share of parts.flatMap((part) => part.turns).filter(lids))
    most[share.turn] = share.weights.reduce((a, b) => Math.max(a, b), most[share.turn]);
  const settled = parts.map((part) => ({
    ...part,
    turns: part.turns.map((share) =>
      lids(share) ? { ...share, weights: share.weights.map((weight) => Math.max(0, weight / most[share.turn])) } : share,
    ),
  }));
  return { parts: settled, turns: turns.map((turn, i) => ({ ...turn, radians: turn.radians * most[i] })) };
}

/** So that feature points follow their FAPs as exactly as before. */
function rescale(parts, before, fdpBefore, fdp) {
  const named = (list) => list.find(({ name }) => name === 'skin');
  const [skin, skinBefore] = [named(parts), named(before)];
  if (!skin) return parts;
  const factors = new Map();
  const factorOf = (fap, sign) => {
    const key = `${fap} ${sign}`;
    if (!factors.has(key)) {
      const signs = sign === 'both' ? ['positive', 'negative'] : [sign];
      const ratios = signs.flatMap((one) => {
        const was = following(skinBefore, fdpBefore, fap, one);
        const is = was && following(skin, fdp, fap, one);
        return is && was / is > 0 ? [clamp(was / is, RESCALED)] : [];
      });
      factors.set(key, ratios.length ? ratios.reduce((a, b) => a + b) / ratios.length : 1);
    }
    return factors.get(key);
  };
  return parts.map((part, i) => ({
    ...part,
    moves: part.moves.map((move, k) => {
      const kept = move.fap === BREATH || move === before[i].moves[k];
      return kept ? move : { ...move, deltas: move.deltas.map((value) => value * factorOf(move.fap, move.sign)) };
    }),
  }));
}

/** The skin's places on the picture that was given, from those of the feature points. */
function texturePlaces(skin, fdp, textureCoord, prefix) {
  const names = Object.keys(textureCoord).filter((name) => fdp[name]);
  const SIZE = 100; // so that both sides are of one order
  let warp;
  try {
    warp = rbf(names.flatMap((name) => fdp[name]), names.flatMap((name) => [...times(textureCoord[name], SIZE), 0]));
  } catch (error) {
    if (!(error instanceof WarpError)) throw error;
    const name = names[error.point];
    throw new ModelError(prefix + (name ? `textureCoord.${name}` : 'textureCoord'), error.message);
  }
  const uv = new Float32Array(2 * skin.vertices);
  for (let v = 0; v < skin.vertices; v++) {
    const [s, t] = warp.at(place(skin.position, v));
    uv.set([clamp(s / SIZE, [0, 1]), clamp(t / SIZE, [0, 1])], 2 * v);
  }
  return uv;
}

/**
 * @param {ReturnType<import('./model.mjs').readModel>} model with the points that its units need
 * @param {{featurePointsCoord: Record<string, number[]>, textureCoord?: Record<string, number[]>,
 *   texture?: {type: string, data: string}}} calibration protocol/head-model.md
 * @param {string} [prefix] of the places in errors
 * @returns {ReturnType<import('./model.mjs').readModel>} a new model; the given one is unchanged
 * @throws {ModelError} with the place of what is wrong
 */
export function calibrate(model, calibration, prefix = '') {
  checkCalibration(calibration, prefix);
  for (const name of new Set(Object.values(UNIT_POINTS).flat().concat('3.2', '3.4', '2.3')))
    if (!model.fdp[name]) throw new ModelError(`fdp.${name}`, 'is missing: a head without it cannot be calibrated');
  const maps = mapsOf(model, calibration, prefix);
  const fapu = unitsOf(maps.fdp, model.fapu, prefix);
  const placed = newTurns(model, maps, fapu);
  const { parts: moved, turns } = settleLids(model.parts.map((part) => movePart(part, model, placed, maps)), placed);
  const parts = rescale(moved, model.parts, model.fdp, maps.fdp);
  const { view } = model;
  const out = {
    ...model, fapu, fdp: maps.fdp, turns, parts,
    view: {
      ...view, target: maps.soft(view.target), distance: view.distance * maps.size,
      ...(view.bottom === undefined ? {} : { bottom: view.bottom * maps.size }),
    },
  };
  const { textureCoord, texture } = calibration;
  const skin = parts.findIndex(({ name }) => name === 'skin');
  if (!texture || skin < 0) return out;
  const name = model.materials[parts[skin].material]?.texture ?? 'skin';
  out.textures = { ...model.textures, [name]: texture };
  if (textureCoord) parts[skin] = { ...parts[skin], uv: texturePlaces(parts[skin], maps.fdp, textureCoord, prefix) };
  return out;
}
