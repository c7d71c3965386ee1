// SPDX-License-Identifier: MIT
/** Looking at a picture more than once: the detector trembles by half a mm, each time in its own way. */

const LOOKS = [[0.03, -0.03, 0.96], [-0.03, 0.03, 1.05]]; // beside and larger, in parts of the face

/** @param {ArrayLike<number>[]} lists as many numbers in each @returns {number[]} */
const mean = (lists) => Array.from(lists[0], (_, i) => lists.reduce((sum, list) => sum + list[i], 0) / lists.length);

/** The box around a face. @param {number[][]} landmarks @returns {number[]} left, top, width, height */
export const boxOf = (landmarks) => {
  const [xs, ys] = [0, 1].map((k) => landmarks.map((p) => p[k]));
  const [x, y] = [Math.min(...xs), Math.min(...ys)];
  return [x, y, Math.max(...xs) - x, Math.max(...ys) - y];
};

/** The mean of several looks at one picture. @returns {Promise<number[][]>} landmarks */
export async function landmarksOf(eye, picture) {
  const first = await eye(picture);
  const [x, y, w, h] = boxOf(first);
  const looks = [first];
  for (const [right, down, size] of LOOKS)
    looks.push((await eye.closeUp(picture, [x + w / 2 + right * w - (w * size) / 2, y + h / 2 + down * h - (h * size) / 2,
      w * size, h * size])).landmarks);
  return first.map((_, i) => mean(looks.map((look) => look[i])));
}
