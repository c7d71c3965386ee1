// SPDX-License-Identifier: MIT
import {
  DataTexture, LinearFilter, LinearMipmapLinearFilter, LinearMipmapNearestFilter, NoColorSpace, SRGBColorSpace, Texture,
} from 'three';
import { decodeTexture } from './model/model.mjs';

/**
 * @param {object} json a texture of the model
 * @param {boolean} transparent whether its alpha is used: its colours are then multiplied by it
 */
export async function loadTexture(json, transparent) {
  const premultiplyAlpha = transparent ? 'premultiply' : 'none';
  const texture = new Texture(await decodeTexture(json, { premultiplyAlpha, colorSpaceConversion: 'none' }));
  texture.flipY = false;
  texture.magFilter = LinearFilter;
  texture.generateMipmaps = true;
  texture.userData.transparent = transparent;
  return texture;
}

/**
 * @param {Texture} texture
 * @param {boolean} linear whether sampling converts its colours to linear ones, unless they are multiplied by alpha; otherwise
 *   the shader converts the result: without a GPU that is cheaper than converting each texel
 * @param {boolean} fine whether mipmap levels are interpolated @param {number} anisotropy
 */
export function setTextureQuality(texture, linear, fine, anisotropy) {
  const colorSpace = linear && !texture.userData.transparent ? SRGBColorSpace : NoColorSpace;
  const minFilter = fine ? LinearMipmapLinearFilter : LinearMipmapNearestFilter;
  const wanted = { colorSpace, minFilter, anisotropy };
  if (texture.version && Object.entries(wanted).every(([key, value]) => texture[key] === value)) return;
  texture.dispose(); // its format on the graphics processor changes
  Object.assign(texture, wanted, { needsUpdate: true });
}

/** For materials without a texture. */
export function whiteTexture() {
  const texture = new DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
  texture.needsUpdate = true;
  return texture;
}
