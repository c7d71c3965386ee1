// SPDX-License-Identifier: MIT
// Light and colour of what is linear, as eyes see them.

/** The light of a linear colour. */
export const luma = (c) => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];

/** CIELAB (D65) of a linear colour. */
export function lab([r, g, b]) {
  const f = (t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116);
  const [x, y, z] = [
    f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505),
    f(0.2126 * r + 0.7152 * g + 0.0722 * b),
    f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089),
  ];
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/** The linear colour of CIELAB, without negative light. */
export function unlab([l, a, b]) {
  const fy = (l + 16) / 116;
  const back = (t) => (t ** 3 > 0.008856 ? t ** 3 : (t - 16 / 116) / 7.787);
  const [x, y, z] = [0.9505 * back(fy + a / 500), back(fy), 1.089 * back(fy - b / 200)];
  return [3.2405 * x - 1.5372 * y - 0.4985 * z, -0.9693 * x + 1.876 * y + 0.0416 * z, 0.0556 * x - 0.204 * y + 1.0573 * z]
    .map((value) => Math.max(0, value));
}
