// SPDX-License-Identifier: GPL-3.0-or-later
// Acoustic measures of a voice: periods, H1-H2, harmonicity, jitter, shimmer, slope of the spectrum, loudness.
import fs from 'node:fs';

/** Reads a 16-bit mono WAV. @returns {{rate: number, samples: Float64Array}} -1..1 */
export function readWav(file) {
  const bytes = fs.readFileSync(file);
  let at = 12, rate = 0;
  while (at + 8 <= bytes.length) {
    const name = bytes.toString('latin1', at, at + 4), size = bytes.readUInt32LE(at + 4);
    if (name === 'fmt ') rate = bytes.readUInt32LE(at + 12);
    if (name === 'data') {
      const count = Math.min(size, bytes.length - at - 8) >> 1;
      return { rate, samples: Float64Array.from({ length: count }, (_, i) => bytes.readInt16LE(at + 8 + 2 * i) / 32768) };
    }
    at += 8 + size + (size & 1);
  }
  throw new Error(`${file} has no samples`);
}

const rms = (x) => Math.sqrt(x.reduce((sum, v) => sum + v * v, 0) / Math.max(1, x.length));
const mean = (list) => list.reduce((sum, v) => sum + v, 0) / list.length; // NaN of nothing
export const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

/** Amplitude at a frequency (Hann window), from a projection on sine and cosine. */
function amplitude(x, from, count, hz, rate) {
  let re = 0, im = 0;
  for (let i = 0; i < count; i++) {
    const w = (0.5 - 0.5 * Math.cos((2 * Math.PI * i) / count)) * x[from + i], t = (2 * Math.PI * hz * i) / rate;
    re += w * Math.cos(t);
    im += w * Math.sin(t);
  }
  return (4 * Math.hypot(re, im)) / count;
}

/** Normalised correlation of a stretch with itself one lag later. */
function correlation(x, from, count, lag) {
  let ab = 0, aa = 0, bb = 0;
  for (let i = 0; i < count; i++) {
    const a = x[from + i], b = x[from + i + lag];
    ab += a * b;
    aa += a * a;
    bb += b * b;
  }
  return aa && bb ? ab / Math.sqrt(aa * bb) : 0;
}

/** Period in samples around `from` by correlation, refined by a parabola, and its correlation. */
function period(x, from, rate, low, high) {
  const count = Math.round(0.03 * rate), at = [];
  let best = 0;
  for (let lag = Math.floor(rate / high) - 1; lag <= rate / low + 1; lag++) best = Math.max(best, (at[lag] = correlation(x, from, count, lag)));
  const lag = at.findIndex((r, i) => r >= 0.93 * best && r >= (at[i - 1] ?? 1) && r >= (at[i + 1] ?? 1));
  if (lag < 0) return { period: 0, r: 0 };
  const bend = at[lag - 1] - 2 * at[lag] + at[lag + 1], peak = lag + (at[lag - 1] - at[lag + 1]) / 2 / bend;
  return { period: peak, r: at[lag] - (at[lag - 1] - at[lag + 1]) ** 2 / 8 / bend };
}

/** Instants of successive periods from `from` to `to`: each next one where the waveform around it is most alike (as in PRAAT's cross-correlation method). */
function pulses(x, from, to, p) {
  const half = Math.round(p * 0.5), list = [from];
  for (let at = from; at + 2 * p + half + 2 < to;) {
    const r = [];
    let best = 0;
    for (let lag = Math.round(0.8 * p); lag <= Math.round(1.25 * p); lag++) {
      r[lag] = correlation(x, Math.max(0, Math.round(at) - half), 2 * half, lag);
      if (!best || r[lag] > r[best]) best = lag;
    }
    const bend = (r[best - 1] ?? 0) - 2 * r[best] + (r[best + 1] ?? 0), shift = bend < 0 ? ((r[best - 1] ?? 0) - (r[best + 1] ?? 0)) / 2 / bend : 0;
    at = Math.round(at) + best + Math.max(-1, Math.min(1, shift));
    list.push(at);
  }
  return list;
}

/**
 * Measures the voiced parts of a sound.
 * @returns {{f0, h1h2, hnr, jitter, shimmer, slope, rms, peak, voiced}} Hz, dB, dB, share, dB, dB per octave from 300 Hz to 5 kHz, of full scale, share
 */
export function measureVoice({ rate, samples: x }, { low = 70, high = 400 } = {}) {
  const hop = Math.round(0.01 * rate), window = Math.round(0.03 * rate), loud = rms(x) * 0.4;
  const frames = [], runs = [];
  for (let at = 0; at + 2 * window + rate / low < x.length; at += hop) {
    const level = rms(x.subarray(at, at + window)), found = level > loud ? period(x, at, rate, low, high) : { period: 0, r: 0 };
    const voiced = found.r > 0.6 && found.period > 0;
    frames.push({ at, voiced, ...found });
    if (voiced && runs.length && frames.at(-2)?.voiced && Math.abs(found.period / frames.at(-2).period - 1) < 0.1) runs.at(-1).push(frames.at(-1));
    else if (voiced) runs.push([frames.at(-1)]);
  }
  const good = frames.filter((f) => f.voiced), h1h2 = [], jitter = [], shimmer = [];
  for (const { at, period: p } of good) {
    const hz = rate / p, count = Math.round(3 * p);
    h1h2.push(20 * Math.log10(amplitude(x, at, count, hz, rate) / amplitude(x, at, count, 2 * hz, rate)));
  }
  for (const run of runs.filter((r) => r.length >= 5)) {
    const p = median(run.map((f) => f.period)), marks = pulses(x, run[0].at, run.at(-1).at + window, p);
    const steps = marks.slice(1).map((m, i) => m - marks[i]), peaks = marks.slice(0, -1).map((m) => {
      let peak = 0;
      for (let i = 0; i < p; i++) peak = Math.max(peak, Math.abs(x[Math.round(m) + i] ?? 0));
      return peak;
    });
    /* differences of second order leave out intonation */
    for (let i = 2; i < steps.length; i++) jitter.push(Math.abs(steps[i] - 2 * steps[i - 1] + steps[i - 2]) / 2 / p);
    for (let i = 2; i < peaks.length; i++) if (peaks[i] * peaks[i - 1] * peaks[i - 2] > 0) shimmer.push(Math.abs(20 * Math.log10((peaks[i] * peaks[i - 2]) / peaks[i - 1] ** 2)) / 2);
  }
  const bands = [300, 600, 1200, 2400, 4800].filter((hz) => hz < 0.45 * rate).map((hz) => {
    const sum = good.map(({ at }) => [0.8, 0.9, 1, 1.1, 1.2].reduce((s, k) => s + amplitude(x, at, window, hz * k, rate) ** 2, 0));
    return 10 * Math.log10(mean(sum));
  });
  const middle = (bands.length - 1) / 2;
  const slope = bands.reduce((s, v, i) => s + v * (i - middle), 0) / bands.reduce((s, _, i) => s + (i - middle) ** 2, 0);
  return {
    f0: median(good.map((f) => rate / f.period)) ?? NaN, h1h2: mean(h1h2), slope,
    hnr: mean(good.map(({ r }) => 10 * Math.log10(Math.min(r, 0.99999) / (1 - Math.min(r, 0.99999))))),
    jitter: mean(jitter), shimmer: mean(shimmer), rms: rms(x), peak: Math.max(...x.map(Math.abs)), voiced: good.length / frames.length,
  };
}
