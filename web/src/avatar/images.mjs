// SPDX-License-Identifier: MIT
import { ClampToEdgeWrapping, LinearFilter, LinearMipmapLinearFilter, MirroredRepeatWrapping, NearestFilter, RepeatWrapping, Texture } from 'three';
import { unpacker } from './unpackers.mjs';

const WRAPS = { 33071: ClampToEdgeWrapping, 33648: MirroredRepeatWrapping, 10497: RepeatWrapping };
const MOST_SIDE = 2048; // pixels: more of a face is not seen, and costs memory
const PLAIN = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };

/**
 * Textures from the file's own bytes. GLTFLoader would fetch them from `blob:` addresses, which strict policies forbid.
 * @returns {object} a plugin of GLTFLoader
 */
export const images = (parser) => ({
  name: 'faccia_images',
  /** @param {number} index of the texture */
  async loadTexture(index) {
    const { json } = parser;
    const { source, sampler, name } = json.textures[index];
    const image = json.images[source];
    const data = await parser.getDependency('bufferView', image.bufferView);
    const decoded = await createImageBitmap(await pictureIn(data, image.mimeType), PLAIN);
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

async function pictureIn(data, type) {
  if (type !== 'image/ktx2') return new Blob([data], { type });
  const basis = await unpacker('basis');
  const { data: points, width, height } = basis.decode(new Uint8Array(data), MOST_SIDE);
  return new ImageData(points, width, height);
}

async function limited(image) {
  const share = MOST_SIDE / Math.max(image.width, image.height);
  if (share >= 1) return image;
  const [resizeWidth, resizeHeight] = [image.width, image.height].map((side) => Math.max(1, Math.round(side * share)));
  const smaller = await createImageBitmap(image, { resizeWidth, resizeHeight, resizeQuality: 'high', premultiplyAlpha: 'none' });
  image.close();
  return smaller;
}
