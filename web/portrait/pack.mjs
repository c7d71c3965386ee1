// SPDX-License-Identifier: MIT
// Numbers into the form of protocol/head-model.md.

export function base64(bytes) {
  let text = '';
  for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  return btoa(text);
}

/** @param {ArrayLike<number>} positions three numbers each, mm @returns {{data: string, scale: number, offset: number[]}} */
export function packPositions(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i++) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  const offset = low.map((value, k) => Math.round(500 * (value + high[k])) / 1000);
  const reach = Math.max(...high.map((value, k) => Math.max(value - offset[k], offset[k] - low[k])));
  const scale = Math.ceil((reach / 32767) * 1e7) / 1e7;
  const numbers = Int16Array.from(positions, (value, i) => Math.round((value - offset[i % 3]) / scale));
  return { data: base64(new Uint8Array(numbers.buffer)), scale, offset };
}

/** @param {number[]} numbers of vertices */
export const packNumbers = (numbers) => base64(new Uint8Array(Uint16Array.from(numbers).buffer));

/** @param {number[]} deltas three numbers each, mm @returns {{data: string, scale: number}} */
export function packVectors(deltas) {
  const reach = deltas.reduce((most, x) => Math.max(most, Math.abs(x)), 1e-6);
  const scale = Math.ceil((reach / 32767) * 1e9) / 1e9;
  return { data: base64(new Uint8Array(Int16Array.from(deltas, (x) => Math.round(x / scale)).buffer)), scale };
}
