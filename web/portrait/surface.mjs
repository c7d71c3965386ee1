// SPDX-License-Identifier: MIT
// Queries of a mesh onto which a picture is laid.

const CELL = 0.7; // mm
const BIAS = 1.6; // mm: what lies so little behind the nearest surface is it

/**
 * Finds the vertices that are visible in a picture, by parallel projection.
 * @param {Float32Array} position @param {Uint16Array} index of the part @param {{position: Float32Array,
 *   index: Uint16Array}[]} others parts that may hide it @param {number[][]} turn columns: the picture's x, y, z in the
 *   head's directions
 * @returns {Uint8Array}
 */
export function visible(position, index, others, turn) {
  const seenFrom = (p) => Float32Array.from(p, (_, i) =>
    [0, 1, 2].reduce((sum, l) => sum + turn[l][i % 3] * p[i - (i % 3) + l], 0));
  const own = seenFrom(position);
  const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
  for (let i = 0; i < own.length; i += 3)
    for (let k = 0; k < 2; k++) {
      low[k] = Math.min(low[k], own[i + k]);
      high[k] = Math.max(high[k], own[i + k]);
    }
  const [columns, rows] = [0, 1].map((k) => Math.ceil((high[k] - low[k]) / CELL) + 2);
  const nearest = new Float32Array(columns * rows).fill(-Infinity);
  for (const one of [{ flat: own, index },
    ...others.map((part) => ({ flat: seenFrom(part.position), index: part.index }))]) drawDepth(one,
    { low, columns, rows, nearest });
  return Uint8Array.from({ length: own.length / 3 }, (_, v) => {
    const at = Math.round((own[3 * v + 1] - low[1]) / CELL) * columns + Math.round((own[3 * v] - low[0]) / CELL);
    return Number(own[3 * v + 2] > nearest[at] - BIAS);
  });
}

function drawDepth({ flat, index }, { low, columns, rows, nearest }) {
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
    const [ax, ay, bx, by, cx, cy] = [a, b, c].flatMap((v) => [(flat[v] - low[0]) / CELL, (flat[v + 1] - low[1]) / CELL]);
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (area < 1e-9) continue;
    for (let y = Math.max(0, Math.ceil(Math.min(ay, by, cy))); y <= Math.min(rows - 1, Math.max(ay, by, cy)); y++)
      for (let x = Math.max(0, Math.ceil(Math.min(ax, bx, cx))); x <= Math.min(columns - 1, Math.max(ax, bx, cx)); x++) {
        const wa = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area;
        const wb = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area;
        const wc = 1 - wa - wb;
        if (wa < 0 || wb < 0 || wc < 0) continue;
        const z = wa * flat[a + 2] + wb * flat[b + 2] + wc * flat[c + 2];
        if (z > nearest[y * columns + x]) nearest[y * columns + x] = z;
      }
  }
}

/** Values of the vertices, each mixed with its neighbours' some times over. @returns {Float32Array} */
export function smoothOver({ index, smooth, vertices }, values, rounds) {
  const place = (v) => (smooth ? smooth[v] : v);
  let now = Float32Array.from(values);
  for (let round = 0; round < rounds; round++) {
    const sum = new Float32Array(vertices);
    const count = new Float32Array(vertices);
    for (let t = 0; t < index.length; t++) {
      const [v, w] = [index[t], index[t - (t % 3) + ((t + 1) % 3)]];
      sum[place(v)] += now[place(w)] + now[place(v)];
      count[place(v)] += 2;
      sum[place(w)] += now[place(v)];
      count[place(w)]++;
    }
    now = Float32Array.from(now, (_, v) => (count[place(v)] ? sum[place(v)] / count[place(v)] : now[v]));
  }
  return now;
}

/**
 * Goes through the texels of the triangles that are wanted. @param {{uv: Float32Array, index: Uint16Array}} mesh
 * @param {number[]} size of the texture @param {(corners: number[]) => boolean} wanted
 * @param {(texel: number, corners: number[], shares: number[]) => void} act
 */
export function eachTexel({ uv, index }, size, wanted, act) {
  for (let t = 0; t < index.length; t += 3) {
    const corners = [index[t], index[t + 1], index[t + 2]];
    if (!wanted(corners)) continue;
    const [ax, ay, bx, by, cx, cy] = corners.flatMap((v) => [uv[2 * v] * size[0] - 0.5, (1 - uv[2 * v + 1]) * size[1] - 0.5]);
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (Math.abs(area) < 1e-9) continue;
    const [x0, x1] = [Math.max(0, Math.ceil(Math.min(ax, bx, cx))), Math.min(size[0] - 1, Math.floor(Math.max(ax, bx, cx)))];
    const [y0, y1] = [Math.max(0, Math.ceil(Math.min(ay, by, cy))), Math.min(size[1] - 1, Math.floor(Math.max(ay, by, cy)))];
    for (let y = y0; y <= y1; y++)
      for (let x = x0; x <= x1; x++) {
        const wa = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area;
        const wb = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area;
        const wc = 1 - wa - wb;
        if (wa < -1e-6 || wb < -1e-6 || wc < -1e-6) continue;
        act(y * size[0] + x, corners, [wa, wb, wc]);
      }
  }
}

/** Distance to the border of a polygon in the plane of the face, positive inside. */
export function inside(polygon, x, y) {
  let [within, least] = [false, Infinity];
  polygon.forEach(([ax, ay], i) => {
    const [bx, by] = polygon[(i + 1) % polygon.length];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) within = !within;
    const t = Math.min(1, Math.max(0, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2 || 1)));
    least = Math.min(least, Math.hypot(x - ax - t * (bx - ax), y - ay - t * (by - ay)));
  });
  return within ? least : -least;
}

/** Returns the distance of vertex v from the nearest place. @param {number[][]} places @param {Float32Array} position */
export const apartFrom = (places, position, v) =>
  Math.min(...places.map((p) => Math.hypot(p[0] - position[3 * v], p[1] - position[3 * v + 1], p[2] - position[3 * v + 2])));

/** From 0 at the one to 1 at the other, smoothly. @param {number[]} between @param {number} x @returns {number} */
export const ramp = ([low, high], x) => {
  const t = Math.min(1, Math.max(0, (x - low) / (high - low)));
  return t * t * (3 - 2 * t);
};
