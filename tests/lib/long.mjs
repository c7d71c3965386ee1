// SPDX-License-Identifier: GPL-3.0-or-later
// Cases that are tried by hand and not each time: `sh tests/run.sh long` runs the files that import this, with all of them.
/** Whether all cases are wanted. */
export const long = Boolean(process.env.FACCIA_LONG);

/** @template T @param {T[]} each each time @param {T[]} more and when all are wanted @returns {T[]} */
export const cases = (each, more) => (long ? [...each, ...more] : each);
