// SPDX-License-Identifier: GPL-3.0-or-later
/** Encodes numbers as base64 of little-endian arrays, as specified in protocol/head-model.md. */

const WIDTH = { int16: 2, uint16: 2, uint8: 1 };
const WRITE = { int16: 'writeInt16LE', uint16: 'writeUInt16LE', uint8: 'writeUInt8' };
const READ = { int16: 'readInt16LE', uint16: 'readUInt16LE', uint8: 'readUInt8' };

/** @param {'int16'|'uint16'|'uint8'} type */
export function encode(type, numbers) {
  const buffer = Buffer.alloc(numbers.length * WIDTH[type]);
  for (let i = 0; i < numbers.length; i++) buffer[WRITE[type]](numbers[i], i * WIDTH[type]);
  return buffer.toString('base64');
}

/** @returns {number[]} */
export function decode(type, text) {
  const buffer = Buffer.from(text, 'base64');
  const out = new Array(buffer.length / WIDTH[type]);
  for (let i = 0; i < out.length; i++) out[i] = buffer[READ[type]](i * WIDTH[type]);
  return out;
}

/** Three axes as int16 with one scale and one offset for each axis: value * scale + offset. */
export function encodePositions(p) {
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < p.length; i++) {
    low[i % 3] = Math.min(low[i % 3], p[i]);
    high[i % 3] = Math.max(high[i % 3], p[i]);
  }
  const offset = low.map((x, k) => round((x + high[k]) / 2, 1e3));
  const reach = Math.max(...high.map((x, k) => Math.max(x - offset[k], offset[k] - low[k])));
  const scale = Math.ceil((reach / 32767) * 1e7) / 1e7;
  return {
    data: encode(
      'int16',
      Array.from(p, (x, i) => Math.round((x - offset[i % 3]) / scale)),
    ),
    scale,
    offset,
  };
}

/** Three axes as int16 with one scale, no offset. */
export function encodeDeltas(d) {
  const reach = d.reduce((m, x) => Math.max(m, Math.abs(x)), 1e-6);
  const scale = Math.ceil((reach / 32767) * 1e9) / 1e9;
  return {
    data: encode(
      'int16',
      Array.from(d, (x) => Math.round(x / scale)),
    ),
    scale,
  };
}

export function round(x, steps) {
  return Math.round(x * steps) / steps || 0;
}
