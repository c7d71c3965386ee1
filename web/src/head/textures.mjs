// SPDX-License-Identifier: MIT
import { DataTexture, LinearFilter, LinearMipmapLinearFilter, NoColorSpace, SRGBColorSpace, Texture } from 'three';
import { decodeTexture } from './model.mjs';

/**
 * @param {object} json a texture of the model
 * @param {boolean} transparent whether its alpha is used: its colours are then multiplied by it, and are left as they are
 *   stored; else they are linear when sampled
 */
export async function loadTexture(json, transparent) {
  const bitmap = await decodeTexture(json, {
    premultiplyAlpha: transparent ? 'premultiply' : 'none',
    colorSpaceConversion: 'none',
  });
  const texture = new Texture(bitmap);
  texture.colorSpace = transparent ? NoColorSpace : SRGBColorSpace;
  texture.flipY = false;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.magFilter = LinearFilter;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  return texture;
}

/** For materials without a texture. */
export function whiteTexture() {
  const texture = new DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
  texture.needsUpdate = true;
  return texture;
}
