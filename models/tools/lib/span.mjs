// SPDX-License-Identifier: GPL-3.0-or-later
/** The texels of a row that may lie in a triangle, for drawing without a graphics processor. */

/**
 * Most of the box about a thin triangle lies outside it. Narrows row.from..row.to, whole numbers, to where no weight of a corner is negative, and
 * a texel more on both sides, since rounding differs.
 * @param {{from: number, to: number}} row changed in place @param {number} wa, wb, wc the weights at row.from @param {number} stepA, stepB, stepC
 *   how much each grows from texel to texel
 */
export function narrow(row, wa, stepA, wb, stepB, wc, stepC) {
  const { from } = row;
  cut(row, from, wa, stepA);
  cut(row, from, wb, stepB);
  cut(row, from, wc, stepC);
}

function cut(row, from, weight, step) {
  if (step > 0) row.from = Math.max(row.from, Math.floor(from - weight / step) - 1);
  else if (step < 0) row.to = Math.min(row.to, Math.ceil(from - weight / step) + 1);
}
