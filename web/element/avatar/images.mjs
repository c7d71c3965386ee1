// SPDX-License-Identifier: MIT
import { ClampToEdgeWrapping, LinearFilter, LinearMipmapLinearFilter, MirroredRepeatWrapping, NearestFilter, RepeatWrapping, Texture } from 'three';
import { MOST_PIXELS, pictureKind, pictureSize } from '../head/model/picture-size.mjs';
import { AvatarProblem } from './problem.mjs';
import { unpacker } from './unpackers.mjs';

const WRAPS = { 33071: ClampToEdgeWrapping, 33648: MirroredRepeatWrapping, 10497: RepeatWrapping };
const MOST_SIDE = 2048; // pixels: more of a face is not seen, and costs memory
const MOST_ALL = 1 << 28; // of all pictures
const READ = ['png', 'jpeg', 'webp', 'avif', 'ktx2'];
const PLAIN = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };

/**
 * Textures from the file's own bytes. GLTFLoader would fetch them from `blob:` addresses, which strict policies forbid.
 * @returns {object} a plugin of GLTFLoader
 */
export const images = (parser) => {
  const budget = { left: MOST_ALL };
  return { name: 'faccia_images', loadTexture: (index) => textureOf(parser, index, budget) };
};

/** @param {number} index of the texture @returns {Promise<Texture|null>} null: it has no picture */
async function textureOf(parser, index, budget) {
  const { json } = parser;
  const { source, sampler, name } = json.textures[index];
  if (source === undefined) return null;
  const place = `images[${source}]`;
  const image = json.images?.[source];
  if (!image) throw new AvatarProblem('damaged', `textures[${index}]: there is no ${place}`);
  const data = await parser.getDependency('bufferView', image.bufferView);
  const bytes = new Uint8Array(data);
  const size = READ.includes(pictureKind(bytes)) && pictureSize(bytes);
  if (!size) throw new AvatarProblem('damaged', `${place}: is no PNG, JPEG, WebP, AVIF or KTX2`);
  const points = size[0] * size[1];
  budget.left -= points;
  if (points > MOST_PIXELS || budget.left < 0) {
    const beside = points > MOST_PIXELS ? '' : ', beside those of the others,';
    throw new AvatarProblem('too-large', `${place}: ${size.join(' x ')} points${beside} are too many`);
  }
  const decoded = await pictureIn(data, pictureKind(bytes))
    .then((picture) => createImageBitmap(picture, PLAIN))
    .catch((error) => {
      throw error instanceof AvatarProblem ? error : new AvatarProblem('damaged', `${place}: cannot be decoded (${error.message})`);
    });
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
}

async function pictureIn(data, kind) {
  if (kind !== 'ktx2') return new Blob([data], { type: `image/${kind}` });
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
