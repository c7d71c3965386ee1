// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Eyelids, eyeballs and pupils: FAPs 19 to 30. A lid rotates about the eyeball's centre on an axis along x, so every point keeps its distance
 * from the eyeball. Each point of the margin rotates until it meets the other lid's margin.
 */
import { EYE_MARGIN } from '../../lib/hm08.mjs';
import { lidMargin } from '../neutral.mjs';
import { nearestOnLine, piecewise, plateau, smoothstep } from '../../lib/zones.mjs';

const SIDES = {
  l: { upper: 19, lower: 21, yaw: 23, pitch: 25, thrust: 27, point: ['3.1', '3.3'] },
  r: { upper: 20, lower: 22, yaw: 24, pitch: 26, thrust: 28, point: ['3.2', '3.4'] },
};

/** mm below the line of the brow at which the skin starts to follow the upper lid, and follows fully: the brow's hairs stay in place. */
const BELOW_BROW = [1.5, 6];

/** Returns the distance of a point below the line of the brow, mm. */
function browLine(fdp, side) {
  const points = { l: ['4.1', '4.3', '4.5'], r: ['4.2', '4.4', '4.6'] }[side].map((name) => fdp[name]).sort((a, b) => a[0] - b[0]);
  const [x, y] = [0, 1].map((k) => points.map((q) => q[k]));
  return (q) => piecewise(x, y, q[0]) - q[1];
}

const FOLD_PASSES = 3;

/**
 * Evens the shares of the upper lid's skin along its surface. In a deep fold neighbours lie at nearly the same height below the brow and distance from
 * the margin, in another order than along the skin: shares by height and distance alone would turn the fold over, and a slit would stay in closed lids.
 * No share grows: skin under the hairs of the brow stays in place.
 */
function smoothFold(shares, moved, near) {
  const fold = moved.filter(({ v, lid }) => lid === 'upper' && shares[v] > 0 && shares[v] < 1);
  for (let pass = 0; pass < FOLD_PASSES; pass++) {
    const next = fold.map(({ v }) => Math.min(shares[v], (shares[v] + near[v].reduce((sum, n) => sum + shares[n], 0) / near[v].length) / 2));
    fold.forEach(({ v }, i) => (shares[v] = next[i]));
  }
}

/**
 * Weights of both lids of one eye over the base vertices, and the angle that closes the eye where the weight is 1.
 */
