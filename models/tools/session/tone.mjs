// SPDX-License-Identifier: GPL-3.0-or-later
/** Finds the synchronisation tone at the beginning of a recording. */

const HZ = 1000;
const WINDOW = 0.02; // s
const SHARE = 0.7; // of the energy of a window
const LEAST = 0.3; // s of tone

/** Energy of a window at one frequency, as a share of all (G. Goertzel, 1958). */
function shareAt(samples, from, count, hz, rate) {
  const k = 2 * Math.cos((2 * Math.PI * hz) / rate);
  let a = 0;
  let b = 0;
  let all = 0;
  for (let i = from; i < from + count; i++) {
    [a, b] = [samples[i] + k * a - b, a];
    all += samples[i] * samples[i];
  }
  return all > 0 ? (2 * (a * a + b * b - k * a * b)) / (count * all) : 0;
}

/**
 * @param {Int16Array} samples @param {number} rate Hz @param {number} within s, where the tone must begin
 * @returns {{from: number, to: number} | null} seconds
 */
export function findTone(samples, rate, within = 3) {
  const count = Math.round(WINDOW * rate);
  const hop = count >> 1;
  let from = -1;
  for (let at = 0; at + count <= samples.length; at += hop) {
    const heard = shareAt(samples, at, count, HZ, rate) > SHARE;
    if (heard && from < 0) from = at;
    if (!heard && from >= 0) {
      if (at - from >= LEAST * rate) return { from: from / rate, to: (at + hop) / rate };
      from = -1;
    }
    if (from < 0 && at > within * rate) break;
  }
  return null;
}
