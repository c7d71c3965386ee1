// SPDX-License-Identifier: GPL-3.0-or-later
/** The edges at which a garment ends: its neckline, its front, its sleeves; not where the body is cut off. */

const CUT = 24; // mm above its lowest vertex: there it is cut, not hemmed

/** @param {{index: number[], smooth: number[]|null, position: ArrayLike<number>}} part @returns {number[][]} pairs of vertices, in the order of their triangle */
export function hems({ index, smooth, position }) {
  const place = (v) => (smooth ? smooth[v] : v);
  const count = new Map();
  const key = (a, b) => (place(a) < place(b) ? `${place(a)}/${place(b)}` : `${place(b)}/${place(a)}`);
  const edges = [];
  for (let t = 0; t < index.length; t += 3)
    for (let k = 0; k < 3; k++) {
      const edge = [index[t + k], index[t + ((k + 1) % 3)]];
      edges.push(edge);
      count.set(key(...edge), (count.get(key(...edge)) ?? 0) + 1);
    }
  let low = Infinity;
  for (const v of index) low = Math.min(low, position[3 * v + 1]);
  const sewn = (v) => position[3 * v + 1] > low + CUT;
  return edges.filter(([a, b]) => count.get(key(a, b)) === 1 && sewn(a) && sewn(b));
}

/** @returns {(q: number[]) => [number, number]} how far the nearest hem is, mm, and how far along it in mm; Infinity where none is within `reach` */
export function nearestHem(part, reach) {
  const lines = hems(part).map((edge) => edge.map((v) => [...part.position.slice(3 * v, 3 * v + 3)]));
  const CELL = reach * 2;
  const cells = new Map();
  const cell = (q) => q.map((x) => Math.floor(x / CELL));
  for (const line of lines) {
    const [low, high] = [Math.min, Math.max].map((of, i) => cell([0, 1, 2].map((k) => of(line[0][k], line[1][k]) + (i ? reach : -reach))));
    for (let x = low[0]; x <= high[0]; x++)
      for (let y = low[1]; y <= high[1]; y++)
        for (let z = low[2]; z <= high[2]; z++) {
          const name = `${x},${y},${z}`;
          cells.set(name, [...(cells.get(name) ?? []), line]);
        }
  }
  return (q) => {
    let best = [Infinity, 0];
    for (const [a, b] of cells.get(cell(q).join()) ?? []) {
      const d = b.map((x, k) => x - a[k]);
      const long = Math.hypot(...d) || 1;
      const along = Math.min(long, Math.max(0, d.reduce((sum, x, k) => sum + x * (q[k] - a[k]), 0) / long));
      const far = Math.hypot(...q.map((x, k) => x - a[k] - (d[k] * along) / long));
      if (far < best[0]) best = [far, along];
    }
    return best[0] <= reach ? best : [Infinity, 0];
  };
}
