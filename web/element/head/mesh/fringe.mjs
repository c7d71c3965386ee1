// SPDX-License-Identifier: MIT

const STEPS = 6; // along each side of a triangle, at which its alpha is looked at
const [CLEAR, FULL] = [10, 240]; // of 255: what is all below or all above has no soft end

/**
 * Which triangles end softly: hair is drawn as if it were opaque, and then its ends over what has been drawn.
 * @param {Uint16Array} index @param {Float32Array} uv of each vertex @param {(u: number, v: number) => number} alpha 0 to 255
 * @returns {{index: Uint16Array, before: (count: number) => number}} those, in their order; before: how many numbers of theirs
 *   there are among the first so many of all
 */
export function fringeOf(index, uv, alpha) {
  const kept = [];
  const places = [];
  for (let i = 0; i < index.length; i += 3) {
    const corners = [0, 1, 2].map((k) => [uv[2 * index[i + k]], uv[2 * index[i + k] + 1]]);
    if (!soft(corners, alpha)) continue;
    kept.push(index[i], index[i + 1], index[i + 2]);
    places.push(i);
  }
  return { index: Uint16Array.from(kept), before: (count) => 3 * places.filter((place) => place < count).length };
}

function soft([a, b, c], alpha) {
  let [clear, full] = [true, true];
  for (let i = 0; i <= STEPS; i++)
    for (let j = 0; i + j <= STEPS; j++) {
      const [s, t] = [i / STEPS, j / STEPS];
      const [u, v] = [0, 1].map((k) => a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
      const found = alpha(u, v);
      clear &&= found < CLEAR;
      full &&= found > FULL;
      if (!clear && !full) return true;
    }
  return false;
}
