// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Processes curves over time: fills gaps, smooths, makes them relative to rest, and writes them for `faccia fit`. A row is
 * {time, values (a number for each parameter, NaN if it is not known; or null), confidence (0 to 1), seen (a boolean for each; left out: all are)}.
 */
import { FURTHER, PARAMETERS } from './articulation.mjs';

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
  return { rows: fillEach(out), gaps };
}

/** Replaces each parameter that a row lacks by the line between its neighbours; beyond the first and last known, by those. */
function fillEach(rows) {
  const filled = rows.map((row) => ({ ...row, values: [...row.values] }));
  for (let p = 0; p < (rows[0]?.values.length ?? 0); p++) {
    let before = null; // the last row that knows it
    for (let i = 0; i < rows.length; i++) {
      if (!Number.isNaN(rows[i].values[p])) {
        before = rows[i];
        continue;
      }
      let end = i;
      while (end < rows.length && Number.isNaN(rows[end].values[p])) end++;
      const after = rows[end] ?? before;
      const from = before ?? after;
      for (; i < end; i++) {
        const share = from && after.time > from.time ? (rows[i].time - from.time) / (after.time - from.time) : 0;
        filled[i].values[p] = from ? from.values[p] + share * (after.values[p] - from.values[p]) : 0;
      }
      before = rows[i] ?? before;
    }
  }
  return filled;
}

/** Smooths by a Gaussian with that standard deviation in s; the window is symmetric, so it shrinks at the ends. */
export function smoothed(rows, deviation) {
  if (!(deviation > 0)) return rows;
  let first = 0;
  return rows.map((row, i) => {
    const reach = Math.min(3 * deviation, row.time - rows[0].time, rows.at(-1).time - row.time) + 1e-9;
    while (rows[first].time < row.time - 3 * deviation) first++;
    const sum = new Float64Array(row.values.length);
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
  const level = rows[0]?.values.map((_, p) => {
    const known = still.filter(({ seen }) => !seen || seen[p]);
    const list = known.length ? known : still;
    return list.reduce((sum, { values }) => sum + values[p], 0) / list.length;
  });
  return still.length ? rows.map((row) => ({ ...row, values: row.values.map((x, p) => x - level[p]) })) : null;
}

/** mm/s: the slope between the rows before and after. */
const velocity = (rows, i, p) => {
  const [a, b] = [rows[Math.max(0, i - 1)], rows[Math.min(rows.length - 1, i + 1)]];
  return b.time > a.time ? (b.values[p] - a.values[p]) / (b.time - a.time) : 0;
};

/** @param {boolean} [further] also the thesis's other four parameters, if known, and the velocity of each @returns {string} */
export function toCsv(rows, further = false) {
  const names = [...PARAMETERS, ...(further && rows[0].values.length > PARAMETERS.length ? FURTHER : [])];
  const each = rows.some(({ seen }) => seen) ? names.map((name) => `${name}_confidence`) : [];
  const speeds = further ? names.map((name) => `${name}_velocity`) : [];
  const lines = rows.map(({ time, values, confidence, seen }, i) => {
    const own = each.map((_, p) => (seen?.[p] ? confidence : 0));
    const mm = [...names.map((_, p) => values[p]), ...speeds.map((_, p) => velocity(rows, i, p))];
    const shares = [confidence, ...own].map((x) => x.toFixed(2));
    return [time.toFixed(4), ...mm.slice(0, names.length).map((x) => x.toFixed(3)), ...shares, ...mm.slice(names.length).map((x) => x.toFixed(2))].join(',');
  });
  return `${['time', ...names, 'confidence', ...each, ...speeds].join(',')}\n${lines.join('\n')}\n`;
}
