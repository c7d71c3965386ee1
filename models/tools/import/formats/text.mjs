// SPDX-License-Identifier: GPL-3.0-or-later
/** Decodes text files: byte order marks, and lines that end with LF, CRLF or CR. */

/** @param {Buffer} bytes @returns {string} */
export const textOf = (bytes) => bytes.toString('utf8').replace(/^\uFEFF/, '');

/** @param {Buffer} bytes @param {string} [goesOn] continuation mark at the end of a line; the continued line becomes empty */
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
