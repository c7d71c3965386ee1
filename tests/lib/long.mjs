// SPDX-License-Identifier: GPL-3.0-or-later
// Cases that are too slow for every run. `sh tests/run.sh long` runs the files that import this, with all cases.
/** True when all cases must run. */
export const long = Boolean(process.env.FACCIA_LONG);

/** @template T @param {T[]} each cases of every run @param {T[]} more further cases for long runs @returns {T[]} */
export const cases = (each, more) => (long ? [...each, ...more] : each);
