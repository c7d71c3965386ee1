// SPDX-License-Identifier: MIT
import { ClampToEdgeWrapping, LinearFilter, LinearMipmapLinearFilter, MirroredRepeatWrapping, NearestFilter, RepeatWrapping, Texture } from 'three';

const WRAPS = { 33071: ClampToEdgeWrapping, 33648: MirroredRepeatWrapping, 10497: RepeatWrapping };
const MOST_SIDE = 2048; // pixels: more of a face is not seen, and costs memory
const PACKED = ['EXT_texture_webp', 'EXT_texture_avif'];

/**
 * Textures from the file's own bytes. GLTFLoader would fetch them from `blob:` addresses, which strict policies forbid.
 * @returns {object} a plugin of GLTFLoader
 */
export const images = (parser) => ({
  name: 'faccia_images',
  /** @param {number} index of the texture */
  async loadTexture(index) {
    const { json } = parser;
    const { extensions = {}, source, sampler, name } = json.textures[index];
    const packed = PACKED.map((extension) => extensions[extension]?.source).find((one) => one !== undefined);
    const image = json.images[packed ?? source];
    const data = await parser.getDependency('bufferView', image.bufferView);
    const decoded = await createImageBitmap(new Blob([data], { type: image.mimeType }), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
    const texture = new Texture(await limited(decoded));
    const { wrapS = 10497, wrapT = 10497, magFilter } = json.samplers?.[sampler] ?? {};
    Object.assign(texture, {
      name: name ?? '',
      flipY: false,
      wrapS: WRAPS[wrapS] ?? RepeatWrapping,
      wrapT: WRAPS[wrapT] ?? RepeatWrapping,
      magFilter: magFilter === 9728 ? NearestFilter : LinearFilter,
      minFilter: LinearMipmapLinearFilter,
      needsUpdate: true,
    });
    parser.associations.set(texture, { textures: index });
    return texture;
  },
});

async function limited(image) {
  const share = MOST_SIDE / Math.max(image.width, image.height);
  if (share >= 1) return image;
  const [resizeWidth, resizeHeight] = [image.width, image.height].map((side) => Math.max(1, Math.round(side * share)));
  const smaller = await createImageBitmap(image, { resizeWidth, resizeHeight, resizeQuality: 'high', premultiplyAlpha: 'none' });
  image.close();
  return smaller;
}
