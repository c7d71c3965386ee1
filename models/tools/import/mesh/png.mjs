// SPDX-License-Identifier: GPL-3.0-or-later
/** Encodes decompressed pictures as PNG (ISO/IEC 15948), for formats that heads do not support. */
import zlib from 'node:zlib';
import { MOST } from '../limits.mjs';

const CRC = Int32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n;
});

function chunk(type, data) {
  const out = Buffer.alloc(12 + data.length);
  out.writeUInt32BE(data.length, 0);
  out.write(type, 4, 'latin1');
  data.copy(out, 8);
  let crc = -1;
  for (let i = 4; i < 8 + data.length; i++) crc = CRC[(crc ^ out[i]) & 255] ^ (crc >>> 8);
  out.writeInt32BE(~crc, 8 + data.length);
  return out;
}

/** @param {{width: number, height: number, data: Uint8ClampedArray}} picture RGBA @returns {Buffer} */
export function png({ width, height, data }) {
  const opaque = data.every((x, i) => i % 4 < 3 || x === 255);
  const [size, row] = opaque ? [3, 3 * width] : [4, 4 * width];
  const lines = Buffer.alloc((row + 1) * height);
  for (let y = 0; y < height; y++) {
    const at = y * (row + 1);
    lines[at] = 1; // filter "Sub", which halves the size of pictures of skin
    for (let x = 0; x < width; x++)
      for (let k = 0; k < size; k++) {
        const before = x ? data[4 * (y * width + x - 1) + k] : 0;
        lines[at + 1 + x * size + k] = data[4 * (y * width + x) + k] - before;
      }
  }
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, opaque ? 2 : 6], 8);
  return Buffer.concat([Buffer.from('89504e470d0a1a0a', 'hex'), chunk('IHDR', head), chunk('IDAT', zlib.deflateSync(lines)), chunk('IEND', Buffer.alloc(0))]);
}

/** Halves width and height, averaging four pixels. */
function halved({ width, height, data }) {
  const [w, h] = [width >> 1, height >> 1];
  const out = new Uint8ClampedArray(4 * w * h);
  for (let y = 0; y < h; y++)
    for (let i = 0; i < 4 * w; i++) {
      const at = 4 * (2 * y * width + 2 * (i >> 2)) + (i & 3);
      out[4 * y * w + i] = (data[at] + data[at + 4] + data[at + 4 * width] + data[at + 4 * width + 4]) / 4;
    }
  return { width: w, height: h, data: out };
}

/** Encodes the picture at the largest size that a head may contain. */
export function pictureAsPng(picture) {
  for (let made = png(picture); ; made = png(picture)) {
    if (made.length <= MOST.image) return { type: 'image/png', width: picture.width, height: picture.height, data: made };
    picture = halved(picture);
  }
}
