// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of recognised mouth shapes against the phones spoken.

const KINDS = {
  closed: { of: (ipa) => /^[pbm]/.test(ipa), heard: ['closed'] },
  teeth: { of: (ipa) => /^[fv]/.test(ipa), heard: ['teeth'] },
  rounded: { of: (ipa) => /^(t͡ʃ|d͡ʒ|tʃ|dʒ|[ʃʒuwoɔʊ])/.test(ipa), heard: ['rounded', 'middle-round', 'close-round'] },
};
export const kinds = Object.keys(KINDS);
/** The class of a phone as `faccia hear` names it, for the phones covered by KINDS. */
export const classOf = (ipa) => Object.values(KINDS).find((kind) => kind.of(ipa))?.heard[0];

/** Merges adjacent stretches {start, end}. */
function joined(list) {
  const out = [];
  for (const { start, end } of list)
    if (out.length && start - out.at(-1).end < 0.011) out.at(-1).end = end;
    else out.push({ start, end });
  return out;
}

/**
 * Compares one kind of sound: {said, found, shown, wrong}. said: occurrences; found: those recognised within `slack` s; shown: total time displayed during
 * speech without pauses, s; wrong: part of it farther than `slack` from an occurrence. `shift` moves the occurrences, which gives the chance level.
 */
export function compared(kind, phones, heard, { slack = 0.04, shift = 0 } = {}) {
  const speech = phones.filter((p) => p.ipa), pauses = phones.filter((p) => !p.ipa), [from, to] = [speech[0].start, speech.at(-1).end];
  const said = joined(speech.filter((p) => KINDS[kind].of(p.ipa)).map(({ start, end }) => ({ start: start + shift, end: end + shift }))).filter((s) => s.start >= from && s.end <= to + 0.01);
  const seen = joined(heard.filter((p) => KINDS[kind].heard.includes(p.class)));
  let [shown, wrong] = [0, 0];
  for (const { start, end } of seen)
    for (let t = Math.max(from, start); t < Math.min(to, end); t += 0.01) {
      if (pauses.some((p) => t >= p.start && t < p.end)) continue;
      shown += 0.01;
      if (!said.some((s) => t > s.start - slack && t < s.end + slack)) wrong += 0.01;
    }
  return { said: said.length, found: said.filter((s) => seen.some((x) => x.start < s.end + slack && s.start < x.end + slack)).length, shown, wrong };
}

export const added = (a, b) => (a ? Object.fromEntries(Object.keys(b).map((key) => [key, a[key] + b[key]])) : b);

/** Baseline that follows loudness: lips close 20 dB below the recent maximum. Samples -1 to 1. */
export function follower(samples, rate) {
  const hop = rate / 100, out = [];
  let loudest = -60;
  for (let k = 0; (k + 1) * hop <= samples.length; k++) {
    let sum = 1e-9;
    for (let i = Math.round(k * hop); i < Math.round((k + 1) * hop); i++) sum += samples[i] ** 2;
    const level = 10 * Math.log10(sum / hop);
    loudest = Math.max(level, loudest - 0.06);
    if (level < loudest - 20) out.push({ class: 'closed', start: k / 100, end: (k + 1) / 100 });
  }
  return out;
}

/** Adds reproducible white noise at that signal-to-noise ratio in dB. */
export function inNoise(samples, decibels) {
  let seed = 1;
  const random = () => ((seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32) * 2 - 1;
  const power = samples.reduce((sum, x) => sum + x * x, 0) / samples.length;
  const gain = Math.sqrt(3 * power) * 10 ** (-decibels / 20);
  return samples.map((x) => x + gain * random());
}

/** Band-pass 300 to 3400 Hz: two second-order Butterworth sections on each side. */
export function telephone(samples, rate) {
  const pass = (x, hz, high) => {
    const w = Math.tan((Math.PI * Math.min(hz, 0.45 * rate)) / rate), n = 1 / (1 + Math.SQRT2 * w + w * w);
    const [b0, b1] = high ? [n, -2 * n] : [w * w * n, 2 * w * w * n], [a1, a2] = [2 * (w * w - 1) * n, (1 - Math.SQRT2 * w + w * w) * n];
    let [x1, x2, y1, y2] = [0, 0, 0, 0];
    return x.map((v) => {
      const y = b0 * v + b1 * x1 + b0 * x2 - a1 * y1 - a2 * y2;
      [x2, x1, y2, y1] = [x1, v, y1, y];
      return y;
    });
  };
  return [true, true, false, false].reduce((x, high) => pass(x, high ? 300 : 3400, high), samples);
}

/** Pearson's correlation of pairs. */
export function correlation(pairs) {
  const mean = (k) => pairs.reduce((sum, p) => sum + p[k], 0) / pairs.length, [a, b] = [mean(0), mean(1)];
  const product = (i, j) => pairs.reduce((sum, p) => sum + (p[i] - [a, b][i]) * (p[j] - [a, b][j]), 0);
  return product(0, 1) / Math.sqrt(product(0, 0) * product(1, 1));
}
