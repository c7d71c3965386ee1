// SPDX-License-Identifier: GPL-3.0-or-later
// Compares a sound with a faster or slower version: pitch must be equal and events on time.

const middle = (list) => list.toSorted((a, b) => a - b)[list.length >> 1];

/** Pitch in Hz at that time by autocorrelation (the first peak nearly as high as the highest), or null. */
export function pitchAt({ pcm, rate }, seconds) {
  const least = Math.floor(rate / 400), most = Math.ceil(rate / 65), size = 2 * most, from = Math.round(seconds * rate) - most;
  if (from < 0 || from + size + most >= pcm.length) return null;
  const likeness = Array.from({ length: most + 2 }, (_, lag) => {
    let [both, here, there] = [0, 0, 0];
    for (let i = from; lag >= least - 1 && i < from + size; i++) {
      both += pcm[i] * pcm[i + lag];
      here += pcm[i] ** 2;
      there += pcm[i + lag] ** 2;
    }
    return both / Math.sqrt(here * there + 1);
  });
  const best = Math.max(...likeness.slice(least));
  const lag = likeness.findIndex((x, k) => k >= least && x > 0.9 * best && x >= likeness[k - 1] && x >= (likeness[k + 1] ?? 0));
  if (best < 0.85 || lag < 0) return null;
  const [a, b, c] = [likeness[lag - 1], likeness[lag], likeness[lag + 1] ?? 0]; // parabolic interpolation
  return rate / (lag + (a - c) / (2 * (a - 2 * b + c) || 1));
}

const HOP = 0.005;
const loudness = ({ pcm, rate }, speed) => {
  const length = Math.round((0.01 * rate) / speed);
  return Array.from({ length: Math.floor((pcm.length / rate) * speed / HOP) }, (_, k) => {
    let sum = 10;
    for (let i = Math.round((k * HOP * rate) / speed), end = Math.min(pcm.length, i + length); i < end; i++) sum += pcm[i] ** 2 / length;
    return Math.log(sum);
  });
};

/** Time error of the 0.8 s from there on, in s of the original, by correlation of loudness. */
function lagAt(was, is, from) {
  const size = 160, reach = 20;
  const score = (lag) => {
    let [both, a, b] = [0, 0, 0];
    const mean = (list, at) => list.slice(at, at + size).reduce((sum, x) => sum + x, 0) / size;
    const [first, second] = [mean(was, from), mean(is, from + lag)];
    for (let i = 0; i < size; i++) {
      const [x, y] = [was[from + i] - first, (is[from + lag + i] ?? 0) - second];
      both += x * y;
      a += x * x;
      b += y * y;
    }
    return both / Math.sqrt(a * b + 1e-9);
  };
  const lags = Array.from({ length: 2 * reach + 1 }, (_, i) => i - reach);
  return HOP * lags.reduce((best, lag) => (score(lag) > score(best) ? lag : best), 0);
}

/**
 * @param {{pcm, rate}} was @param {{pcm, rate}} is the same at `speed`
 * @returns {{pitch: number, pitches: number, lag: number, most: number, duration: number}} pitch: median relative error over `pitches` places; lag,
 * most: median and maximum time error, s of the original; duration: ratio to the expected one
 */
export function compareTempo(was, is, speed) {
  const seconds = was.pcm.length / was.rate;
  const pitches = [];
  for (let at = 0.1; at < seconds - 0.1; at += 0.05) {
    const [before, after] = [pitchAt(was, at), pitchAt(is, at / speed)];
    if (before && after) pitches.push(after / before - 1);
  }
  const [a, b] = [loudness(was, 1), loudness(is, speed)], lags = [];
  for (let from = 20; from + 200 < a.length; from += 80) lags.push(Math.abs(lagAt(a, b, from)));
  return {
    pitch: middle(pitches), pitches: pitches.length, lag: middle(lags), most: Math.max(...lags), duration: (is.pcm.length / is.rate) * speed / seconds,
  };
}
