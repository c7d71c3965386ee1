// SPDX-License-Identifier: MIT
/**
 * A picture as two planes of numbers, brightness and redness, blurred to a width, and without what changes slowly over it:
 * light does.
 */

const SLOW = 7; // mm: the width of what counts as light
const ENOUGH = 1.7; // pixels a mm
const RED = 2; // as much as brightness counts: redness differs less

/** Mean over 2r + 1 columns, three times (nearly a Gaussian), rows likewise. */
function blur(plane, width, height, deviation) {
  const radius = Math.round(Math.sqrt(deviation * deviation + 0.25) - 0.5);
  if (radius < 1) return plane;
  let a = plane;
  const b = new Float32Array(plane.length);
  for (let round = 0; round < 3; round++) {
    sweep(a, b, width, height, 1, width, radius);
    const c = a === plane ? new Float32Array(plane.length) : a;
    sweep(b, c, height, width, width, 1, radius);
    a = c;
  }
  return a;
}

/**
 * A running mean over 2r + 1 numbers of each line; beyond its ends, the last ones go on.
 * @param {number} count numbers of a line @param {number} step from one to the next @param {number} jump from line to line
 */
export function sweep(from, to, count, lines, step, jump, r) {
  const share = 1 / (2 * r + 1);
  for (let line = 0; line < lines; line++) {
    const at = line * jump;
    let sum = from[at] * (r + 1);
    for (let i = 1; i <= r; i++) sum += from[at + Math.min(i, count - 1) * step];
    for (let i = 0; i < count; i++) {
      to[at + i * step] = sum * share;
      sum += from[at + Math.min(count - 1, i + r + 1) * step] - from[at + Math.max(0, i - r) * step];
    }
  }
}

/**
 * @param {{width: number, height: number, data: ArrayLike<number>}} picture RGBA
 * @param {number[]} box column, row, columns, rows
 * @param {number} perMm pixels @param {number[]} widths mm, of each blur
 * @returns {object[]} for each width {x, y, width, height, planes}
 */
export function planesOf(picture, [bx, by, bw, bh], perMm, widths) {
  const bin = Math.max(1, Math.floor(perMm / ENOUGH)); // pixels taken together
  const x = Math.max(0, Math.floor(bx)), y = Math.max(0, Math.floor(by));
  const width = Math.max(4, Math.floor((Math.min(picture.width, Math.ceil(bx + bw)) - x) / bin));
  const height = Math.max(4, Math.floor((Math.min(picture.height, Math.ceil(by + bh)) - y) / bin));
  const raw = [new Float32Array(width * height), new Float32Array(width * height)];
  const { data, width: across } = picture;
  for (let j = 0; j < height; j++)
    for (let i = 0; i < width; i++) {
      let [r, g, b] = [0, 0, 0];
      for (let n = 0; n < bin; n++) {
        let at = 4 * ((y + j * bin + n) * across + x + i * bin);
        for (let m = 0; m < bin; m++, at += 4) {
          r += data[at];
          g += data[at + 1];
          b += data[at + 2];
        }
      }
      raw[0][j * width + i] = (0.3 * r + 0.6 * g + 0.1 * b) / (bin * bin);
      raw[1][j * width + i] = (RED * (0.7 * r - 0.6 * g - 0.1 * b)) / (bin * bin);
    }
  const slow = raw.map((plane) => blur(plane, width, height, (SLOW * perMm) / bin));
  return widths.map((mm) => ({
    x, y, width, height, bin,
    planes: raw.map((plane, k) => {
      const out = Float32Array.from(blur(plane, width, height, (mm * perMm) / bin));
      for (let i = 0; i < out.length; i++) out[i] -= slow[k][i];
      return out;
    }),
  }));
}

/**
 * Between the pixels' middles: into `out` the value, and how it grows with the column and the row.
 * @returns {boolean} false: outside
 */
export function lookAt({ x, y, width, height, bin }, plane, u, v, out) {
  const p = (u - x) / bin - 0.5;
  const q = (v - y) / bin - 0.5;
  const i = Math.floor(p);
  const j = Math.floor(q);
  if (!(i >= 1 && j >= 1 && i < width - 2 && j < height - 2)) return false;
  const fx = p - i;
  const fy = q - j;
  const at = j * width + i;
  const a = plane[at];
  const b = plane[at + 1];
  const c = plane[at + width];
  const d = plane[at + width + 1];
  out[0] = (a * (1 - fx) + b * fx) * (1 - fy) + (c * (1 - fx) + d * fx) * fy;
  out[1] = ((b - a) * (1 - fy) + (d - c) * fy) / bin;
  out[2] = ((c - a) * (1 - fx) + (d - b) * fx) / bin;
  return true;
}
