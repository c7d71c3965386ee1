// SPDX-License-Identifier: MIT
// The clock of a film.

const STEPS_S = 25; // of breath and hair, at least

/**
 * The moments of a film, from its beginning, whatever is shown of it. Those between pictures that are far apart are for breath
 * and hair, which move on from moment to moment.
 * @param {{start: number, count: number, fps: number}} job start: time of the first picture, seconds; count: of pictures
 * @returns {Generator<{time: number, shown: boolean}>} shown: it is a picture
 */
export function* moments({ start, count, fps }) {
  const steps = Math.max(1, Math.ceil(STEPS_S / fps - 1e-6));
  const of = (from, k) => Array.from({ length: steps }, (_, i) => from + k / fps + i / (fps * steps));
  for (let k = 0; k / fps < start; k++) for (const time of of(0, k)) if (time < start) yield { time, shown: false };
  for (let k = 0; k < count; k++) for (const [i, time] of of(start, k).entries()) yield { time, shown: i === 0 };
}
