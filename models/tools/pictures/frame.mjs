// SPDX-License-Identifier: GPL-3.0-or-later
/** Registers photographs to the one at rest: by a similarity transform of points that speech does not move, then by the pixels around them. */

/** Corners of the eyes, bridge of the nose. */
const ANCHORED = [33, 133, 362, 263, 168, 6, 197, 195];
const MOST_TAPS = 6; // of a pixel's side
const ROUNDS = 12;
const SURE = 1e-3; // pixels: a smaller difference is not a step

/**
 * Fits a map of the plane that rotates, scales and shifts: `(x, y)` goes to `(a x - b y + c, b x + a y + d)`.
 * @param {number[][]} from @param {number[][]} to landmarks, of which only the fixed ones are used @returns {{a: number, b: number, c: number, d: number}}
 */
export function similarity(from, to, which = ANCHORED) {
  const mean = (points, k) => which.reduce((sum, i) => sum + points[i][k], 0) / which.length;
  const [fx, fy, tx, ty] = [mean(from, 0), mean(from, 1), mean(to, 0), mean(to, 1)];
  let [dot, cross, size] = [0, 0, 0];
  for (const i of which) {
    const [x, y, u, v] = [from[i][0] - fx, from[i][1] - fy, to[i][0] - tx, to[i][1] - ty];
    dot += x * u + y * v;
    cross += x * v - y * u;
    size += x * x + y * y;
  }
  const [a, b] = [dot / size, cross / size];
  return { a, b, c: tx - a * fx + b * fy, d: ty - b * fx - a * fy };
}

export const mapped = ({ a, b, c, d }, [x, y]) => [a * x - b * y + c, b * x + a * y + d];

export function inverse({ a, b, c, d }) {
  const size = a * a + b * b;
  const [p, q] = [a / size, -b / size];
  return { a: p, b: q, c: -(p * c - q * d), d: -(q * c + p * d) };
}

/** Composes the maps: first `one`, then `other`. */
function after(one, other) {
  const [c, d] = mapped(other, [one.c, one.d]);
  return { a: other.a * one.a - other.b * one.b, b: other.b * one.a + other.a * one.b, c, d };
}

/**
 * Fills a box of the frame from a picture: each pixel is the mean of the area that it covers.
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture RGBA @param {object} onto maps the picture to the frame @param {{x:
 *   number, y: number, width: number, height: number}} box
 * @returns {{width: number, height: number, data: Uint8ClampedArray}} RGBA; clear outside of the picture
 */
export function placed({ width, height, data }, onto, box) {
  const back = inverse(onto);
  const taps = Math.max(1, Math.min(MOST_TAPS, Math.round(Math.hypot(back.a, back.b))));
  const out = new Uint8ClampedArray(4 * box.width * box.height);
  for (let j = 0, at = 0; j < box.height; j++)
    for (let i = 0; i < box.width; i++, at += 4) {
      const sum = [0, 0, 0];
      let count = 0;
      for (let t = 0; t < taps * taps; t++) {
        const place = [box.x + i + ((t % taps) + 0.5) / taps, box.y + j + (Math.floor(t / taps) + 0.5) / taps];
        const [u, v] = mapped(back, place).map((x) => x - 0.5);
        if (u < -0.5 || v < -0.5 || u > width - 0.5 || v > height - 0.5) continue;
        count++;
        const [x, y] = [Math.min(width - 1.001, Math.max(0, u)), Math.min(height - 1.001, Math.max(0, v))];
        const [p, q] = [Math.floor(x), Math.floor(y)];
        const [fx, fy] = [x - p, y - q];
        const k = 4 * (q * width + p);
        for (let n = 0; n < 3; n++)
          sum[n] += (data[k + n] * (1 - fx) + data[k + 4 + n] * fx) * (1 - fy) + (data[k + 4 * width + n] * (1 - fx) + data[k + 4 * width + 4 + n] * fx) * fy;
      }
      for (let n = 0; n < 3; n++) out[at + n] = count ? sum[n] / count : 0;
      out[at + 3] = (255 * count) / (taps * taps);
    }
  return { width: box.width, height: box.height, data: out };
}

/** Returns the brightness with mean 0 and standard deviation 1, to cancel differences of lighting. */
export function evened({ width, height, data }) {
  const grey = Float32Array.from({ length: width * height }, (_, i) => 0.3 * data[4 * i] + 0.59 * data[4 * i + 1] + 0.11 * data[4 * i + 2]);
  const mean = grey.reduce((sum, x) => sum + x, 0) / grey.length;
  const spread = Math.sqrt(grey.reduce((sum, x) => sum + (x - mean) ** 2, 0) / grey.length) || 1;
  return grey.map((x) => (x - mean) / spread);
}

/**
 * Improves the map by least squares over the pixels of a box that speech does not move (Lucas and Kanade 1981).
 * @param {Float32Array} still the normalised box of the picture at rest
 */
export function refined(picture, onto, box, still) {
  const { width, height } = box;
  let now = onto;
  for (let round = 0; round < ROUNDS; round++) {
    const seen = evened(placed(picture, now, box));
    const m = Array.from({ length: 4 }, () => new Float64Array(5));
    for (let y = 1; y < height - 1; y++)
      for (let x = 1; x < width - 1; x++) {
        const i = y * width + x;
        const [gx, gy] = [(still[i + 1] - still[i - 1]) / 2, (still[i + width] - still[i - width]) / 2];
        const [u, v] = [x - width / 2, y - height / 2];
        const row = [gx * u + gy * v, gy * u - gx * v, gx, gy, seen[i] - still[i]];
        for (let a = 0; a < 4; a++) for (let b = 0; b < 5; b++) m[a][b] += row[a] * row[b];
      }
    const step = solved(m);
    if (!step || step.some((x) => !Number.isFinite(x))) return onto;
    const [a, b, c, d] = [1 + step[0], step[1], step[2], step[3]];
    const [mx, my] = [box.x + width / 2, box.y + height / 2];
    now = after(now, { a, b, c: mx + c - a * mx + b * my, d: my + d - b * mx - a * my });
    if (Math.hypot(c, d) < SURE && Math.hypot(a - 1, b) * width < SURE) break;
  }
  return now;
}

/** Gaussian elimination with four unknowns; null if singular. */
function solved(m) {
  for (let c = 0; c < 4; c++) {
    const best = [0, 1, 2, 3].slice(c).reduce((x, r) => (Math.abs(m[r][c]) > Math.abs(m[x][c]) ? r : x), c);
    [m[c], m[best]] = [m[best], m[c]];
    if (Math.abs(m[c][c]) < 1e-9) return null;
    for (let r = 0; r < 4; r++) {
      if (r === c) continue;
      const factor = m[r][c] / m[c][c];
      for (let k = c; k < 5; k++) m[r][k] -= factor * m[c][k];
    }
  }
  return m.map((row, i) => row[4] / row[i]);
}
