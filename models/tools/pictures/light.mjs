// SPDX-License-Identifier: GPL-3.0-or-later
/** Gives all pictures the lighting of the picture at rest: takes slow variations over the skin from it. */

const SLOW = 9; // pixels, applied three times: a Gaussian of about 16
const MOST = 3; // times
const linear = Float32Array.from({ length: 256 }, (_, i) => (i / 255) ** 2.2);
const coded = (x) => 255 * x ** (1 / 2.2);

/** Box filter, along rows and then columns. */
function blurred(values, { width, height }) {
  let now = values;
  for (const [count, length, step, stride] of [[height, width, 1, width], [width, height, width, 1]]) {
    const out = new Float32Array(now.length);
    for (let line = 0; line < count; line++) {
      let sum = 0;
      const at = (k) => now[line * stride + Math.min(length - 1, Math.max(0, k)) * step];
      for (let k = -SLOW; k <= SLOW; k++) sum += at(k);
      for (let k = 0; k < length; k++) {
        out[line * stride + k * step] = sum;
        sum += at(k + SLOW + 1) - at(k - SLOW);
      }
    }
    now = out;
  }
  return now;
}

const slowly = (values, size) => blurred(blurred(blurred(values, size), size), size);

/**
 * @param {{width: number, height: number, data: Uint8ClampedArray}} picture changed in place @param {{data: Uint8ClampedArray}} rest of the same
 *   size @param {Float32Array} skin share of even skin in both, by pixel
 */
export function even(picture, rest, skin) {
  const size = { width: picture.width, height: picture.height };
  const least = 1e-6 * (2 * SLOW + 1) ** 6;
  const weight = slowly(skin, size);
  const all = skin.reduce((sum, x) => sum + x, 0) || 1;
  for (let k = 0; k < 3; k++) {
    const lit = ({ data }) => Float32Array.from(skin, (share, i) => share * linear[data[4 * i + k]]);
    const [own, wanted] = [lit(picture), lit(rest)];
    const whole = wanted.reduce((sum, x) => sum + x, 0) / (own.reduce((sum, x) => sum + x, 0) || 1);
    const [slowOwn, slowWanted] = [slowly(own, size), slowly(wanted, size)];
    for (let i = 0; i < skin.length; i++) {
      const near = weight[i] > least && all > 1 && slowOwn[i] > 0 ? slowWanted[i] / slowOwn[i] : whole; // far from skin: uses the global mean
      const gain = Math.min(MOST, Math.max(1 / MOST, near));
      picture.data[4 * i + k] = coded(Math.min(1, gain * linear[picture.data[4 * i + k]]));
    }
  }
}
