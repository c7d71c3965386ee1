// SPDX-License-Identifier: MIT
import { ModelError } from '../head/model/model.mjs';
import { pictureTrouble } from '../head/model/picture-size.mjs';
import { Region } from './morph.mjs';
import { isRegion } from './space.mjs';

const MOST_PIXELS = 1 << 25; // of a sheet

/** Whether what a server has sent is a set of pictures, not a head. */
export const isPictures = (json) => json?.format === 'faccia-pictures';

const positive = (...values) => values.every((value) => Number.isFinite(value) && value > 0);
const points = (list, count = null) =>
  Array.isArray(list) &&
  (count === null ? list.length > 2 : list.length === count) &&
  list.every((point) => point.length === 2 && point.every(Number.isFinite));

/**
 * Checks a set of pictures.
 * @param {object} json see protocol/pictures.md
 * @throws {ModelError} with what is wrong
 */
export function readPictures(json) {
  if (!isPictures(json) || json.version !== 1) throw new ModelError('not a set of pictures of version 1');
  const { width, height, frame, fapu, pivot, base, regions } = json;
  if (!positive(width, height, fapu?.MNS, fapu?.MW) || !points([pivot], 1) || !base?.data) throw new ModelError('the set has no measures, or no base');
  if (frame && !(positive(frame.width, frame.height) && frame.width <= width && frame.height <= height)) throw new ModelError('the frame of the set is not within it');
  for (const region of regions) checkRegion(region, json);
  return { ...json, title: json.title ?? json.name, credits: json.credits ?? [] };
}

function checkRegion(region, set) {
  const { name, x, y, width, height, mask, columns, sheet, pictures } = region;
  const damaged = (what) => new ModelError(`region ${name}: ${what}`);
  if (!isRegion(name)) throw damaged('nothing of the kind is known');
  if (!(x >= 0 && y >= 0) || !positive(width, height, columns) || x + width > set.width || y + height > set.height) throw damaged('it lies outside the base');
  if (!points(mask?.inner) || !points(mask?.outer)) throw damaged('it has no mask');
  if (!sheet?.data || !pictures?.length) throw damaged('it has no pictures');
  if (width * height * columns * Math.ceil(pictures.length / columns) > MOST_PIXELS) throw damaged('it is too large');
  for (const picture of pictures)
    if (picture.anchors ? name !== 'mouth' || !points(picture.anchors, 5) : name === 'mouth') throw damaged(`the anchors of ${picture.name}`);
}

/**
 * Makes a set ready to be drawn.
 * @param {ReturnType<typeof readPictures>} set
 * @returns {Promise<{base: ImageBitmap, regions: Region[]}>}
 */
export async function decodePictures(set) {
  const all = [['base', set.base], ...set.regions.map(({ name, sheet }) => [`region ${name}`, sheet])].map(([place, one]) => measured(place, one));
  const [base, ...sheets] = await Promise.all(all.map((one) => createImageBitmap(one)));
  const regions = set.regions.map((region, i) => new Region(region, cut(sheets[i], region), set.fapu));
  sheets.forEach((sheet) => sheet.close());
  return { base, regions };
}

/** @throws {ModelError} before anything is decoded @returns {Blob} */
function measured(place, { type, data }) {
  const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const trouble = pictureTrouble(bytes, MOST_PIXELS);
  if (trouble) throw new ModelError(`${place}: its picture ${trouble}`);
  return new Blob([bytes], { type });
}

/** The pictures of a sheet, row by row. @returns {Uint32Array[]} */
function cut(sheet, { name, width, height, columns, pictures }) {
  if (sheet.width < width * columns || sheet.height < height * Math.ceil(pictures.length / columns)) throw new ModelError(`region ${name}: its sheet is too small`);
  const canvas = document.createElement('canvas');
  canvas.width = sheet.width;
  canvas.height = sheet.height;
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(sheet, 0, 0);
  return pictures.map((_, i) => {
    const { data } = context.getImageData((i % columns) * width, Math.floor(i / columns) * height, width, height);
    return new Uint32Array(data.buffer);
  });
}
