// SPDX-License-Identifier: GPL-3.0-or-later
/** Reads files that a model refers to, only from its own folder and those below. */
import fs from 'node:fs';
import path from 'node:path';
import { MOST_PIXELS, pictureSize } from '../../../../web/element/head/model/picture-size.mjs';
import { FileError, MOST } from '../limits.mjs';

/** @param {string} file path of the model @param {string} name as written in it @param {string} place position of the name, for errors @returns {Buffer} */
export function readBeside(file, name, place) {
  const data = /^data:([^,;]*)(;base64)?,/.exec(name);
  if (data) {
    const text = name.slice(data[0].length);
    return data[2] ? Buffer.from(text, 'base64') : Buffer.from(decodeURIComponent(text));
  }
  const folder = fs.realpathSync(path.dirname(file));
  let wanted;
  try {
    wanted = fs.realpathSync(path.resolve(folder, decodeURIComponent(name.replaceAll('\\', '/'))));
  } catch {
    throw Object.assign(new FileError(place, `there is no file "${name.slice(0, 80)}" beside it`), { missing: true });
  }
  if (!wanted.startsWith(folder + path.sep)) throw new FileError(place, `"${name.slice(0, 80)}" leads out of the model's folder`);
  const { size } = fs.statSync(wanted);
  if (size > MOST.bytes) throw new FileError(place, `"${name.slice(0, 80)}" has ${size} bytes, more than ${MOST.bytes}`);
  return fs.readFileSync(wanted);
}

/** The same, but returns null with a note if the file is missing: many models refer to pictures on their author's machine. */
export function readIfBeside(file, name, place, notes) {
  const plain = path.basename(name.replaceAll('\\', '/'));
  for (const one of [name, plain]) {
    try {
      return readBeside(file, one, place);
    } catch (error) {
      if (!error.missing) throw error;
    }
  }
  notes.push(`${place}: there is no file "${plain.slice(0, 80)}" beside it: left out`);
  return null;
}

/** Reads a picture that a model refers to, or returns null with a note. */
export function pictureBeside(file, name, place, notes, budget) {
  const data = readIfBeside(file, name, place, notes);
  budget.keep((data?.length ?? 0) / 8, place);
  const seen = data && pictureOf(data);
  if (!data || isUsable(seen, data)) return data ? { ...seen, data } : null;
  notes.push(`${place}: ${NO_PICTURE}`);
  return null;
}

/** Tells whether a head may contain the picture, which pages will decode. */
export const isUsable = (seen, data) => data.length <= MOST.image && seen !== null && seen.width > 0 && seen.height > 0 && seen.width * seen.height <= MOST_PIXELS;
export const NO_PICTURE = `no PNG, JPEG or WebP of at most ${MOST.image} bytes and ${MOST_PIXELS} points: left out`;

/** Detects type and size of a picture from its header. @returns {{type, width, height}|null} */
export function pictureOf(bytes) {
  const type = typeOf(bytes);
  const size = type && pictureSize(bytes);
  return size ? { type, width: size[0], height: size[1] } : null;
}

/** Whether a PNG or WebP has an alpha channel, by its header. */
export function hasAlpha(bytes) {
  const type = typeOf(bytes);
  if (type === 'image/png') return [4, 6].includes(bytes[25]);
  if (type !== 'image/webp') return false;
  const kind = bytes.toString('latin1', 12, 16);
  return kind === 'VP8X' ? Boolean(bytes[20] & 0x10) : kind === 'VP8L' && Boolean(bytes[24] & 0x10);
}

function typeOf(bytes) {
  const text = (from, to) => bytes.toString('latin1', from, to);
  if (text(0, 4) === '\x89PNG') return 'image/png';
  if (text(0, 4) === 'RIFF' && text(8, 12) === 'WEBP') return 'image/webp';
  return text(0, 2) === '\xff\xd8' ? 'image/jpeg' : null;
}
