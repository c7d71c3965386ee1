// SPDX-License-Identifier: MIT
// What a page needs to turn pictures into a head: it is bundled with the finder of faces into portrait.js, beside which the
// nets lie.
// Pictures stay in the page: nothing here sends anything.
import { closeUp, detectorSettings, findFace } from './detect.mjs';
import { BEARDS, GLASSES, offerOf, OLDEST, wornOf } from './offer.mjs';
import { base64 } from './pack.mjs';
import { asProfile, inOrder, makeHead, nearest } from './portrait.mjs';
import { pictureSize, pictureTrouble } from '../element/head/model/picture-size.mjs';
import { PortraitError } from './problem.mjs';

export { PoseGuess } from './actions/guess.mjs';
export { LEFT_OUT, nameOf, POSES } from './actions/poses.mjs';
export { HANDLES, withMoved } from './landmarks.mjs';
export { boxOf, landmarksOf } from './look.mjs';
export { Calm, FaceReader, mayRest, mirrored } from './mirror.mjs';
export { TurnPicker } from './turn.mjs';
export { asProfile, BEARDS, GLASSES, inOrder, makeHead, nearest, offerOf, OLDEST, PortraitError, wornOf };

const LONGEST = 3000; // pixels: more is not needed for a texture
const MOST_PIXELS = 100e6;
const QUALITY = 0.9;

function canvasOf(width, height) {
  const canvas = Object.assign(document.createElement('canvas'), { width, height });
  return { canvas, context: canvas.getContext('2d', { willReadFrequently: true }) };
}

const HEADER_BYTES = 1 << 20; // before a photograph's own size may stand its thumbnail, colours and place

/** Looks at the header before anything is decoded: 31 kB may be gigabytes then. A kind that is not known the browser judges. */
async function measure(source) {
  const size = pictureSize(new Uint8Array(await source.slice(0, HEADER_BYTES).arrayBuffer()));
  if (size && size[0] * size[1] > MOST_PIXELS) throw new PortraitError('too_large', `the picture has more than ${MOST_PIXELS / 1e6} million pixels`);
}

/**
 * A picture as RGBA, upright, on grey where it is clear.
 * @param {Blob|HTMLVideoElement|HTMLCanvasElement} source @param {number} [longest] pixels of its longer side, at most
 * @returns {Promise<ImageData>} @throws {PortraitError}
 */
export async function readPicture(source, longest = LONGEST) {
  let image;
  if (source instanceof Blob) await measure(source);
  try {
    image = await createImageBitmap(source); // upright, as its camera says
  } catch (error) {
    throw new PortraitError('no_picture', `this is no picture that can be read (${error.message})`);
  }
  if (image.width * image.height > MOST_PIXELS) throw new PortraitError('too_large', `the picture has more than ${MOST_PIXELS / 1e6} million pixels`);
  const scale = Math.min(1, longest / Math.max(image.width, image.height));
  const { canvas, context } = canvasOf(Math.max(1, Math.round(image.width * scale)),
    Math.max(1, Math.round(image.height * scale)));
  context.fillStyle = '#c8ccd0';
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  image.close();
  return context.getImageData(0, 0, canvas.width, canvas.height);
}

/** Textures of heads, by the browser. */
export const textures = {
  async read({ type, data }) {
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    const trouble = pictureTrouble(bytes);
    if (trouble) throw new PortraitError('too_large', `a texture of the head ${trouble}`);
    const image = await createImageBitmap(new Blob([bytes], { type }), { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
    const { context } = canvasOf(image.width, image.height);
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height);
  },
  async write({ data, width, height }, { alpha = false } = {}) {
    const { canvas, context } = canvasOf(width, height);
    context.putImageData(new ImageData(data, width, height), 0, 0);
    const encode = (type) => new Promise((resolve) => canvas.toBlob(resolve, type, QUALITY));
    let blob = await encode('image/webp');
    if (blob.type !== 'image/webp') blob = await encode(alpha ? 'image/png' : 'image/jpeg'); // a browser that writes no WebP would give PNG
    return { type: blob.type, width, height, data: base64(new Uint8Array(await blob.arrayBuffer())) };
  },
};

let human = null;

/**
 * Loads the finder once. @param {string} folder where the nets lie, ends in "/" @returns {Promise<(picture: ImageData) =>
 * Promise<number[][]>>} its member closeUp(picture, box) where the face's place is known
 */
export async function openEye(folder) {
  human ??= (async () => {
    const { Human } = await import('@vladmandic/human'); // not before: it wants a page
    const one = new Human(detectorSettings(folder, folder));
    await one.load();
    return one;
  })();
  try {
    const ready = await human;
    const close = (picture, box, longest) => closeUp(ready, picture, box, longest);
    return Object.assign((picture) => findFace(ready, picture), { closeUp: close });
  } catch (error) {
    human = null;
    throw error;
  }
}
