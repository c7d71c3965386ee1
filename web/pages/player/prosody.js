// SPDX-License-Identifier: MIT
// Pitch and intensity of a sound over time. No page needed: tests/web reads this.
const RATE = 8000; // at which pitch is looked for, Hz
const WINDOW = 0.04; // seconds: two periods of the lowest pitch and more
const HOP = 0.01;
const COLUMNS = 2000; // at most; longer sounds have a longer hop
const [LOWEST, HIGHEST] = [60, 500]; // Hz
const VOICED = 0.5; // normalised autocorrelation of a voiced window
const SILENT_DB = -50; // below that there is no pitch

/** Averages samples to about RATE. */
function slower(samples, rate) {
  const step = Math.max(1, Math.floor(rate / RATE));
  const out = new Float32Array(Math.floor(samples.length / step));
  for (let i = 0; i < out.length; i++) {
    for (let k = 0; k < step; k++) out[i] += samples[i * step + k] / step;
  }
  return { samples: out, rate: rate / step };
}

/** Returns the similarity of the window with itself `lag` later, -1 to 1. */
function alike(x, from, size, lag) {
  let [product, first, second] = [0, 0, 0];
  for (let i = from; i < from + size - lag; i++) {
    product += x[i] * x[i + lag];
    first += x[i] * x[i];
    second += x[i + lag] * x[i + lag];
  }
  return product / Math.sqrt(first * second + 1e-12);
}

/** Returns the pitch of a window in Hz, or null: the shortest lag that is nearly as good as the best. */
function pitchOf(x, from, size, rate) {
  const [least, most] = [Math.floor(rate / HIGHEST), Math.min(Math.ceil(rate / LOWEST), Math.floor(size * 0.8))];
  const values = [];
  for (let lag = least - 1; lag <= most + 1; lag++) values.push(alike(x, from, size, lag));
  const best = Math.max(...values.slice(1, -1));
  if (best < VOICED) return null;
  for (let i = 1; i < values.length - 1; i++) {
    const [before, here, after] = [values[i - 1], values[i], values[i + 1]];
    if (here < best * 0.9 || here < before || here < after) continue;
    const bend = before - 2 * here + after; // of a parabola through the three
    return rate / (least - 1 + i + (bend ? (0.5 * (before - after)) / bend : 0));
  }
  return null;
}

/**
 * Pitch by normalised autocorrelation, intensity as the level of a window.
 * @param {Float32Array} samples @param {number} rate
 * @returns {{times: number[], pitch: (number|null)[], intensity: number[]}} seconds; Hz; dB of full scale, from -80
 */
export function prosody(samples, rate) {
  const low = slower(samples, rate);
  const size = Math.round(WINDOW * low.rate);
  const hop = Math.max(Math.round(HOP * low.rate), Math.ceil(low.samples.length / COLUMNS));
  const [times, pitch, intensity] = [[], [], []];
  for (let from = 0; from + size <= low.samples.length; from += hop) {
    let power = 0;
    for (let i = from; i < from + size; i++) power += low.samples[i] ** 2;
    const level = Math.max(-80, 10 * Math.log10(power / size + 1e-12));
    times.push((from + size / 2) / low.rate);
    intensity.push(level);
    pitch.push(level < SILENT_DB ? null : pitchOf(low.samples, from, size, low.rate));
  }
  return { times, pitch, intensity };
}
