// SPDX-License-Identifier: GPL-3.0-or-later
/** The files that a model names: only those in its own folder or below it are read. */
import fs from 'node:fs';
import path from 'node:path';
import { FileError, MOST } from './file-error.mjs';

/** @param {string} file the model's @param {string} name as it stands there @param {string} place of that @returns {Buffer} */
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

/** The same, or null where it is not there and that is noted: many a file has the place of a picture on its maker's machine, and comes without it. */
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

/** A picture that a model names, or null: then it is noted why. */
export function pictureBeside(file, name, place, notes) {
  const data = readIfBeside(file, name, place, notes);
  const seen = data && data.length <= MOST.image && pictureOf(data);
  if (data && !seen?.width) notes.push(`${place}: no PNG, JPEG or WebP of at most ${MOST.image} bytes: left out`);
  return seen?.width ? { ...seen, data } : null;
}

/** What kind of picture it is, and its size, from its first bytes. @returns {{type, width, height}|null} */
export function pictureOf(bytes) {
  if (bytes.length > 24 && bytes.readUInt32BE(0) === 0x89504e47) return { type: 'image/png', width: bytes.readUInt32BE(16), height: bytes.readUInt32BE(20) };
  if (bytes.length > 30 && bytes.toString('latin1', 0, 4) === 'RIFF' && bytes.toString('latin1', 8, 12) === 'WEBP') return webpOf(bytes);
  if (bytes.length > 4 && bytes.readUInt16BE(0) === 0xffd8) {
    for (let at = 2; at + 9 < bytes.length && bytes[at] === 0xff; at += 2 + bytes.readUInt16BE(at + 2)) {
      const mark = bytes[at + 1];
      if (mark >= 0xc0 && mark <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(mark))
        return { type: 'image/jpeg', width: bytes.readUInt16BE(at + 7), height: bytes.readUInt16BE(at + 5) };
    }
  }
  return null;
}

function webpOf(bytes) {
  const type = 'image/webp';
  const kind = bytes.toString('latin1', 12, 16);
  if (kind === 'VP8X') return { type, width: 1 + bytes.readUIntLE(24, 3), height: 1 + bytes.readUIntLE(27, 3) };
  if (kind === 'VP8L') {
    const bits = bytes.readUInt32LE(21);
    return { type, width: 1 + (bits & 0x3fff), height: 1 + ((bits >> 14) & 0x3fff) };
  }
  return { type, width: bytes.readUInt16LE(26) & 0x3fff, height: bytes.readUInt16LE(28) & 0x3fff };
}
