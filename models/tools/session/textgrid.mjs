// SPDX-License-Identifier: GPL-3.0-or-later
/** Writes tiers of intervals as PRAAT's TextGrid. */

const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;

/** @param {number} seconds @param {{name: string, intervals: {start: number, end: number, text: string}[]}[]} tiers gaps become empty intervals */
export function toTextGrid(seconds, tiers) {
  const lines = ['File type = "ooTextFile"', 'Object class = "TextGrid"', '', 'xmin = 0', `xmax = ${seconds}`, 'tiers? <exists>', `size = ${tiers.length}`, 'item []:'];
  for (const [t, { name, intervals }] of tiers.entries()) {
    const all = [];
    let at = 0;
    for (const one of intervals) {
      if (one.start > at + 1e-6) all.push({ start: at, end: one.start, text: '' });
      all.push(one);
      at = one.end;
    }
    if (at < seconds - 1e-6) all.push({ start: at, end: seconds, text: '' });
    lines.push(`    item [${t + 1}]:`, '        class = "IntervalTier"', `        name = ${quoted(name)}`, '        xmin = 0', `        xmax = ${seconds}`, `        intervals: size = ${all.length}`);
    for (const [i, { start, end, text }] of all.entries())
      lines.push(`        intervals [${i + 1}]:`, `            xmin = ${start}`, `            xmax = ${end}`, `            text = ${quoted(text)}`);
  }
  return `${lines.join('\n')}\n`;
}
