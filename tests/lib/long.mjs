// SPDX-License-Identifier: GPL-3.0-or-later
// Cases that are too slow for every run. `sh tests/run.sh long` runs the files that import this, with all cases.
/** True when all cases must run. */
export const long = Boolean(process.env.FACCIA_LONG);

/** The options of a test that is one of the further cases: test('name', further, () => …). */
export const further = { skip: !long && 'a further case: sh tests/run.sh long' };

/** @template T @param {T[]} each each time @param {T[]} more and when all are wanted @returns {T[]} */
export const cases = (each, more) => (long ? [...each, ...more] : each);
