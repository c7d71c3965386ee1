// SPDX-License-Identifier: GPL-3.0-or-later
/** Reads pictures of people, and the textures of heads. */
import sharp from 'sharp';
import { PortraitError } from '../../../web/portrait/problem.mjs';
import { openTexture } from '../lib/image.mjs';

const MOST_PIXELS = 100e6;
const LONGEST = 3000; // pixels: more is not needed for a texture
const QUALITY = 90;

/** Reads any file as RGBA, upright, with grey behind transparent areas. @throws {PortraitError} @returns {Promise<object>} */
export async function flat(file) {
  try {
    const { data, info } = await sharp(file, { limitInputPixels: MOST_PIXELS, failOn: 'error' })
      .rotate() // as its camera says
      .resize({ width: LONGEST, height: LONGEST, fit: 'inside', withoutEnlargement: true })
      .toColourspace('srgb')
      .flatten({ background: '#c8ccd0' })
      .ensureAlpha()
      .raw({ depth: 'uchar' })
      .toBuffer({ resolveWithObject: true });
    return { data, width: info.width, height: info.height };
  } catch (error) {
    if (/pixel limit/.test(error.message)) throw new PortraitError('too_large', `the picture has more than ${MOST_PIXELS / 1e6} million pixels`);
    throw new PortraitError('no_picture', `this is no picture that can be read (${error.message.split('\n')[0]})`);
  }
}

export const textures = {
  async read({ data }) {
    const { data: pixels, info } = await openTexture(data).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
    return { data: pixels, width: info.width, height: info.height };
  },
  async write({ data, width, height }, { alpha = false } = {}) {
    const image = sharp(Buffer.from(data.buffer, data.byteOffset, data.length), { raw: { width, height, channels: 4 } });
    const bytes = await (alpha ? image : image.removeAlpha())
      .webp({ quality: QUALITY, effort: 2, smartSubsample: true })
      .toBuffer();
    return { type: 'image/webp', width, height, data: bytes.toString('base64') };
  },
};
