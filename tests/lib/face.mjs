// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the frames of a stream on one timeline, the idle clock.

/** FAPs by what they move. Lids and eyes are not listed, because blinks and saccades may be arbitrarily fast. */
export const HEAD = [48, 49, 50];
export const BROWS = [31, 32, 33, 34, 35, 36, 37, 38];
export const MOUTH = [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 16, 17, 18, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60];
export const CHEEKS = [39, 40, 41, 42];

/**
 * Returns the frames that a listener displays: those of an utterance while it lasts, otherwise idle ones.
 * @returns {{time: number, utterance: number, values: Int32Array}[]} sorted by time
 */
export function timeline({ chunks, messages }) {
  const spoken = messages
    .filter((m) => m.type === 'begin' && m.idle !== undefined)
    .map((begin) => {
      const end = messages.find((m) => m.type === 'end' && m.utterance === begin.utterance);
      return { utterance: begin.utterance, from: begin.idle, to: begin.idle + (end?.duration ?? Infinity) };
    });
  const frames = chunks.flatMap((chunk) => {
    const from = spoken.find((s) => s.utterance === chunk.utterance)?.from ?? 0;
    return chunk.frames.map((values, i) => ({
      time: from + (chunk.firstFrame + i) / chunk.fps,
      utterance: chunk.utterance,
      values,
    }));
  });
  const replaced = ({ utterance, time }) => !utterance && spoken.some((s) => time >= s.from && time < s.to - 1e-9);
  return frames.filter((frame) => !replaced(frame)).sort((a, b) => a.time - b.time);
}

/** Largest change of any of the FAPs per 40 ms between consecutive frames that satisfy `of(before, after)`. */
export function largestStep(frames, faps, of = () => true) {
  let largest = { step: 0 };
  for (let i = 1; i < frames.length; i++) {
    const [before, after] = [frames[i - 1], frames[i]];
    const share = Math.max(1, (after.time - before.time) / 0.04);
    if (of(before, after))
      for (const fap of faps) {
        const step = Math.abs(after.values[fap] - before.values[fap]) / share;
        if (step > largest.step) largest = { step, fap, time: after.time, from: before.utterance, to: after.utterance };
      }
  }
  return largest;
}
