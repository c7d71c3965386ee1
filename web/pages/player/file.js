// SPDX-License-Identifier: MIT
// FAP files: .fap (text), .fapc and FBA (coded) read, .fap written. No page needed: tests/web reads this.
export const FAPS = 68;
export const FRAMES_MAX = 180000; // two hours at 25 a second: seconds of work, of a .fapc as of a .fap

/**
 * @typedef {{name: string, fps: number, frames: Int32Array[], high: number[][]}} Faps frames: by FAP number, from 3 on; high:
 *   FAP 1 and 2 as they were
 */

class FileError extends Error {
  constructor(message, place) {
    super(message);
    Object.assign(this, place, { code: 'bad-fap' });
  }
}

/** A face at rest. @param {number} fps @param {number} seconds @returns {Faps} */
export function emptyFaps(fps, seconds) {
  const count = Math.max(1, Math.min(FRAMES_MAX, Math.round(fps * seconds)));
  return { name: 'faccia', fps, frames: Array.from({ length: count }, () => new Int32Array(FAPS + 1)), high: [] };
}

/** @param {string} text @returns {Faps} */
export function readFap(text) {
  const lines = text.split(/\r?\n/);
  const header = lines[0].trim().split(/\s+/);
  const versioned = /^2\.[01]$/.test(header[0]) && header.length === 4;
  const fps = versioned ? Number(header[2]) : header.length === 2 ? Number(header[0]) : 25;
  if (!(fps > 0 && fps <= 1000)) throw new FileError('no frame rate', { line: 1, column: 1 });
  const frames = [];
  const high = [];
  let first = header.length <= 4 && header.length !== FAPS ? 1 : 0;
  for (; first < lines.length; first += 2) {
    if (!lines[first].trim()) {
      first--;
      continue;
    }
    const flags = lines[first].trim().split(/\s+/);
    if (flags.length < FAPS || flags.some((flag) => flag !== '0' && flag !== '1'))
      throw new FileError('68 flags were expected', { line: first + 1, column: 1 });
    const values = (lines[first + 1] ?? '').trim().split(/\s+/).map(Number);
    const previous = frames.at(-1);
    const frame = previous ? Int32Array.from(previous) : new Int32Array(FAPS + 1);
    let at = 1; // the frame's number comes first
    const own = [];
    flags.slice(0, FAPS).forEach((flag, i) => {
      if (flag === '0') return;
      const size = i === 0 ? 4 : i === 1 ? 6 : 1;
      if (at + size > values.length || values.slice(at, at + size).some((value) => !Number.isInteger(value)))
        throw new FileError('a value is missing, or no whole number', { line: first + 2, column: 1 });
      if (i > 1) frame[i + 1] = values[at];
      else own[i] = values.slice(at, at + size);
      at += size;
    });
    frames.push(frame);
    high.push(own);
    if (frames.length > FRAMES_MAX) throw new FileError('too many frames', { line: first + 1, column: 1 });
  }
  if (!frames.length) throw new FileError('no frames', { line: 1, column: 1 });
  return { name: versioned ? header[1] : 'faccia', fps, frames, high };
}

/** @param {Uint8Array} bytes */
export const isFapc = (bytes) => String.fromCharCode(...bytes.subarray(0, 4)) === 'FPC1';

/**
 * @param {Uint8Array} bytes
 * @param {Function} read readFapcFile of protocol/fapc/fapcfile.mjs, or readFba of protocol/fba/fba.mjs
 * @returns {Faps}
 */
export function readCoded(bytes, read) {
  try {
    const { fps, frames, high } = read(bytes, FRAMES_MAX);
    return { name: 'faccia', fps, frames, high };
  } catch (error) {
    if (error.at === undefined) throw error;
    throw new FileError(error.reason, { byte: error.at });
  }
}

/** Fills in the length, which a streamed WAV lacks. @param {ArrayBuffer} buffer @returns {ArrayBuffer} */
export function wholeWav(buffer) {
  const view = new DataView(buffer);
  if (view.getUint32(4, true) === 0xffffffff) view.setUint32(4, buffer.byteLength - 8, true);
  for (let at = 12; at + 8 <= buffer.byteLength; ) {
    const size = view.getUint32(at + 4, true);
    if (size === 0xffffffff) view.setUint32(at + 4, buffer.byteLength - at - 8, true);
    at += 8 + (size === 0xffffffff ? buffer.byteLength : size + (size & 1));
  }
  return buffer;
}

/** @param {Faps} faps @returns {string} a .fap file, version 2.1; FAPs 1 and 2 as they were read */
export function writeFap({ name, fps, frames, high }) {
  const out = [`2.1 ${name.replace(/\s+/g, '_') || 'faccia'} ${fps} ${frames.length}`];
  frames.forEach((frame, k) => {
    const own = high[k] ?? [];
    const flags = Array.from({ length: FAPS }, (_, i) => (i > 1 || own[i] ? 1 : 0));
    out.push(flags.join(' '), [k, ...(own[0] ?? []), ...(own[1] ?? []), ...frame.slice(3, FAPS + 1)].join(' '));
  });
  return `${out.join('\n')}\n`;
}
