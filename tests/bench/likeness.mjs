// SPDX-License-Identifier: GPL-3.0-or-later
// Perceptual similarity of two sounds: compares auditory spectrograms (bands of one ERB, Glasberg and Moore 1990; 40 ms every 10 ms, in dB,
// clipped far below the loudest band of the moment) over neighbouring times and bands, as ViSQOL does (Hines et al. 2015): NSIM, 1 for
// identical sounds. Not a substitute for listening tests; sound.mjs shows its values for known distortions.

const RATE = 48000;
const WINDOW = 1920;
const SIZE = 2048;
const HOP = 480;
const DEEP = 45; // dB below the loudest band of a moment: masked
const SILENT = 70; // dB below the overall maximum

/** In-place FFT of SIZE real samples: real and imaginary parts. */
function transform(re, im) {
  for (let i = 1, j = 0; i < SIZE; i++) {
    let bit = SIZE >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) [re[i], re[j]] = [re[j], re[i]];
  }
  for (let size = 2; size <= SIZE; size *= 2)
    for (let k = 0; k < size / 2; k++) {
      const [c, s] = [Math.cos((2 * Math.PI * k) / size), -Math.sin((2 * Math.PI * k) / size)];
      for (let i = k; i < SIZE; i += size) {
        const o = i + size / 2;
        const [x, y] = [re[o] * c - im[o] * s, re[o] * s + im[o] * c];
        [re[o], im[o]] = [re[i] - x, im[i] - y];
        re[i] += x;
        im[i] += y;
      }
    }
}

const erbOf = (hertz) => 21.4 * Math.log10(1 + 0.00437 * hertz);

/** Half-overlapping triangular bands of one ERB up to a frequency: first bin and weights of each. */
function bands(top) {
  const count = Math.floor(erbOf(top) - erbOf(50));
  return Array.from({ length: count }, (_, b) => {
    const centre = erbOf(50) + b + 0.5;
    const weights = [];
    let first = -1;
    for (let bin = 1; bin < SIZE / 2; bin++) {
      const weight = 1 - Math.abs(erbOf((bin * RATE) / SIZE) - centre);
      if (weight <= 0) continue;
      if (first < 0) first = bin;
      weights.push(weight);
    }
    return { first, weights };
  }).filter(({ first }) => first > 0);
}

/** @param {Float64Array} sound at 48 kHz @returns {Float64Array[]} dB by moment and band */
function spectrogram(sound, list) {
  const rows = [];
  const [re, im] = [new Float64Array(SIZE), new Float64Array(SIZE)];
  for (let at = 0; at + WINDOW <= sound.length; at += HOP) {
    im.fill(0);
    re.fill(0);
    for (let i = 0; i < WINDOW; i++) re[i] = sound[at + i] * (0.5 - 0.5 * Math.cos((2 * Math.PI * i) / WINDOW));
    transform(re, im);
    rows.push(Float64Array.from(list, ({ first, weights }) => 10 * Math.log10(1e-12 + weights.reduce((sum, w, i) =>
      sum + w * (re[first + i] ** 2 + im[first + i] ** 2), 0))));
  }
  return rows;
}

const SMOOTH = [0.0113, 0.0838, 0.0113, 0.0838, 0.6193, 0.0838, 0.0113, 0.0838, 0.0113]; // 3 x 3 Gaussian

/**
 * @param {Float64Array} original @param {Float64Array} coded at 48 kHz, in step
 * @param {number} top Hz: ignores higher frequencies
 * @returns {{nsim: number, off: number}} nsim: similarity, 0 to 1; off: mean difference of audible bands, dB
 */
export function likeness(original, coded, top = 11000) {
  const list = bands(top);
  const [a, b] = [original, coded].map((sound) => spectrogram(sound, list));
  const count = Math.min(a.length, b.length);
  const loudest = a.reduce((most, row) => Math.max(most, ...row), -Infinity);
  const heard = [];
  for (let t = 0; t < count; t++) {
    const peak = Math.max(...a[t]);
    const floor = Math.max(peak - DEEP, loudest - SILENT);
    heard.push(peak > loudest - SILENT);
    // relative to the masking threshold; 0 = inaudible
    for (const row of [a[t], b[t]]) for (let i = 0; i < row.length; i++) row[i] = Math.max(0, row[i] - floor);
  }
  const range = DEEP;
  const [c1, c3] = [(0.01 * range) ** 2, (0.03 * range) ** 2 / 2];
  let [sum, cells, off, offCells] = [0, 0, 0, 0];
  for (let t = 1; t + 1 < count; t++) {
    if (!heard[t]) continue;
    for (let i = 1; i + 1 < list.length; i++) {
      let [ma, mb, aa, bb, ab] = [0, 0, 0, 0, 0];
      for (let k = 0; k < 9; k++) {
        const [x, y] = [a[t - 1 + Math.floor(k / 3)][i - 1 + (k % 3)], b[t - 1 + Math.floor(k / 3)][i - 1 + (k % 3)]];
        ma += SMOOTH[k] * x;
        mb += SMOOTH[k] * y;
        aa += SMOOTH[k] * x * x;
        bb += SMOOTH[k] * y * y;
        ab += SMOOTH[k] * x * y;
      }
      const [sa, sb] = [Math.sqrt(Math.max(0, aa - ma * ma)), Math.sqrt(Math.max(0, bb - mb * mb))];
      sum += ((2 * ma * mb + c1) / (ma * ma + mb * mb + c1)) * ((ab - ma * mb + c3) / (sa * sb + c3));
      cells++;
      if (!a[t][i] && !b[t][i]) continue;
      off += Math.abs(a[t][i] - b[t][i]);
      offCells++;
    }
  }
  return { nsim: sum / cells, off: off / offCells };
}
