// SPDX-License-Identifier: MIT
// Finds the lip seam of a mesh: the only place of a face where two touching points separate when the mouth opens. Connected
// skin moves smoothly, so neighbours that separate by a good share of the opening are the two sides of the seam. Of several
// behind one another (the lips have thickness, teeth and the mouth's lining lie behind), the foremost are visible.

const PARTING = 0.15; // of the opening, between two that touch at rest
const COLUMNS = 25;
const NEAR = [0.012, 0.02, 0.03, 0.045, 0.07, 0.1]; // of the width of what moves: how far apart lips may lie at rest
const GAP = 4; // columns
const FEWEST = 7; // columns that have found a pair
const FORE = 0.7; // mm apart that a mm farther to the front is worth

/**
 * @param {Float32Array} position face's axes, mm @param {Float32Array} opening the shift of each vertex as the mouth opens
 * @param {Uint16Array} meshOf
 * @returns {{upper: number, lower: number, x: number}[]} pairs from the head's right to its left; none: it has no such place
 */
export function lipSeamOf(position, opening, meshOf) {
  const most = opening.reduce((best, value) => Math.max(best, Math.abs(value)), 0);
  const moved = [];
  let [low, high, top, bottom, fore] = [Infinity, -Infinity, -Infinity, Infinity, -Infinity];
  for (let v = 0; v < position.length / 3; v++) {
    if (Math.abs(opening[3 * v + 1]) < 0.3 * most) continue;
    moved.push(v);
    low = Math.min(low, position[3 * v]);
    high = Math.max(high, position[3 * v]);
    top = Math.max(top, position[3 * v + 1]);
    bottom = Math.min(bottom, position[3 * v + 1]);
    fore = Math.max(fore, position[3 * v + 2]);
  }
  const width = high - low;
  if (!(width > 0)) return [];
  for (const share of NEAR) {
    const pairs = pairsWithin(share * width);
    if (pairs.length >= FEWEST) return pairs;
  }
  return [];

  function pairsWithin(near) {
    const cell = Math.max(near, 0.01 * width);
    const name = (x, y) => Math.round(x / cell) * 8192 + Math.round(y / cell);
    const upper = new Map();
    for (let v = 0; v < position.length / 3; v++) {
      const [x, y, z] = [position[3 * v], position[3 * v + 1], position[3 * v + 2]];
      const outside = x < low || x > high || y < bottom || y > top + 0.3 * width || z < fore - width;
      if (outside || opening[3 * v + 1] < -(1 - PARTING) * most) continue;
      const key = name(x, y);
      if (!upper.has(key)) upper.set(key, []);
      upper.get(key).push(v);
    }
    const best = Array(COLUMNS).fill(null);
    for (const l of moved) {
      const [x, y, z] = [position[3 * l], position[3 * l + 1], position[3 * l + 2]];
      const column = Math.min(COLUMNS - 1, Math.floor(((x - low) / width) * COLUMNS));
      for (const [i, j] of AROUND)
        for (const u of upper.get(name(x + i * cell, y + j * cell)) ?? []) {
          if (meshOf[u] !== meshOf[l] || opening[3 * u + 1] - opening[3 * l + 1] < PARTING * most) continue;
          const far = Math.hypot(x - position[3 * u], y - position[3 * u + 1], z - position[3 * u + 2]);
          if (far > near || position[3 * u + 1] < y - near / 4) continue;
          const worth = FORE * (z + position[3 * u + 2]) / 2 - far;
          if (best[column] && worth <= best[column].worth) continue;
          best[column] = { upper: u, lower: l, x: (x + position[3 * u]) / 2, worth };
        }
    }
    return longest(best);
  }
}

const AROUND = [-1, 0, 1].flatMap((i) => [-1, 0, 1].map((j) => [i, j]));

/** The longest run of columns that have one; where a mesh is coarse, some lie between its points. */
function longest(columns) {
  let [run, best, last] = [[], [], -1];
  columns.forEach((pair, i) => {
    if (!pair) return;
    run = run.length && i - last <= GAP ? [...run, pair] : [pair];
    last = i;
    if (run.length > best.length) best = run;
  });
  return best.sort((a, b) => a.x - b.x);
}
