// SPDX-License-Identifier: GPL-3.0-or-later
/** The textures of a head, as WebP. */
import path from 'node:path';
import sharp from 'sharp';
import { paintEye } from './paint-eye.mjs';

export async function makeTextures(ctx, recipe, parts, eyeSpec) {
  const out = {};
  for (const [name, spec] of Object.entries(recipe.textures)) {
    const image = spec.paint === 'eye'
      ? fromFloats(paintEye(spec.size, eyeSpec, recipe.eyes.look), spec.size, 3)
      : sharp(assetFile(ctx, spec, parts)).resize(spec.size, spec.size);
    const data = await image.webp({ quality: spec.quality ?? 85, alphaQuality: 90, effort: 6 }).toBuffer();
    out[name] = { type: 'image/webp', width: spec.size, height: spec.size, data };
  }
  return out;
}

function assetFile(ctx, spec, parts) {
  if (spec.file) return ctx.assets.data(spec.file);
  const { proxy } = parts.find((part) => part.material === spec.material);
  return path.join(proxy.folder, proxy.texture);
}

function fromFloats(pixels, size, channels) {
  const bytes = Buffer.from(Uint8ClampedArray.from(pixels, Math.round).buffer);
  return sharp(bytes, { raw: { width: size, height: size, channels } });
}
