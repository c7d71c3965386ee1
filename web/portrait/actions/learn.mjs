// SPDX-License-Identifier: MIT
/**
 * Learns a face's FAPs from its poses: distributes the residuals to the actions by their activity, over all poses at once
 * (after Li, Weise and Pauly, "Example-based facial rigging", 2010). MPEG-4 defines what a FAP does to its feature point along
 * its axis: that is kept, and so are closed lips and lids.
 */
import { FAPS } from '../moved.mjs';
import { smoothOver } from '../surface.mjs';

/**
 * FAPs that may get a way of their own: brows, corners of the mouth (the inner ones go with the outer ones), cheeks,
 * nose. Not the jaw and the lips' middle: what is
 * learnt of an open mouth is teeth and shadows, and made it worse (tests/bench/poses.mjs).
 */
const ACTIONS = [31, 32, 33, 34, 35, 36, 37, 38, 41, 42, 53, 54, 59, 60, 61, 62, 63];
const LINE = ['2.5', '2.7', '2.2', '2.6', '2.4']; // where the lips meet
const TOUCH = { within: 5, deviation: 1.5 }; // mm from there both lips do the same
const OWN = 0.6; // standard deviation of a person's own share of an action
const SPREAD = 10; // rounds of smoothing by which an action may spread
const TRIAL = 6; // mm
const UNSURE = 0.4; // mm, of what is seen to be left over
const SMOOTH = 2; // rounds
const FADE = 6; // rounds beyond what is seen
const LEAST = 0.3; // mm: an action that did less in all poses says nothing
const WORTH = 0.03; // mm for a mm: less is not seen, and costs bytes

const step = (t) => (t <= 0 ? 0 : t >= 1 ? 1 : t * t * (3 - 2 * t));

/** Interpolates the residuals from the sample points to the vertices: x and y. */
function onSkin({ on, skin }, shift) {
  const vertices = skin.position.length / 3;
  const [x, y, sum] = [0, 1, 2].map(() => new Float64Array(vertices));
  on.forEach(({ corners, w }, i) => corners.forEach((v, c) => {
    x[v] += w[c] * shift[2 * i];
    y[v] += w[c] * shift[2 * i + 1];
    sum[v] += w[c];
  }));
  const mesh = { index: skin.index, smooth: skin.smooth, vertices };
  const known = smoothOver(mesh, sum.map((w) => Math.min(1, w)), FADE);
  return [x, y].map((list) => {
    const mean = list.map((value, v) => (sum[v] > 0 ? value / sum[v] : 0));
    return smoothOver(mesh, mean, SMOOTH).map((value, v) => value * known[v]);
  });
}

/** mm from the line where the lips meet. */
function fromLine({ position, fdp }) {
  const points = LINE.map((name) => fdp[name]);
  const toSegment = (p, a, b) => {
    const ab = a.map((x, k) => b[k] - x);
    const along = ab.reduce((sum, x, k) => sum + x * (p[k] - a[k]), 0) / ab.reduce((sum, x) => sum + x * x, 0);
    const t = Math.max(0, Math.min(1, along));
    return Math.hypot(...p.map((x, k) => x - a[k] - t * ab[k]));
  };
  return Float64Array.from({ length: position.length / 3 }, (_, v) => {
    const p = [...position.subarray(3 * v, 3 * v + 3)];
    return Math.min(...points.slice(1).map((b, i) => toSegment(p, points[i], b)));
  });
}

/**
 * Keeps the lips in contact: near their line each vertex moves as its neighbours on both lips.
 */
function together({ position }, far, own) {
  const near = [...far.keys()].filter((v) => far[v] < TOUCH.within + 2 * TOUCH.deviation);
  const out = own.slice();
  for (const v of near) {
    if (far[v] > TOUCH.within) continue;
    const sum = [0, 0, 0];
    let all = 0;
    for (const u of near) {
      const between = [0, 1, 2].reduce((total, k) => total + (position[3 * v + k] - position[3 * u + k]) ** 2, 0);
      const apart = between / TOUCH.deviation ** 2;
      if (apart > 6) continue;
      const w = Math.exp(-0.5 * apart);
      all += w;
      for (let k = 0; k < 3; k++) sum[k] += w * own[3 * u + k];
    }
    for (let k = 0; k < 3; k++) out[3 * v + k] = sum[k] / all;
  }
  return out;
}

