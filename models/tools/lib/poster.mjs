// SPDX-License-Identifier: GPL-3.0-or-later
/** The neutral picture of a head, a WebP of a few kB, shown until the head has loaded and where it cannot be drawn. */
import sharp from 'sharp';
import { unpack } from './deform.mjs';
import { drawHead } from './portrait.mjs';

const SIZE = { width: 360, height: 468 }; // aspect ratio of the element by default
const QUALITY = 80;

/** @param {object} head in file format @param {boolean} shadows */
export async function drawPoster(head, shadows = true) {
  const { data, width, height } = await drawHead(unpack(head), { ...SIZE, shadows });
  return sharp(Buffer.from(data.buffer), { raw: { width, height, channels: 4 } })
    .webp({ quality: QUALITY, alphaQuality: 80, effort: 4 })
    .toBuffer();
}
