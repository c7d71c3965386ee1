// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Reads marker tracks from a C3D file (www.c3d.org): blocks of 512 bytes (a header, parameters by group and name, frames), numbers in the format
 * of Intel, DEC or MIPS, coordinates as integers or floats. Skips analogue channels.
 */
import { FileError, MOST } from '../import/limits.mjs';
import { Tracks } from './tracks.mjs';

const BLOCK = 512;
const KEY = 0x50;
const [INTEL, DEC, MIPS] = [84, 85, 86];
const TYPES = { '-1': 1, 1: 1, 2: 2, 4: 4 }; // bytes of an element
const MOST_PARAMETERS = 10000;

/** Reads numbers of the three machine formats; reports positions outside the file with their byte. */
class Bytes {
  constructor(buffer) {
    this.view = new DataView(buffer.buffer, buffer.byteOffset, buffer.length);
    this.kind = INTEL;
  }

  need(at, count) {
    if (at < 0 || at + count > this.view.byteLength) throw new FileError(`byte ${at}`, `${count} bytes are wanted there, and the file has ${this.view.byteLength}`);
  }

  byte(at) {
    this.need(at, 1);
    return this.view.getUint8(at);
  }

  signed(at) {
    this.need(at, 1);
    return this.view.getInt8(at);
  }

  short(at) {
    this.need(at, 2);
    return this.view.getInt16(at, this.kind !== MIPS);
  }

  word(at) {
    return this.short(at) & 0xffff;
  }

  /** DEC swaps the words, and its exponent is larger by 2. */
  float(at) {
    this.need(at, 4);
    if (this.kind !== DEC) return this.view.getFloat32(at, this.kind === INTEL);
    const words = new DataView(new ArrayBuffer(4));
    words.setUint16(0, this.word(at));
    words.setUint16(2, this.word(at + 2));
    return words.getFloat32(0) / 4;
  }

  text(at, count) {
    this.need(at, count);
    return Array.from({ length: count }, (_, i) => String.fromCharCode(this.view.getUint8(at + i))).join('');
  }
}

/** @returns {Map<string, {type: number, sizes: number[], at: number, count: number}>} by "GROUP:NAME" */
function parametersOf(bytes, start) {
  const groups = new Map();
  const found = [];
  let at = start + 4;
  for (let n = 0; ; n++) {
    if (n > MOST_PARAMETERS) throw new FileError(`byte ${at}`, `there are more than ${MOST_PARAMETERS} parameters`);
    const length = Math.abs(bytes.signed(at));
    if (!length) break;
    const group = bytes.signed(at + 1);
    if (!group) break;
    const name = bytes.text(at + 2, length).trim().toUpperCase();
    const link = at + 2 + length;
    if (group < 0) groups.set(-group, name);
    else found.push({ group, name, ...elementsAt(bytes, link + 2, name) });
    const next = bytes.word(link);
    if (!next) break; // the last one
    at = link + next;
  }
  return new Map(found.map(({ group, name, ...rest }) => [`${groups.get(group)}:${name}`, rest]));
}

function elementsAt(bytes, at, name) {
  const type = bytes.signed(at);
  if (!TYPES[type]) throw new FileError(`byte ${at}`, `the parameter ${name} has elements of no known kind (${type})`);
  const sizes = Array.from({ length: bytes.byte(at + 1) }, (_, i) => bytes.byte(at + 2 + i));
  const count = sizes.reduce((a, b) => a * b, 1);
  if (sizes.length > 7) throw new FileError(`byte ${at + 1}`, `the parameter ${name} has ${sizes.length} dimensions: at most 7`);
  bytes.need(at + 2 + sizes.length, count * TYPES[type]);
  return { type, sizes, at: at + 2 + sizes.length, count };
}

function reader(bytes, parameters) {
  const number = (key) => {
    const found = parameters.get(key);
    if (!found?.count || found.type < 0) return null;
    return found.type === 4 ? bytes.float(found.at) : found.type === 2 ? bytes.word(found.at) : bytes.byte(found.at);
  };
  const words = (key) => {
    const found = parameters.get(key);
    if (!found || found.type !== -1 || !found.sizes[0]) return [];
    const [length] = found.sizes;
    return Array.from({ length: found.count / length }, (_, i) => bytes.text(found.at + i * length, length).trim());
  };
  /** A count that exceeds one word takes two. */
  const long = (key) => {
    const found = parameters.get(key);
    return found?.type === 2 && found.count >= 2 ? bytes.word(found.at) + bytes.word(found.at + 2) * 65536 : null;
  };
  return { number, words, long };
}

function framesOf(bytes, { number, long }) {
  const [first, last] = [long('TRIAL:ACTUAL_START_FIELD') ?? bytes.word(6), long('TRIAL:ACTUAL_END_FIELD') ?? bytes.word(8)];
  const count = last - first + 1;
  if (!(count > 0)) throw new FileError('byte 6', `the frames go from ${first} to ${last}: there are none`);
  const rate = number('POINT:RATE') || bytes.float(20);
  if (!(rate > 0 && rate <= 10000)) throw new FileError('byte 20', `${rate} frames per second cannot be`);
  return { count, rate };
}

/** @param {Buffer} buffer @returns {Tracks} @throws {FileError} */
export function readC3d(buffer) {
  const bytes = new Bytes(buffer);
  if (bytes.byte(1) !== KEY) throw new FileError('byte 1', 'this is no C3D file');
  const start = (bytes.byte(0) - 1) * BLOCK;
  bytes.kind = bytes.byte(start + 3);
  if (![INTEL, DEC, MIPS].includes(bytes.kind)) throw new FileError(`byte ${start + 3}`, `numbers of kind ${bytes.kind}: 84, 85 and 86 are known`);
  const parameters = parametersOf(bytes, start);
  const read = reader(bytes, parameters);
  const points = bytes.word(2);
  const { count, rate } = framesOf(bytes, read);
  if (!points) throw new FileError('byte 2', 'there are no markers');
  if (points * count * 3 > MOST.numbers) throw new FileError('byte 6', `${points} markers in ${count} frames: at most ${MOST.numbers / 3} places are read`);
  const scale = read.number('POINT:SCALE') ?? bytes.float(12);
  const wide = scale < 0 ? 4 : 2;
  const stride = (points * 4 + bytes.word(4)) * wide;
  const at = ((read.number('POINT:DATA_START') || bytes.word(16)) - 1) * BLOCK;
  bytes.need(at, stride * count);
  const labels = ['POINT:LABELS', ...Array.from({ length: 8 }, (_, i) => `POINT:LABELS${i + 2}`)].flatMap(read.words);
  const tracks = new Tracks(Array.from({ length: points }, (_, i) => labels[i] || `marker ${i + 1}`), rate, read.words('POINT:UNITS')[0]);
  const one = (place) => (wide === 4 ? bytes.float(place) : bytes.short(place) * scale);
  for (let frame = 0; frame < count; frame++)
    tracks.add(frame / rate, (point) => {
      const place = at + frame * stride + point * 4 * wide;
      const lost = (wide === 4 ? bytes.float(place + 12) : bytes.short(place + 6)) < 0; // a residual of -1: not seen
      return lost ? null : [one(place), one(place + wide), one(place + 2 * wide)];
    });
  return tracks;
}
