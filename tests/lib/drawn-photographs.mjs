// SPDX-License-Identifier: GPL-3.0-or-later
// Synthetic photographs of the built-in heads, from any direction, in front of a grey wall.
import fs from 'node:fs';
import path from 'node:path';
import sharp from '../../models/node_modules/sharp/lib/index.js';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { drawHead } from '../../models/tools/lib/portrait.mjs';

/**
 * @param {string} heads folder @param {number} yaw degrees @param {(column: number, row: number) => number} wall brightness of the wall
 * @param {{faps?: object, width?: number, height?: number, change?: (head: object) => object}} [more] change: modifies the head before it is drawn
 */
export async function photograph(heads, name, yaw, wall = () => 200, { faps = {}, width = 300, height = 390, change = (head) => head } = {}) {
  const head = change(unpack(JSON.parse(fs.readFileSync(path.join(heads, `${name}.json`), 'utf8'))));
  const picture = await drawHead(head, { width, height, shadows: false, yaw, faps });
  for (let i = 0; i < picture.data.length; i += 4) {
    const clear = 1 - picture.data[i + 3] / 255;
    const grey = wall((i / 4) % picture.width, Math.floor(i / 4 / picture.width));
    for (let k = 0; k < 3; k++) picture.data[i + k] += clear * (grey - picture.data[i + k]);
    picture.data[i + 3] = 255;
  }
  return picture;
}

export const writePng = ({ data, width, height }, file) => sharp(data, { raw: { width, height, channels: 4 } }).png().toFile(file);
export const writeJpeg = ({ data, width, height }, file) => sharp(data, { raw: { width, height, channels: 4 } }).removeAlpha().jpeg({ quality: 92 }).toFile(file);
