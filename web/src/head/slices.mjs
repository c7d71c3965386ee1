// SPDX-License-Identifier: MIT
// Long work, a slice at a time, while the page lives on.

const SLICE_MS = 12;

export const breath = () => new Promise((resolve) => setTimeout(resolve));

/**
 * Goes through a generator a slice at a time.
 * @param {() => boolean} [over] whether nobody wants it any more @returns {Promise<any>} what it returns; null: it is over
 */
export async function sliced(work, over) {
  for (let result = { done: false }, start = performance.now(); ; result = work.next()) {
    if (result.done) return result.value;
    if (over?.()) return null;
    if (performance.now() - start < SLICE_MS) continue;
    await breath();
    start = performance.now();
  }
}
