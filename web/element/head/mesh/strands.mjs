// SPDX-License-Identifier: MIT

/**
 * Finds the vertices of loose strands, which look like dots at a distance.
 * @param {{index: Uint16Array, position: Float32Array, vertices: number}} part
 * @param {number} mm upper limit of their mean width
 * @returns {Uint8Array} by vertex
 */
export function strands({ index, position, vertices }, mm) {
  const next = Uint32Array.from({ length: vertices }, (_, v) => v);
  const root = (v) => {
    while (next[v] !== v) v = next[v] = next[next[v]];
    return v;
  };
  for (let i = 0; i < index.length; i += 3)
    for (const k of [1, 2]) next[root(index[i + k])] = root(index[i]);
  const area = new Float64Array(vertices);
  for (let i = 0; i < index.length; i += 3) area[root(index[i])] += areaOf(position, index.subarray(i, i + 3));
  const length = lengths(position, vertices, root);
  return Uint8Array.from({ length: vertices }, (_, v) => (area[root(v)] < mm * length[root(v)] ? 1 : 0));
}

function areaOf(position, [a, b, c]) {
  const [[x, y, z], [u, v, w]] = [b, c].map((one) => [0, 1, 2].map((k) => position[3 * one + k] - position[3 * a + k]));
  return Math.hypot(y * w - z * v, z * u - x * w, x * v - y * u) / 2;
}

/** Returns the length of each connected piece: the diagonal of its bounding box. */
function lengths(position, vertices, root) {
  const least = new Float32Array(3 * vertices).fill(Infinity);
  const most = new Float32Array(3 * vertices).fill(-Infinity);
  for (let v = 0; v < vertices; v++)
    for (let k = 0, at = 3 * root(v); k < 3; k++) {
      least[at + k] = Math.min(least[at + k], position[3 * v + k]);
      most[at + k] = Math.max(most[at + k], position[3 * v + k]);
    }
  const diagonal = (v) => Math.hypot(...[0, 1, 2].map((k) => most[3 * v + k] - least[3 * v + k]));
  return Float64Array.from({ length: vertices }, (_, v) => diagonal(v));
}
