// SPDX-License-Identifier: GPL-3.0-or-later
/** Finds isolated strips of a mesh: hair has some that are 1 or 2 mm wide, and would float beside it as dotted lines. */

const away = (a, b) => a.map((x, k) => x - b[k]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/**
 * @param {{v: number[]}[]} faces @param {(v: number) => number[]} at where a vertex is @param {number} thinnest mm
 * @returns {(f: {v: number[]}) => boolean} whether the face's strip is that wide on average
 */
export function wideEnough(faces, at, thinnest) {
  const one = new Map(); // union-find: another vertex of the same strip, down to the first
  const first = (v) => {
    while (one.get(v) !== undefined) v = one.get(v);
    return v;
  };
  for (const { v } of faces)
    for (const other of v.slice(1)) if (first(other) !== first(v[0])) one.set(first(other), first(v[0]));
  const strips = new Map();
  for (const { v } of faces) {
    const name = first(v[0]);
    const strip = strips.get(name) ?? { area: 0, low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
    strips.set(name, strip);
    const points = v.map(at);
    for (let i = 2; i < points.length; i++)
      strip.area += Math.hypot(...cross(away(points[i - 1], points[0]), away(points[i], points[0]))) / 2;
    strip.low = strip.low.map((x, k) => Math.min(x, ...points.map((q) => q[k])));
    strip.high = strip.high.map((x, k) => Math.max(x, ...points.map((q) => q[k])));
  }
  return ({ v }) => {
    const { area, low, high } = strips.get(first(v[0]));
    return area >= thinnest * Math.hypot(...away(high, low));
  };
}