/** Returns for each action its displacements, mm per mm, and the region in which a person's own share is allowed. */
function actionsOf({ skin }, poses) {
  const vertices = skin.position.length / 3;
  const lids = smoothOver({ index: skin.index, smooth: skin.smooth, vertices }, skin.lids, 2);
  return ACTIONS.flatMap((fap) => [1, -1].map((sign) => {
    const amounts = poses.map(({ faps }) => Math.max(0, sign * (faps.get(fap) ?? 0)));
    if (Math.max(...amounts) < LEAST || (sign < 0 && !FAPS[fap].bidirectional)) return null;
    const field = skin.moved(fap, sign * TRIAL);
    const size = Float64Array.from({ length: vertices }, (_, v) =>
      Math.hypot(field[3 * v], field[3 * v + 1], field[3 * v + 2]));
    const reach = smoothOver({ index: skin.index, smooth: skin.smooth, vertices }, size, SPREAD);
    const free = reach.map((r, v) => (OWN * Math.max(r, size[v]) * step(1 - 4 * lids[v])) ** 2);
    // along it the feature point, and what goes with it, has its way already
    const axis = FAPS[fap].direction.findIndex((x) => x);
    const along = (x, v, k) => x * Math.max(0, 1 - Math.abs(field[3 * v + k])) ** 2;
    const freely = [0, 1].map((k) => (k === axis ? free.map((x, v) => along(x, v, k)) : free));
    return { fap, sign, amounts, field, free: freely };
  })).filter(Boolean);
}

/** Its feature point goes along its axis as far as MPEG-4 says. */
function held({ fap, sign, field }, own, { position, fdp }) {
  const { direction, point } = FAPS[fap];
  let v = 0;
  const distance = (u) => Math.hypot(...fdp[point].map((x, k) => x - position[3 * u + k]));
  for (let u = 1; u < position.length / 3; u++) if (distance(u) < distance(v)) v = u;
  const along = (list) => sign * direction.reduce((sum, d, k) => sum + d * list[3 * v + k], 0);
  const share = along(own) / along(field);
  return own.map((x, i) => x - share * field[i]);
}

/**
 * @param {object} speaker of speakerOf @param {{faps: Map<number, number>, shift: Float64Array}[]} poses of follow.mjs
 * @returns {{fap: number, sign: number, own: Float64Array}[]} own: mm for a mm of the FAP in that direction, three
 *   numbers for each vertex of the skin
 */
export function learn(speaker, poses) {
  const { skin } = speaker;
  const left = poses.map(({ shift }) => onSkin(speaker, shift));
  const far = fromLine(skin);
  const actions = actionsOf(speaker, poses);
  const own = actions.map(() => new Float64Array(skin.position.length));
  for (let v = 0; v < skin.position.length / 3; v++) {
    for (let axis = 0; axis < 2; axis++) {
      const free = actions.map((action) => action.free[axis][v]);
      if (!free.some((x) => x > 0)) continue;
      const said = poses.map((_, k) => poses.map((__, l) =>
        actions.reduce((sum, { amounts }, f) => sum + free[f] * amounts[k] * amounts[l], k === l ? UNSURE ** 2 : 0)));
      const pull = inverted(said).map((row) => row.reduce((sum, x, l) => sum + x * left[l][axis][v], 0));
      actions.forEach(({ amounts }, f) => {
        own[f][3 * v + axis] = free[f] * pull.reduce((sum, x, k) => sum + amounts[k] * x, 0);
      });
    }
  }
  return actions
    .map((action, f) => ({ fap: action.fap, sign: action.sign, own: held(action, together(skin, far, own[f]), skin) }))
    .filter(({ own: list }) => list.some((x) => Math.abs(x) > WORTH));
}

/** Inverts a symmetric, positive definite matrix. */
function inverted(a) {
  const n = a.length;
  const both = a.map((row, i) => [...row, ...row.map((_, k) => Number(k === i))]);
  for (let c = 0; c < n; c++) {
    const by = both[c][c];
    both[c] = both[c].map((x) => x / by);
    for (let r = 0; r < n; r++) {
      const factor = both[r][c];
      if (r !== c && factor) both[r] = both[r].map((x, k) => x - factor * both[c][k]);
    }
  }
  return both.map((row) => row.slice(n));
}
