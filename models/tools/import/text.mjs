// SPDX-License-Identifier: GPL-3.0-or-later
/** Text as files have it: with a mark of its order before it, and lines that end in each of the three ways. */

/** @param {Buffer} bytes @returns {string} */
export const textOf = (bytes) => bytes.toString('utf8').replace(/^\uFEFF/, '');

/** @param {Buffer} bytes @param {string} [goesOn] what at the end of a line says that the next belongs to it; that next one is then empty */
export function rowsOf(bytes, goesOn) {
  const rows = textOf(bytes).split(/\r\n|\r|\n/);
  if (goesOn)
    for (let i = rows.length - 2; i >= 0; i--)
      if (rows[i].endsWith(goesOn)) {
        rows[i] = `${rows[i].slice(0, -goesOn.length)} ${rows[i + 1]}`;
        rows[i + 1] = '';
      }
  return rows;
}
