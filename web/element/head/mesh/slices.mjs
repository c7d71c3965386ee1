// SPDX-License-Identifier: MIT
// Long work, a slice at a time, while the page lives on.

const SLICE_MS = 12;
const SHARE = 0.4; // of the time that the page takes between two slices, where that is more:
const SLICE_MOST_MS = 160; // without a graphics processor a picture may hold up the page for half a second

export const breath = () => new Promise((resolve) => setTimeout(resolve));

/**
 * Runs a generator in time slices.
 * @param {() => boolean} [over] whether to cancel
 * @param {{now: () => number, rest: () => Promise<void>}} [clock] of tests
 * @returns {Promise<any>} its return value; null: cancelled
 */
export async function sliced(work, over, { now, rest } = { now: () => performance.now(), rest: breath }) {
  let slice = SLICE_MS;
  for (let result = { done: false }, start = now(); ; result = work.next()) {
    if (result.done) return result.value;
    if (over?.()) return null;
    const left = now();
    if (left - start < slice) continue;
    await rest();
    start = now();
    slice = Math.min(SLICE_MOST_MS, Math.max(SLICE_MS, SHARE * (start - left)));
  }
}
