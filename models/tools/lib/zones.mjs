// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Weights of influence zones: ellipsoids and curves with a raised cosine, and interpolation between feature
 * points.
 */

/** 1 at 0, 0 from 1 on: W = 0.5 (1 + cos(pi d)). */
export function raisedCosine(d) {
  return d >= 1 ? 0 : d <= 0 ? 1 : 0.5 * (1 + Math.cos(Math.PI * d));
}

/** Raised cosine after a plateau: full weight up to `flat`, none from `reach` on. */
export function plateau(d, flat, reach) {
  return raisedCosine((d - flat) / (reach - flat));
}

/** An ellipsoid with half axes `radii` round `centre`, its inner part `flat` (0..1) at full weight. */
export function ellipsoid(centre, radii, flat = 0) {
  return (x, y, z) => {
    const a = (x - centre[0]) / radii[0],
      b = (y - centre[1]) / radii[1],
      c = (z - centre[2]) / radii[2];
    const square = a * a + b * b + c * c;
    return square >= 1 ? 0 : plateau(Math.sqrt(square), flat, 1);
  };
}

/** 0 below `a`, 1 above `b`, smooth between. Also works downward when a > b. */
export function smoothstep(a, b, x) {
  const t = Math.min(1, Math.max(0, (x - a) / (b - a)));
  return t * t * (3 - 2 * t);
}

/**
 * Cardinal Hermite basis over nodes: `basis(i, x)` is 1 at node i and 0 at all others, and the sum over i is
 * 1, so feature points on a line do not disturb each other. `steep` multiplies the slope at the two ends (an
 * ellipse rather than an arc).
 */
export function cardinalBasis(nodes, steep = 1) {
  const n = nodes.length;
  const slope = (y, k) => {
    if (k === 0) return ((y[1] - y[0]) / (nodes[1] - nodes[0])) * steep;
    if (k === n - 1) return ((y[n - 1] - y[n - 2]) / (nodes[n - 1] - nodes[n - 2])) * steep;
    return (y[k + 1] - y[k - 1]) / (nodes[k + 1] - nodes[k - 1]);
  };
  return (i, x) => {
    const y = nodes.map((_, k) => (k === i ? 1 : 0));
    if (x <= nodes[0]) return y[0];
    if (x >= nodes[n - 1]) return y[n - 1];
    let k = 0;
    while (x > nodes[k + 1]) k++;
    const h = nodes[k + 1] - nodes[k];
    const t = (x - nodes[k]) / h;
    const t2 = t * t,
      t3 = t2 * t;
    return (
      y[k] * (2 * t3 - 3 * t2 + 1) +
      h * slope(y, k) * (t3 - 2 * t2 + t) +
      y[k + 1] * (3 * t2 - 2 * t3) +
      h * slope(y, k + 1) * (t3 - t2)
    );
  };
}

/** Piecewise-linear map through (from[i], to[i]), held constant outside. */
export function piecewise(from, to, x) {
  if (x <= from[0]) return to[0];
  for (let i = 1; i < from.length; i++) {
    if (x <= from[i]) return to[i - 1] + ((to[i] - to[i - 1]) * (x - from[i - 1])) / (from[i] - from[i - 1]);
  }
  return to[to.length - 1];
}

/**
 * Nearest point of a polyline: distance, and the value interpolated from `values` (several numbers a point).
 */
export function nearestOnLine(points, values, q, closed = false) {
  const n = points.length;
  let least = Infinity,
    at = 0,
    share = 0;
  for (let i = 0; i < (closed ? n : n - 1); i++) {
    const a = points[i],
      b = points[(i + 1) % n];
    const bx = b[0] - a[0],
      by = b[1] - a[1],
      bz = b[2] - a[2];
    const qx = q[0] - a[0],
      qy = q[1] - a[1],
      qz = q[2] - a[2];
    const square = bx * bx + by * by + bz * bz;
    const t = square > 0 ? Math.min(1, Math.max(0, (bx * qx + by * qy + bz * qz) / square)) : 0;
    const dx = t * bx - qx,
      dy = t * by - qy,
      dz = t * bz - qz;
    const d = dx * dx + dy * dy + dz * dz;
    if (d < least) {
      least = d;
      at = i;
      share = t;
    }
  }
  const next = values[(at + 1) % n];
  return { distance: Math.sqrt(least), value: values[at].map((x, k) => x + share * (next[k] - x)) };
}

export function clamp(x, low, high) {
  return Math.min(high, Math.max(low, x));
}
