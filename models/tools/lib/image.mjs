// SPDX-License-Identifier: GPL-3.0-or-later
/** Reading, recolouring and writing images as plain RGBA numbers. */
import sharp from 'sharp';
import { ModelError } from '../../../web/element/head/model/check.mjs';
import { MOST_PIXELS, pictureTrouble } from '../../../web/element/head/model/picture-size.mjs';
import { hex, luma, ramp } from './color.mjs';

/** Opens a texture of a head from an untrusted file. @param {string} data base64 @throws {ModelError} before it is decoded */
export function openTexture(data) {
  const bytes = Buffer.from(data, 'base64');
  const trouble = pictureTrouble(bytes);
  if (trouble) throw new ModelError('textures', `one ${trouble}`);
  return sharp(bytes, { limitInputPixels: MOST_PIXELS });
}

/** @returns {Promise<{size: number, data: Float32Array}>} RGBA, 0..255, square, scaled with a cubic kernel */
export async function readImage(file, size) {
  const { data } = await sharp(file)
    .ensureAlpha()
    .resize(size, size, { kernel: 'cubic', fit: 'fill' })
    .raw()
    .toBuffer({ resolveWithObject: true });
  return { size, data: Float32Array.from(data) };
}

export function writeImage({ size, data }, quality) {
  const channels = data.length / (size * size);
  const rounded = new Uint8ClampedArray(data.length); // it rounds by itself
  for (let i = 0; i < data.length; i++) rounded[i] = data[i];
  const bytes = Buffer.from(rounded.buffer);
  return sharp(bytes, { raw: { width: size, height: size, channels } })
    .webp({ quality, alphaQuality: 70, effort: 4, smartSubsample: true })
    .toBuffer();
}

/**
 * New colours by brightness: stops of [brightness 0..1, colour]; brightness is stretched so that its extremes
 * reach 0 and 1.
 */
export function recolour(image, stops) {
  const colours = stops.map(([at, text]) => [at, hex(text)]);
  const d = image.data;
  const seen = [];
  for (let i = 0; i < d.length; i += 4) if (d[i + 3] > 127) seen.push(luma([d[i], d[i + 1], d[i + 2]]));
  seen.sort((a, b) => a - b);
  const low = seen[Math.floor(seen.length * 0.01)],
    high = seen[Math.floor(seen.length * 0.99)];
  for (let i = 0; i < d.length; i += 4) {
    d.set(ramp(colours, (luma([d[i], d[i + 1], d[i + 2]]) - low) / (high - low)), i);
  }
}

/**
 * Carries the colour of opaque texels into the transparent ones beside them, so that filtering shows no dark
 * fringe.
 */
export function bleed(image, passes, opaque = 100) {
  const { size, data } = image;
  const known = new Uint8Array(size * size);
  const sum = [0, 0, 0, 0];
  for (let i = 0; i < known.length; i++) {
    if (data[i * 4 + 3] < opaque) continue;
    known[i] = 1;
    for (let k = 0; k < 3; k++) sum[k] += data[i * 4 + k];
    sum[3]++;
  }
  const mean = sum.slice(0, 3).map((x) => x / sum[3]);
  for (let i = 0; i < known.length; i++) if (!known[i]) data.set(mean, i * 4);
  let ring = [];
  for (let i = 0; i < known.length; i++) if (known[i]) ring.push(i);
  for (let pass = 0; pass < passes && ring.length; pass++) {
    const next = [];
    for (const i of ring) {
      const x = i % size;
      for (const j of [x + 1 < size ? i + 1 : -1, x ? i - 1 : -1, i + size, i - size]) {
        if (j < 0 || j >= known.length || known[j]) continue;
        known[j] = 1;
        for (let k = 0; k < 3; k++) data[j * 4 + k] = data[i * 4 + k];
        next.push(j);
      }
    }
    ring = next;
  }
}

/** Three box passes, close to a Gaussian of that radius. */
export function blur(values, size, radius) {
  const r = Math.max(1, Math.round(radius));
  let from = Float32Array.from(values);
  let to = new Float32Array(values.length);
  const line = (start, step) => {
    let sum = 0;
    for (let k = -r; k <= r; k++) sum += from[start + Math.min(size - 1, Math.max(0, k)) * step];
    for (let k = 0; k < size; k++) {
      to[start + k * step] = sum / (2 * r + 1);
      sum += from[start + Math.min(size - 1, k + r + 1) * step] - from[start + Math.max(0, k - r) * step];
    }
  };
  for (let pass = 0; pass < 3; pass++) {
    for (let y = 0; y < size; y++) line(y * size, 1);
    [from, to] = [to, from];
    for (let x = 0; x < size; x++) line(x, size);
    [from, to] = [to, from];
  }
  return from;
}
