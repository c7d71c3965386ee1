// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Coordinates of the lips for every skin vertex: `s` along the lip (-1 right corner, 0 middle, 1 left corner,
 * +-0.5 at the feature points half-way), `lower` (0 upper, 1 lower lip), and the shares of the inner and of
 * the outer contour, `inner` and `outer`, which are raised cosines with sum 1 on the lip; `outer` fades over
 * the skin, `inner` into the mouth.
 */
import { MOUTH_CONTACT, MOUTH_OUTER } from '../lib/hm08.mjs';
import { nearestOnLine, piecewise, plateau, raisedCosine } from '../lib/zones.mjs';

const CORNER = 11;

/**
 * @param {{above: number, below: number, side: number, inside: number}} reach mm over which the weights fade
 */
export function mouthGrid(topology, p, middle, reach) {
  const count = p.length / 3;
  const grid = {
    s: new Float64Array(count),
    lower: new Float64Array(count),
    inner: new Float64Array(count),
    outer: new Float64Array(count),
    inMouth: new Uint8Array(count),
  };
  const at = (v) => [p[v * 3], p[v * 3 + 1], p[v * 3 + 2]];
  const done = new Set();
  for (const [loops, sign] of [
    [topology.mouth.l, 1],
    [topology.mouth.r, -1],
  ]) {
    for (let c = 0; c < loops[0].length; c++)
      fillColumn(
        grid,
        loops.map((l) => l[c]),
        c,
        sign,
        at,
        middle,
        reach,
        done,
      );
  }
  const rim = rimLine(topology, at, grid);
  for (const f of topology.faces) {
    for (const v of f.v) {
      if (done.has(v)) continue;
      done.add(v);
      const q = at(v);
      if (q[2] < rim.points[0][2] - 90) continue;
      const near = nearestOnLine(rim.points, rim.values, q, true);
      const [s, lower] = near.value;
      const mid = lower > 0.5 ? reach.below : reach.above;
      const radius = mid + (reach.side - mid) * Math.abs(s) ** 4;
      grid.s[v] = s;
      grid.lower[v] = lower;
      grid.outer[v] = plateau(near.distance, 0, radius);
    }
  }
  return grid;
}

/** One column of the loops: arc length from the line of contact outward and inward. */
function fillColumn(grid, column, c, sign, at, middle, reach, done) {
  const arc = [0];
  for (let r = 1; r < column.length; r++)
    arc.push(arc[r - 1] + Math.hypot(...at(column[r]).map((x, k) => x - at(column[r - 1])[k])));
  const lower = c > CORNER ? 1 : c === CORNER ? 0.5 : 0;
  const nodes = lower > 0.5 ? middle.lower : middle.upper;
  const width = arc[MOUTH_CONTACT] - arc[MOUTH_OUTER];
  let contact = 0;
  for (let r = MOUTH_CONTACT; r >= MOUTH_OUTER; r--) {
    const t = (arc[MOUTH_CONTACT] - arc[r]) / width;
    const mix = (a, b) => a + (b - a) * t;
    const x = Math.abs(at(column[r])[0]);
    const s =
      c === CORNER
        ? 1
        : piecewise(
            [0, mix(nodes.inner, nodes.outer), mix(middle.cornerInner, middle.cornerOuter)],
            [0, 0.5, 1],
            x,
          );
    const share = raisedCosine(t);
    set(grid, column[r], { s: sign * s, lower, inner: share, outer: 1 - share });
    done.add(column[r]);
    if (r === MOUTH_CONTACT) contact = s;
  }
  for (let r = MOUTH_CONTACT + 1; r < column.length; r++) {
    set(grid, column[r], {
      s: sign * contact,
      lower,
      inner: raisedCosine((arc[r] - arc[MOUTH_CONTACT]) / reach.inside),
      outer: 0,
    });
    grid.inMouth[column[r]] = 1;
    done.add(column[r]);
  }
}

function set(grid, v, { s, lower, inner, outer }) {
  grid.s[v] = s;
  grid.lower[v] = lower;
  grid.inner[v] = inner;
  grid.outer[v] = outer;
}

/** The outer contour as one closed line with (s, lower) at each point. */
function rimLine(topology, at, grid) {
  const left = topology.mouth.l[MOUTH_OUTER];
  const right = topology.mouth.r[MOUTH_OUTER].slice(1, -1).reverse();
  const loop = [...left, ...right];
  return { points: loop.map(at), values: loop.map((v) => [grid.s[v], grid.lower[v]]) };
}
