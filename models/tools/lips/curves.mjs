// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Processes six curves over time: fills gaps, smooths, makes them relative to rest, and writes them for `faccia fit`. A row is
 * {time, values (six numbers, or null), confidence (0 to 1), seen (of pictures: six booleans)}.
 */
import { PARAMETERS } from './articulation.mjs';

export const LONGEST_GAP = 0.2; // s: too short for more than one lip movement

/** Interpolates short gaps, with confidence 0. @returns {{rows: object[], gaps: number[][]}} gaps: frames that stay empty */
export function filled(rows) {
  const gaps = [];
  const out = [];
  for (let i = 0; i < rows.length; ) {
    if (rows[i].values) {
      out.push(rows[i++]);
      continue;
    }
    let end = i;
    while (end < rows.length && !rows[end].values) end++;
    const [before, after] = [rows[i - 1], rows[end]];
    if (before && after && after.time - before.time <= LONGEST_GAP)
      for (; i < end; i++) {
        const share = (rows[i].time - before.time) / (after.time - before.time);
        out.push({ ...rows[i], confidence: 0, values: before.values.map((x, p) => x + share * (after.values[p] - x)) });
      }
    else gaps.push([i, end - 1]);
    i = end;
  }
  return { rows: out, gaps };
}

/** Smooths by a Gaussian with that standard deviation in s; the window is symmetric, so it shrinks at the ends. */
export function smoothed(rows, deviation) {
  if (!(deviation > 0)) return rows;
  let first = 0;
  return rows.map((row, i) => {
    const reach = Math.min(3 * deviation, row.time - rows[0].time, rows.at(-1).time - row.time) + 1e-9;
    while (rows[first].time < row.time - 3 * deviation) first++;
    const sum = new Float64Array(PARAMETERS.length);
    let all = 0;
    for (let k = first; k < rows.length && rows[k].time <= row.time + reach; k++) {
      if (rows[k].time < row.time - reach) continue;
      const weight = k === i ? 1 : Math.exp(-0.5 * ((rows[k].time - row.time) / deviation) ** 2);
      all += weight;
      rows[k].values.forEach((x, p) => (sum[p] += weight * x));
    }
    return { ...row, values: Array.from(sum, (x) => x / all) };
  });
}

/** Makes values relative to the mean of the rows in that time. @param {number[]} rest from, to (s) */
export function fromRest(rows, [from, to]) {
  const still = rows.filter(({ time }) => time >= from && time <= to);
  const level = PARAMETERS.map((_, p) => still.reduce((sum, { values }) => sum + values[p], 0) / still.length);
  return still.length ? rows.map((row) => ({ ...row, values: row.values.map((x, p) => x - level[p]) })) : null;
}

/** @returns {string} */
export function toCsv(rows) {
  const each = rows.some(({ seen }) => seen) ? PARAMETERS.map((name) => `${name}_confidence`) : [];
  const lines = rows.map(({ time, values, confidence, seen }) => {
    const own = each.map((_, p) => (seen[p] ? confidence : 0));
    return [time.toFixed(4), ...values.map((x) => x.toFixed(3)), ...[confidence, ...own].map((x) => x.toFixed(2))].join(',');
  });
  return `${['time', ...PARAMETERS, 'confidence', ...each].join(',')}\n${lines.join('\n')}\n`;
}
