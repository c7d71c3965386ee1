// SPDX-License-Identifier: GPL-3.0-or-later
/** Looking at a picture more than once: the detector trembles by half a mm, each time in its own way. */

const LOOKS = [[0.03, -0.03, 0.96], [-0.03, 0.03, 1.05]]; // beside and larger, in parts of the face

/** @param {ArrayLike<number>[]} lists as many numbers in each @returns {number[]} */
export const mean = (lists) => Array.from(lists[0], (_, i) => lists.reduce((sum, list) => sum + list[i], 0) / lists.length);

export const median = (list) => Float64Array.from(list).sort()[list.length >> 1];

export const boxOf = (landmarks) => {
  const [xs, ys] = [0, 1].map((k) => landmarks.map((p) => p[k]));
  const [x, y] = [Math.min(...xs), Math.min(...ys)];
  return [x, y, Math.max(...xs) - x, Math.max(...ys) - y];
};

/** Several looks at one picture; where the face is the picture before tells. @returns {Promise<{looks: number[][][], score: number}>} */
export async function looksAt(eye, picture, before) {
  const first = before ? null : await eye(picture);
  const [x, y, w, h] = before ?? boxOf(first);
  const looks = [];
  let score = 1;
  for (const [right, down, size] of LOOKS) {
    const seen = await eye.closeUp(picture, [x + w / 2 + right * w - (w * size) / 2, y + h / 2 + down * h - (h * size) / 2, w * size, h * size]);
    looks.push(seen.landmarks);
    score = Math.min(score, seen.score);
  }
  return { looks: first ? [first, ...looks] : looks, score };
}
