// SPDX-License-Identifier: GPL-3.0-or-later
/** Vectors of three numbers. */

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** The vector of length 1 in that direction; one without a length stays. */
export const unit = (v) => v.map((x) => x / (Math.hypot(...v) || 1));
/** a + share * b */
export const plus = (a, b, share = 1) => a.map((x, k) => x + share * b[k]);
