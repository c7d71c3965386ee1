// SPDX-License-Identifier: MIT
// Opacity of parts whose textures have holes (hair, glasses).

const SIZE = 256;
const HALF = 128; // of 255

/** Reads the alpha of a texture. @param {ImageBitmap} image @returns {(u: number, v: number) => number} 0 to 255 */
export function alphaOf(image) {
  const canvas = document.createElement('canvas');
  const size = (canvas.width = canvas.height = SIZE);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(image, 0, 0, size, size);
  const { data } = context.getImageData(0, 0, size, size);
  const at = (x) => Math.min(size - 1, Math.floor((x - Math.floor(x)) * size));
  return (u, v) => data[4 * (at(v) * size + at(u)) + 3];
}

/** Reads the alpha of a part by texture coordinates (v from above); null: it is opaque. */
export function alphaOfPart({ model, textures }, part) {
  const { texture, alpha } = model.materials[part.material] ?? {};
  return texture && part.uv && (alpha === 'blend' || alpha === 'cutout') ? alphaOf(textures.get(texture).image) : null;
}

/** The same as yes or no. */
export function opaqueOfPart(head, part) {
  const alpha = alphaOfPart(head, part);
  return alpha && ((u, v) => alpha(u, v) >= HALF);
}
