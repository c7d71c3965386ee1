// SPDX-License-Identifier: GPL-3.0-or-later
/** Parts of a set of pictures: contours, sheets, encoded images (protocol/pictures.md). */
import sharp from 'sharp';

export const COLUMNS = 5;
const POINTS = 32; // of a contour
const INNER = 0.7; // of the outer contour
const STEP = 0.02;
const MOST = 0.98; // of the way to the border

export const round = (x) => Math.round(x * 100) / 100;

export function within(contour, x, y) {
  let inside = false;
  for (let i = 0, j = contour.length - 1; i < contour.length; j = i++) {
    const [[ax, ay], [bx, by]] = [contour[i], contour[j]];
    if (ay > y !== by > y && x < ax + ((y - ay) * (bx - ax)) / (by - ay)) inside = !inside;
  }
  return inside;
}

/** Returns a rounded rectangle, shrunk to the allowed area. @param {(x: number, y: number) => boolean} may whether a point of the box is allowed */
export function maskOf({ width, height }, may) {
  const [cx, cy] = [(width - 1) / 2, (height - 1) / 2];
  const outer = Array.from({ length: POINTS }, (_, i) => {
    const [c, s] = [Math.cos((2 * Math.PI * i) / POINTS), Math.sin((2 * Math.PI * i) / POINTS)];
    const far = (c ** 4 + s ** 4) ** -0.25;
    const at = (reach) => [cx + cx * c * far * reach, cy + cy * s * far * reach];
    let reach = 0;
    while (reach < MOST && may(...at(reach + STEP))) reach += STEP;
    return at(reach).map(round);
  });
  return { outer, inner: outer.map(([x, y]) => [round(cx + INNER * (x - cx)), round(cy + INNER * (y - cy))]) };
}

/** @param {{data: Uint8ClampedArray}[]} pictures of the size of the box */
export function sheetOf(pictures, { width, height }) {
  const [wide, rows] = [width * COLUMNS, Math.ceil(pictures.length / COLUMNS)];
  const data = new Uint8ClampedArray(4 * wide * height * rows).fill(255);
  pictures.forEach((picture, n) => {
    const left = (n % COLUMNS) * width;
    const top = Math.floor(n / COLUMNS) * height;
    for (let y = 0; y < height; y++)
      for (let x = 0; x < width; x++)
        data.set(picture.data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3), 4 * ((top + y) * wide + left + x));
  });
  return { width: wide, height: height * rows, data };
}

/** @param {boolean} clear whether it has an outline */
export async function written({ data, width, height }, quality, clear = false) {
  const image = sharp(Buffer.from(data.buffer, data.byteOffset, data.byteLength), { raw: { width, height, channels: 4 } });
  const bytes = await (clear ? image : image.removeAlpha()).webp({ quality, alphaQuality: 90, effort: 5, smartSubsample: true }).toBuffer();
  return { type: 'image/webp', data: bytes.toString('base64') };
}
