// SPDX-License-Identifier: MIT
// What a calibration must be like, before anything is done with it.
import { pictureTrouble } from './picture-size.mjs';
import { ModelError } from './model-error.mjs';

/** How many feature points each group of ISO/IEC 14496-2 has. */
const GROUPS = { 2: 14, 3: 14, 4: 6, 5: 4, 6: 4, 7: 1, 8: 10, 9: 15, 10: 10, 11: 6 };
const FARTHEST = 1000; // mm
const MOST_PIXELS = 1 << 22; // of a texture, as server/rooms/notices.h has it

/** @param {string} name such as "8.4" */
export function isFeaturePoint(name) {
  const match = /^([1-9]\d?)\.([1-9]\d?)$/.exec(name);
  return Boolean(match) && Number(match[2]) <= (GROUPS[match[1]] ?? 0);
}

const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);

function checkPoints(points, at, width, what, fits) {
  if (!isObject(points)) throw new ModelError(at, 'must be an object of feature points');
  for (const [name, value] of Object.entries(points)) {
    if (!isFeaturePoint(name)) throw new ModelError(`${at}.${name}`, 'there is no such feature point: 2.1 to 11.6, as ISO/IEC 14496-2 numbers them');
    if (!Array.isArray(value) || value.length !== width || !value.every(fits)) throw new ModelError(`${at}.${name}`, `must be ${what}`);
  }
  return Object.keys(points).length;
}

/** @throws {ModelError} with the place of what is wrong */
export function checkCalibration(calibration, prefix = '') {
  if (!isObject(calibration)) throw new ModelError(prefix.replace(/\.$/, ''), 'must be an object');
  const { featurePointsCoord, textureCoord, texture } = calibration;
  const inHead = (value) => Number.isFinite(value) && Math.abs(value) <= FARTHEST;
  const count = checkPoints(featurePointsCoord, `${prefix}featurePointsCoord`, 3, `three numbers of at most ${FARTHEST} mm`, inHead);
  if (!count) throw new ModelError(`${prefix}featurePointsCoord`, 'there are none');
  const inPicture = (value) => Number.isFinite(value) && value >= 0 && value <= 1;
  if (textureCoord !== undefined) {
    checkPoints(textureCoord, `${prefix}textureCoord`, 2, 'two numbers from 0 to 1', inPicture);
    if (texture === undefined) throw new ModelError(`${prefix}texture`, 'is missing: textureCoord are places on it');
  }
  if (texture === undefined) return;
  if (!isObject(texture)) throw new ModelError(`${prefix}texture`, 'must be an object');
  if (typeof texture.type !== 'string' || !/^image\/(png|jpeg|webp)$/.test(texture.type))
    throw new ModelError(`${prefix}texture.type`, 'must be image/png, image/jpeg or image/webp');
  const { data } = texture;
  if (typeof data !== 'string' || !data || data.length % 4 || !/^[A-Za-z0-9+/]*={0,2}$/.test(data))
    throw new ModelError(`${prefix}texture.data`, 'must be base64');
  const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const trouble = pictureTrouble(bytes, MOST_PIXELS, [texture.type.slice('image/'.length)]);
  if (trouble) throw new ModelError(`${prefix}texture.data`, trouble);
}
