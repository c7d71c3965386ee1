// SPDX-License-Identifier: GPL-3.0-or-later
/** Rotations: jaw, lids around the eyeballs, eyes, the head on its neck. */
import { at } from './fields.mjs';
import { ballOf } from '../mesh/parts.mjs';

const LID_SKIN = 1.75; // radii of the eyeball: maximum distance of a lid
const LID_INSIDE = 0.85; // radii: deeper vertices belong to the socket
const LID_WIDE = 1.5; // radii to each side, where a margin has the height of the eye corners
const LID_FADE = 0.5; // rad above and below the margin over which a lid's weight falls to 0
const LID_FOLD = [0.3, 0.8]; // of the distance from the margin to the brow, where a lid's skin ends, also under overhanging brows
const LID_LEAST = 4; // mm, minimum of that distance
const OVERLAP = 0.06; // rad: closed lids overlap, to tolerate errors of the margins
const SIDES = [
  { eye: 'eye_l', target: 'eyeBlinkLeft', pupil: '3.5', upper: 19, lower: 21, yaw: 23, pitch: 25, points: ['3.1', '3.3'], brow: ['4.1', '4.3', '4.5'], side: 'l' },
  { eye: 'eye_r', target: 'eyeBlinkRight', pupil: '3.6', upper: 20, lower: 22, yaw: 24, pitch: 26, points: ['3.2', '3.4'], brow: ['4.2', '4.4', '4.6'], side: 'r' },
];
const BLINK = { upper: 900, lower: 124 }; // eyeBlink in models/shapes/arkit.json
const cosine = (d) => (d >= 1 ? 0 : 0.5 + 0.5 * Math.cos(Math.PI * Math.max(0, d)));

/** The condyles, from the proportions of a face (fields of Farkas' Anthropometry, 1994, within some mm). */
export const jawPivot = (fdp, fapu) => [0, -0.6 * fapu.ENS, (fdp['3.5'][2] + fdp['3.6'][2]) / 2 - 1.14 * fapu.ES];

/** Jaw angle per unit of FAP 3, at a usual opening. */
export function jawTurn(fdp, fapu, pivot) {
  const USUAL = 300;
  const [y, z] = [fdp['2.1'][1] - pivot[1], fdp['2.1'][2] - pivot[2]];
  let [low, high] = [0, 1];
  for (let i = 0; i < 60; i++) {
    const mid = (low + high) / 2;
    if (y - (y * Math.cos(mid) - z * Math.sin(mid)) < (USUAL * fapu.MNS) / 1024) low = mid;
    else high = mid;
  }
  return { name: 'jaw', fap: 3, pivot, axis: [1, 0, 0], radians: low / USUAL };
}

function eyeBall(parts, fdp, { eye, pupil }) {
  const part = parts.find(({ name }) => name === eye);
  const ball = part && ballOf(part.position);
  return ball && ball.radius < 30 ? ball : { centre: [fdp[pupil][0], fdp[pupil][1], fdp[pupil][2] - 12], radius: 12 };
}

/** Height of a brow above x, mm; Infinity without its points. */
function browOver(fdp, names) {
  const line = names.flatMap((name) => (fdp[name] ? [fdp[name]] : [])).sort((a, b) => a[0] - b[0]);
  return (x) => {
    if (!line.length) return Infinity;
    const i = Math.max(1, line.findIndex((p) => p[0] > x));
    const [a, b] = line.length > 1 && x < line.at(-1)[0] ? [line[i - 1], line[i]] : [line.at(-1), line.at(-1)];
    const share = Math.min(1, Math.max(0, (x - a[0]) / (b[0] - a[0] || 1)));
    return a[1] + share * (b[1] - a[1]);
  };
}

