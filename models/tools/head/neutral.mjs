// SPDX-License-Identifier: GPL-3.0-or-later
/** The neutral face of MPEG-4: lips touching along the whole line, lids tangent to the iris. */
import { MOUTH_CONTACT, EYE_MARGIN } from '../lib/hm08.mjs';
import { piecewise } from '../lib/zones.mjs';

/**
 * Closes the gap of the base mesh between the inner lip lines; both move by half, and the
 * change fades over the lips and into the mouth with the inner share of the grid. `tuck` (mm) then puts the
 * lower line a little up and back behind the upper one, so that no light comes through between the vertices.
 */
export function closeLips(p, topology, grid, tuck) {
  const line = (side, from, to) => {
    const points = topology.mouth[side][MOUTH_CONTACT].slice(from, to + 1).map((v) => [
      Math.abs(p[v * 3]),
      p[v * 3 + 1],
      p[v * 3 + 2],
    ]);
    points.sort((a, b) => a[0] - b[0]);
    return (x, k) =>
      piecewise(
        points.map((q) => q[0]),
        points.map((q) => q[k]),
        Math.abs(x),
      );
  };
  const shift = {};
  for (const side of ['l', 'r']) {
    const upper = line(side, 0, 11),
      lower = line(side, 11, 19);
    shift[side] = (x, k) => (lower(x, k) - upper(x, k)) / 2;
  }
  const vertices = new Set(topology.mouth.l.flat().concat(topology.mouth.r.flat()));
  for (const v of vertices) {
    const side = p[v * 3] >= 0 ? 'l' : 'r';
    const sign = grid.lower[v] === 0.5 ? 0 : grid.lower[v] > 0.5 ? -1 : 1;
    const x = p[v * 3];
    const hidden = sign < 0 ? tuck * grid.inner[v] ** 2 : 0;
    for (const k of [1, 2])
      p[v * 3 + k] += sign * grid.inner[v] * shift[side](x, k) + hidden * (k === 1 ? 0.6 : -1);
  }
  for (const side of ['l', 'r']) foldBack(p, topology.mouth[side], grid);
}

/** Behind the line of contact the lips separate again: if they stayed together, an opening would become visible too late. */
function foldBack(p, loops, grid) {
  loops[MOUTH_CONTACT].forEach((contact, column) => {
    if (grid.lower[contact] === 0.5) return;
    const further = grid.lower[contact] > 0.5 ? Math.min : Math.max;
    for (const loop of loops.slice(MOUTH_CONTACT + 1, MOUTH_CONTACT + 3)) {
      const at = loop[column] * 3 + 1;
      p[at] = further(p[at], p[contact * 3 + 1]);
    }
  });
}

/** Margin of one eye: columns with their side, from the two canthi, which are the ends of the ring in x. */
export function lidMargin(loops, p) {
  const ring = loops[EYE_MARGIN];
  const x = ring.map((v) => p[v * 3]);
  const outer = x.indexOf(Math.max(...x.map(Math.abs)) * Math.sign(x[0]));
  const inner = x.indexOf(Math.min(...x.map(Math.abs)) * Math.sign(x[0]));
  const upper = new Array(ring.length).fill(false);
  for (let c = (inner + 1) % ring.length; c !== outer; c = (c + 1) % ring.length) upper[c] = true;
  return { ring, upper, inner, outer };
}

/**
 * Turns both lids of an eye until the middles of their margins stand `above` and `below` the eye's axis (mm).
 */
export function setLids(ctx, side, lids, [above, below]) {
  const { p } = ctx;
  const [, cy, cz] = lids.centre;
  const turn = (weights, point, y) => {
    const v = ctx.fdpVertex[point] * 3;
    const r = Math.hypot(p[v + 1] - cy, p[v + 2] - cz);
    const angle =
      (Math.atan2(p[v + 1] - cy, p[v + 2] - cz) - Math.asin(y / r)) / weights[ctx.fdpVertex[point]];
    for (let i = 0; i < weights.length; i++) {
      if (!weights[i]) continue;
      const c = Math.cos(angle * weights[i]),
        s = Math.sin(angle * weights[i]);
      const dy = p[i * 3 + 1] - cy,
        dz = p[i * 3 + 2] - cz;
      p[i * 3 + 1] = cy + dy * c - dz * s;
      p[i * 3 + 2] = cz + dy * s + dz * c;
    }
  };
  turn(lids.upper, side === 'l' ? '3.1' : '3.2', above);
  turn(lids.lower, side === 'l' ? '3.3' : '3.4', -below);
}
