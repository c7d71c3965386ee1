// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * The parts of the head: skin cut from the base mesh, proxies fitted to it, and for each its share in the
 * actions.
 */
import { readProxy } from '../head/assets.mjs';
import { EYE_MARGIN } from './hm08.mjs';
import { triangulate } from './mesh.mjs';
import { wideEnough } from '../head/strips.mjs';
import { ellipsoid, nearestOnLine } from './zones.mjs';

/** Whether a point stands above the cut, once the arms are lowered. @param {{y: number, x?: number}} [cut] mm */
function within({ warp }, cut) {
  if (!cut) return () => true;
  return (q) => {
    const [x, y] = warp ? warp(q) : q;
    return y > cut.y && Math.abs(x) < (cut.x ?? Infinity);
  };
}

/**
 * @param {number[]|undefined} hidden flags base vertices under clothes @returns part with `refs`: for each
 *   vertex [base vertex, weight] pairs, and `position` in mm
 */
export function skinPart(ctx, spec, hidden) {
  const { base, p } = ctx;
  const group = base.groups.indexOf('body');
  const inside = within(ctx, spec.cut);
  const keep = (f) =>
    f.group === group &&
    !f.v.every((v) => hidden?.[v]) &&
    f.v.every((v) => inside([p[v * 3], p[v * 3 + 1], p[v * 3 + 2]]));
  const mesh = triangulate(base.faces, base.uvs, keep);
  return finish(
    'skin',
    mesh,
    mesh.source.map((v) => [[v, 1]]),
    (v) => [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]],
  );
}

/**
 * A proxy: p = sum of weights * base vertices + offset, then the recipe's `tweaks`: zones that are shifted by
 * some mm.
 */
export function proxyPart(ctx, name, spec, keep) {
  const proxy = readProxy(ctx.assets, spec.proxy);
  const { p } = ctx;
  const refs = proxy.refs.map((three, i) =>
    three.map((v, j) => [v, proxy.weights[i][j]]).filter(([, w]) => w !== 0),
  );
  const fitted = (i) =>
    [0, 1, 2].map(
      (k) =>
        refs[i].reduce((sum, [v, w]) => sum + w * p[v * 3 + k], 0) +
        proxy.offsets[i][k] * 100 * (spec.scale ?? 1) +
        (spec.shift?.[k] ?? 0),
    );
  const tweaks = (spec.tweaks ?? []).map((t) => ({
    weight: ellipsoid(t.centre, t.radii, t.flat),
    shift: t.shift,
  }));
  const tweaked = (i) => {
    const q = fitted(i);
    return q.map((x, k) => x + tweaks.reduce((sum, t) => sum + t.weight(...q) * t.shift[k], 0));
  };
  const place = spec.shorten ? (i) => shortened(ctx, tweaked(i), spec.shorten) : tweaked;
  const kept = within(ctx, spec.cut);
  const inside = (i) => kept(fitted(i));
  const wide = spec.thinnest ? wideEnough(proxy.faces, fitted, spec.thinnest) : () => true;
  const mesh = triangulate(proxy.faces, proxy.uvs, (f) => f.v.every(inside) && wide(f) && (!keep || keep(f, refs)));
  return {
    ...finish(
      name,
      mesh,
      mesh.source.map((i) => refs[i]),
      place,
    ),
    proxy,
  };
}

/** Draws a lash towards its root, the nearest point of the lids' margins. */
function shortened({ p, topology }, q, factor) {
  const loop = (q[0] > 0 ? topology.eye.l : topology.eye.r)[EYE_MARGIN];
  const points = loop.map((v) => [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]]);
  const root = nearestOnLine(points, points, q, true).value;
  return root.map((x, k) => x + (q[k] - x) * factor);
}

function finish(name, mesh, refs, place) {
  return {
    name,
    refs,
    uv: mesh.uv,
    index: mesh.index,
    smooth: mesh.smooth,
    position: Float64Array.from(mesh.source.flatMap(place)),
    moves: [],
    turns: [],
  };
}

/** Gives a part its share of the moves and turns: the weighted mean of the fields at its base vertices. */
export function applyActions(part, actions, least) {
  for (const { fap, sign, field } of actions.moves) {
    const vertices = [],
      deltas = [];
    part.refs.forEach((refs, i) => {
      const d = [0, 0, 0];
      for (const [v, w] of refs) for (let k = 0; k < 3; k++) d[k] += w * field[v * 3 + k];
      if (Math.hypot(...d) >= least) {
        vertices.push(i);
        deltas.push(...d);
      }
    });
    if (vertices.length) part.moves.push({ fap, sign, vertices, deltas });
  }
  for (const turn of actions.turns) {
    if (turn.spared.includes(part.name)) continue;
    if (turn.rigid[part.name] !== undefined) {
      part.turns.push({ turn: turn.name, weight: turn.rigid[part.name] });
      continue;
    }
    pushTurn(
      part,
      turn.name,
      part.refs.map((refs) => refs.reduce((sum, [v, w]) => sum + w * turn.weights[v], 0)),
    );
  }
}

/** Head turns: by the place of each vertex. */
export function applyHeadTurns(part, head) {
  const p = part.position;
  const weights = Array.from({ length: p.length / 3 }, (_, v) =>
    head.weight(p[v * 3], p[v * 3 + 1], p[v * 3 + 2]),
  );
  const rigid = weights.every((w) => w > 0.999);
  for (const turn of head.turns) {
    if (rigid) part.turns.push({ turn: turn.name, weight: 1 });
    else pushTurn(part, turn.name, weights);
  }
}

function pushTurn(part, turn, weights) {
  const bytes = weights.map((w) => Math.round(Math.min(1, Math.max(0, w)) * 255));
  const vertices = bytes.flatMap((b, v) => (b ? [v] : []));
  if (vertices.length) part.turns.push({ turn, vertices, weights: vertices.map((v) => bytes[v]) });
}