/** Weights of the rotations of both lids of an eye over the vertices of a part. */
function lidShares(part, { centre, radius }, blink, fdp, { points: [upperPoint, lowerPoint], brow }) {
  const high = fdp[upperPoint][1];
  const over = browOver(fdp, brow);
  const goes = ([x, y]) => cosine(((y - high) / Math.max(LID_LEAST, over(x) - high) - LID_FOLD[0]) / (LID_FOLD[1] - LID_FOLD[0]));
  const polar = (p) => Math.atan2(p[1] - centre[1], p[2] - centre[2]);
  const margin = (name) => {
    const top = polar(fdp[name]);
    const half = LID_WIDE * radius;
    // the margin: highest over its point, falling to the corner's height at both ends
    return (x) => top * Math.max(0, 1 - ((x - fdp[name][0]) / half) ** 2);
  };
  const [above, below] = [margin(upperPoint), margin(lowerPoint)];
  const out = { upper: new Float64Array(part.position.length / 3), lower: new Float64Array(part.position.length / 3) };
  for (let v = 0; v < out.upper.length; v++) {
    const p = at(part.position, v);
    const away = Math.hypot(...p.map((x, k) => x - centre[k]));
    if (away > LID_SKIN * radius || away < LID_INSIDE * radius || p[2] < centre[2] - 0.2 * radius) continue;
    if (blink) {
      const turn = polar(p) - polar(p.map((x, k) => x + blink[3 * v + k]));
      out[turn > 0 ? 'upper' : 'lower'][v] = Math.abs(turn) / (turn > 0 ? BLINK.upper : BLINK.lower);
      continue;
    }
    const [top, bottom, own] = [above(p[0]), below(p[0]), polar(p)];
    const gap = top - bottom;
    if (gap <= 0) continue;
    const isUpper = own > (top + bottom) / 2;
    const off = isUpper ? own - top : bottom - own;
    out[isUpper ? 'upper' : 'lower'][v] = ((gap + OVERLAP) * cosine(off / LID_FADE) * (isUpper ? goes(p) : 1)) / 1024;
  }
  return out;
}

/** @returns {{turns: object[], shares: (part: object) => object[], eyes: object[]}} */
export function lidsAndEyes(parts, fdp) {
  const [turns, byPart, eyes] = [[], new Map(), []];
  const soft = parts.filter(({ name }) => ['skin', 'lashes'].includes(name));
  const add = (part, share) => (byPart.get(part) ?? byPart.set(part, []).get(part)).push(share);
  for (const one of SIDES) {
    const ball = eyeBall(parts, fdp, one);
    eyes.push(ball);
    const pivot = ball.centre;
    const lids = soft.map((part) => lidShares(part, ball, part.targets[one.target], fdp, one));
    for (const lid of ['upper', 'lower']) {
      const most = Math.max(...lids.flatMap((list) => list[lid].reduce((a, b) => Math.max(a, b), 0)));
      if (!(most > 0)) continue;
      const name = `lid_${one.side}_${lid}`;
      turns.push({ name, fap: one[lid], pivot, axis: [lid === 'upper' ? 1 : -1, 0, 0], radians: most });
      soft.forEach((part, i) => add(part, { turn: name, ...some(lids[i][lid].map((x) => x / most)) }));
    }
    turns.push({ name: `${one.eye}_yaw`, fap: one.yaw, pivot, axis: [0, 1, 0], radians: 1e-5 }, { name: `${one.eye}_pitch`, fap: one.pitch, pivot, axis: [1, 0, 0], radians: 1e-5 });
    const part = parts.find(({ name }) => name === one.eye);
    if (part) for (const kind of ['yaw', 'pitch']) add(part, { turn: `${one.eye}_${kind}`, weight: 1 });
  }
  return { turns, shares: (part) => byPart.get(part) ?? [], eyes };
}

/** Vertices with nonzero weights, and the weights. */
export function some(weights) {
  const vertices = [];
  weights.forEach((weight, v) => weight > 1 / 510 && vertices.push(v));
  return { vertices, weights: vertices.map((v) => weights[v]) };
}

/** Rotation of the head around the top of the spine, decreasing down the neck. */
export function neck(parts, fdp, fapu) {
  const pivot = fdp['7.1'] ?? [0, -0.65 * fapu.ENS, (fdp['3.5'][2] + fdp['3.6'][2]) / 2 - 1.55 * fapu.ES];
  const top = fdp['2.1'][1] - 0.4 * fapu.MNS;
  const bottom = top - 3 * fapu.MNS;
  const turns = [['pitch', 48, [1, 0, 0]], ['yaw', 49, [0, 1, 0]], ['roll', 50, [0, 0, 1]]].map(([name, fap, axis]) => ({ name: `head_${name}`, fap, pivot, axis, radians: 1e-5 }));
  const shares = (part) => {
    const weights = Array.from({ length: part.position.length / 3 }, (_, v) => 1 - cosine((part.position[3 * v + 1] - bottom) / (top - bottom)));
    const share = weights.every((weight) => weight > 0.999) ? { weight: 1 } : some(weights);
    return turns.map(({ name }) => ({ turn: name, ...share }));
  };
  return { turns, shares };
}
