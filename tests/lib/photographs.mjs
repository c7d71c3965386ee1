// SPDX-License-Identifier: GPL-3.0-or-later
// Synthetic photographs of a speaking person: a built-in head drawn in poses, with varying light, frame sizes and tilt.
import { createRequire } from 'node:module';
import { drawHead, seenAt, shadowsOf } from '../../models/tools/lib/portrait.mjs';

const sharp = createRequire(new URL('../../models/package.json', import.meta.url))('sharp');
const SIZE = { width: 480, height: 624 };
const ROOM = { r: 112, g: 128, b: 138, alpha: 1 };

/**
 * @param {object} head unpacked (lib/deform.mjs)
 * @returns {Promise<(faps: object, camera?: {scale?: number, tilt?: number, shift?: number[], light?: number, blur?: number, yaw?: number}) => Promise<Buffer>>}
 *   PNG. scale: of 480 x 624; tilt: degrees; shift: pixels; light: factor of brightness; blur: sigma; yaw: degrees
 */
export async function openStudio(head) {
  const shadows = await shadowsOf(head, {});
  const png = ({ data, width, height }) => sharp(Buffer.from(data.buffer), { raw: { width, height, channels: 4 } }).png({ compressionLevel: 1 }).toBuffer();
  const rest = await png(await drawHead(head, { ...SIZE, shadows }));
  const [[left, top], [right, bottom], [, nose]] = seenAt(head, SIZE, [head.fdp['8.4'], head.fdp['8.3'], head.fdp['9.15']].map((p) => [...p]));
  const [, chin] = seenAt(head, SIZE, [head.fdp['2.1']])[0];
  const wide = right - left;
  const mouth = { x: Math.round(left - 0.7 * wide), y: Math.round(nose - 0.3 * wide), width: Math.round(2.4 * wide), height: 0 };
  mouth.height = Math.round(Math.max(chin, top, bottom) + 0.6 * wide) - mouth.y;
  const eyes = { x: Math.round(0.2 * SIZE.width), y: Math.round(nose - 1.4 * wide), width: Math.round(0.6 * SIZE.width), height: Math.round(1.2 * wide) };

  return async function take(faps, { scale = 1, tilt = 0, shift = [0, 0], light = 1, blur = 0, yaw = 0 } = {}) {
    let face;
    if (yaw) face = await png(await drawHead(head, { ...SIZE, faps, yaw, shadows: false }));
    else {
      const numbers = Object.keys(faps).map(Number);
      const crops = [...(numbers.some((n) => n < 19 || n > 42) ? [mouth] : []), ...(numbers.some((n) => n >= 19 && n <= 22) ? [eyes] : [])];
      const pieces = [];
      for (const crop of crops) pieces.push({ input: await png(await drawHead(head, { ...SIZE, faps, crop, shadows })), left: crop.x, top: crop.y });
      const ground = { create: { ...SIZE, channels: 4, background: ROOM } };
      const whole = await sharp(ground).composite([{ input: rest }, ...pieces]).png({ compressionLevel: 1 }).toBuffer();
      face = whole;
    }
    let image = sharp(face).flatten({ background: ROOM }).affine(turned(scale, tilt), { background: ROOM, interpolator: 'bicubic' });
    image = sharp(await image.png({ compressionLevel: 1 }).toBuffer());
    const [x, y] = shift;
    image = image.extend({ left: Math.max(0, x), right: Math.max(0, -x), top: Math.max(0, y), bottom: Math.max(0, -y), background: ROOM });
    if (blur) image = image.blur(blur);
    if (light !== 1) image = sharp(await image.png().toBuffer()).removeAlpha().linear(light, 0);
    return image.removeAlpha().png({ compressionLevel: 1 }).toBuffer();
  };
}

function turned(scale, degrees) {
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)].map((x) => scale * x);
  return [[c, -s], [s, c]];
}