export function lidWeights(ctx, side, tuning) {
  const { p, topology } = ctx;
  const centre = ctx.eyes[side];
  const loops = topology.eye[side];
  const { ring, upper } = lidMargin(loops, p);
  const polar = (v) => Math.atan2(p[v * 3 + 1] - centre[1], p[v * 3 + 2] - centre[2]);
  const line = (want) => {
    const points = ring
      .filter((v, c) => upper[c] === want)
      .map((v) => [p[v * 3], polar(v)])
      .sort((a, b) => a[0] - b[0]);
    return (x) =>
      piecewise(
        points.map((q) => q[0]),
        points.map((q) => q[1]),
        x,
      );
  };
  const top = line(true),
    bottom = line(false);
  const upperPoint = ring.indexOf(ctx.fdpVertex[SIDES[side].point[0]]);
  // Slightly beyond closure beside the feature points, because the margins' corners do not face each other
  // there.
  const middle = p[ring[upperPoint] * 3];
  const gap = ring.map(
    (v) =>
      Math.max(0, top(p[v * 3]) - bottom(p[v * 3])) +
      tuning.overlap * (1 - Math.exp(-(((p[v * 3] - middle) / 3) ** 2))),
  );
  // Weights are at most 1, so the angle is that of the widest opening, which may lie beside the feature points.
  const widest = (want) => Math.max(...gap.filter((_, c) => upper[c] === want));
  const angle = { upper: widest(true), lower: widest(false) };
  const points = ring.map((v) => [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]]);
  const values = ring.map((_, c) => [gap[c], upper[c] ? 1 : 0]);
  const inside = new Set(loops.slice(EYE_MARGIN, EYE_MARGIN + 4).flat());
  const behind = new Set(loops.slice(EYE_MARGIN + 4).flat());
  const lashes = [1, 2].map((n) => ctx.inGroup(`helper-${side}-eyelashes-${n}`));
  const weights = { upper: new Float64Array(p.length / 3), lower: new Float64Array(p.length / 3) };
  const skin = new Set(topology.faces.flatMap((f) => f.v));
  // Closing must unfold the skin that opening folded, so the same skin moves as when the eye was opened: by the
  // distance over the fold, its edge would move farther than the skin under it.
  const first = !ctx.lidShares?.[side];
  const shares = first ? new Float32Array(weights.upper.length) : ctx.lidShares[side];
  ctx.lidShares = { ...ctx.lidShares, [side]: shares };
  const belowBrow = browLine(ctx.fdp, side);
  const moved = [];
  for (let v = 0; v < weights.upper.length; v++) {
    const lash = lashes[0][v] || lashes[1][v];
    if (!(skin.has(v) || lash) || behind.has(v)) continue;
    const q = [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]];
    if (Math.hypot(q[0] - centre[0], q[1], q[2]) > 45) continue;
    const near = nearestOnLine(points, values, q, true);
    const isUpper = lash ? lashes[1][v] : near.value[1] > 0.5;
    const reach = isUpper ? tuning.upperReach : tuning.lowerReach;
    const free = isUpper ? smoothstep(...BELOW_BROW, belowBrow(q)) : 1;
    if (first) shares[v] = free * plateau(near.distance, tuning.rigid, reach);
    moved.push({ v, gap: near.value[0], lid: isUpper ? 'upper' : 'lower', whole: lash || inside.has(v) });
  }
  if (first) smoothFold(shares, moved.filter(({ whole }) => !whole), topology.near);
  for (const { v, gap: mine, lid, whole } of moved) weights[lid][v] = Math.min(1, ((whole ? 1 : shares[v]) * mine) / angle[lid]);
  return { ...weights, angle, centre };
}

export function eyeActions(actions, ctx, tuning) {
  for (const [side, faps] of Object.entries(SIDES)) {
    const lids = lidWeights(ctx, side, tuning);
    const pivot = lids.centre;
    actions.turn({
      name: `lid_${side}_upper`,
      fap: faps.upper,
      pivot,
      axis: [1, 0, 0],
      radians: lids.angle.upper / 1024,
      at: (v) => lids.upper[v],
      spared: ['brows'], // their hairs extend below the start of the skin that follows the lid
    });
    actions.turn({
      name: `lid_${side}_lower`,
      fap: faps.lower,
      pivot,
      axis: [-1, 0, 0],
      radians: lids.angle.lower / 1024,
      at: (v) => lids.lower[v],
    });
    const rigid = { [`eye_${side}`]: 1 };
    actions.turn({ name: `eye_${side}_yaw`, fap: faps.yaw, pivot, axis: [0, 1, 0], radians: 1e-5, rigid });
    actions.turn({
      name: `eye_${side}_pitch`,
      fap: faps.pitch,
      pivot,
      axis: [1, 0, 0],
      radians: 1e-5,
      rigid,
    });
  }
}

const DOWN = { upper: 0.8, lower: -0.15 }; // shares of the closing angle; the lower lid rotates in the opposite direction

/** Positions of the skin's vertices with nearly closed lids. @returns {Float64Array} mm */
export function closedLids(ctx, part, tuning) {
  const out = Float64Array.from(part.position);
  for (const side of ['l', 'r']) {
    const lids = lidWeights(ctx, side, tuning);
    const [, cy, cz] = lids.centre;
    part.refs.forEach((refs, i) => {
      const angle = ['upper', 'lower'].reduce(
        (sum, lid) => sum + DOWN[lid] * lids.angle[lid] * refs.reduce((all, [v, w]) => all + w * lids[lid][v], 0),
        0,
      );
      if (!angle) return;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      const [y, z] = [out[i * 3 + 1] - cy, out[i * 3 + 2] - cz];
      out[i * 3 + 1] = cy + y * c - z * s;
      out[i * 3 + 2] = cz + y * s + z * c;
    });
  }
  return out;
}
