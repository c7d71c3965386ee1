// SPDX-License-Identifier: MIT
// Media chunks, version 1: ../README.md, section "Media chunks".
import { FAP_COUNT } from '../fap.mjs';

export const AUDIO_SILENCE = 0;
export const AUDIO_PCM_S16LE = 1;
export const FAP_NONE = 0;
export const FAP_PLAIN = 1;

const HEADER_BYTES = 32;
const MASK_BYTES = 9;
const MAGIC = 0x46;
const VERSION = 1;

/** A chunk that breaks the format; `at` is the byte where. */
export class ChunkError extends Error {
  constructor(message, at) {
    super(`${message} (byte ${at})`);
    this.name = 'ChunkError';
    this.reason = message;
    this.at = at;
  }
}

/**
 * @typedef {Object} Chunk
 * @property {number} utterance
 * @property {number} sampleRate Hz
 * @property {number} fps frames per second
 * @property {number} start first sample, counted from the utterance's beginning
 * @property {number} samples duration
 * @property {number} firstFrame number of the first frame; frame k stands at k / fps seconds
 * @property {number} audioCodec AUDIO_*
 * @property {Int16Array|null} audio a copy; null for silence
 * @property {number} fapCodec FAP_*
 * @property {Int32Array[]} frames values by FAP number; entries 0, 1 and 2 are 0
 * @property {Uint8Array[]} visemes FAP 1 of each frame: select1, select2, blend, def
 * @property {Uint8Array[]} expressions FAP 2 of each frame: select1, intensity1, select2, intensity2,
 *   init_face, def
 */

const limits = [
  [0, MAGIC, MAGIC, 'not a media chunk'],
  [1, VERSION, VERSION, 'a version that is not known here'],
  [2, 0, AUDIO_PCM_S16LE, 'an audio codec that is not known here'],
  [3, 0, FAP_PLAIN, 'a FAP codec that is not known here'],
];

function readHeader(bytes, view) {
  for (const [at, low, high, wrong] of limits) {
    if (bytes.length <= at) throw new ChunkError('the header is cut short', at);
    if (bytes[at] < low || bytes[at] > high) throw new ChunkError(wrong, at);
  }
  if (bytes.length < HEADER_BYTES) throw new ChunkError('the header is cut short', bytes.length);
  const chunk = {
    audioCodec: bytes[2],
    fapCodec: bytes[3],
    utterance: view.getUint32(4, true),
    sampleRate: view.getUint32(8, true),
    fps: view.getUint16(12, true) / 100,
    frameCount: view.getUint16(14, true),
    start: view.getUint32(16, true),
    samples: view.getUint32(20, true),
    firstFrame: view.getUint32(24, true),
    audioBytes: view.getUint32(28, true),
  };
  if (!chunk.sampleRate) throw new ChunkError('a sample rate of 0', 8);
  if (!chunk.fps) throw new ChunkError('a frame rate of 0', 12);
  if (chunk.fapCodec === FAP_NONE && chunk.frameCount) throw new ChunkError('frames without a codec', 14);
  if (chunk.audioBytes > bytes.length - HEADER_BYTES) throw new ChunkError('the audio is cut short', 28);
  if (chunk.audioBytes !== (chunk.audioCodec === AUDIO_SILENCE ? 0 : chunk.samples * 2))
    throw new ChunkError("the audio's length is not that of its samples", 28);
  return chunk;
}

/** Reads the plain FAP codec from byte `at` on. */
class FrameReader {
  constructor(bytes, at) {
    this.bytes = bytes;
    this.at = at;
    this.values = new Int32Array(FAP_COUNT + 1);
    this.viseme = new Uint8Array(4);
    this.expression = new Uint8Array(6);
  }

  /** Steps over `count` bytes; returns where they begin. */
  skip(count, wrong = 'a value is cut short') {
    const begin = this.at;
    if (this.bytes.length - begin < count) throw new ChunkError(wrong, begin);
    this.at += count;
    return begin;
  }

  varint() {
    let value = 0;
    for (let shift = 0; shift < 35; shift += 7) {
      const byte = this.bytes[this.skip(1)];
      if (shift === 28 && byte > 0x0f) break;
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return (value >>> 1) ^ -(value & 1);
    }
    throw new ChunkError('a value is longer than 32 bits', this.at - 1);
  }

  next() {
    const { bytes, values } = this;
    const mask = this.skip(MASK_BYTES, "a frame's mask is cut short");
    if (bytes[this.at - 1] & 0xf0) throw new ChunkError('the mask names a FAP above 68', this.at - 1);
    if (bytes[mask] & 1) this.viseme = bytes.slice(this.skip(4), this.at);
    if (bytes[mask] & 2) this.expression = bytes.slice(this.skip(6), this.at);
    for (let n = 3; n <= FAP_COUNT; n++)
      if ((bytes[mask + ((n - 1) >> 3)] >> ((n - 1) & 7)) & 1) values[n] += this.varint();
    return values.slice();
  }
}

/**
 * @param {ArrayBuffer|Uint8Array} data
 * @returns {Chunk}
 * @throws {ChunkError}
 */
export function decodeChunk(data) {
  // A new view in any case: slice() of Node's Buffer does not copy.
  const { buffer, byteOffset, byteLength } = ArrayBuffer.isView(data) ? data : new Uint8Array(data);
  const bytes = new Uint8Array(buffer, byteOffset, byteLength);
  const view = new DataView(buffer, byteOffset, byteLength);
  const { frameCount, audioBytes, ...chunk } = readHeader(bytes, view);
  const end = HEADER_BYTES + audioBytes;
  const silent = chunk.audioCodec === AUDIO_SILENCE;
  chunk.audio = silent ? null : new Int16Array(bytes.slice(HEADER_BYTES, end).buffer);
  chunk.frames = [];
  chunk.visemes = [];
  chunk.expressions = [];
  const reader = new FrameReader(bytes, end);
  for (let i = 0; i < frameCount; i++) {
    chunk.frames.push(reader.next());
    chunk.visemes.push(reader.viseme);
    chunk.expressions.push(reader.expression);
  }
  if (reader.at !== bytes.length) throw new ChunkError('bytes after the last frame', reader.at);
  return chunk;
}

/** Little-endian. */
function putNumber(out, count, value) {
  if (!Number.isInteger(value) || value < 0 || value >= 256 ** count)
    throw new RangeError(`${value} does not fit ${count} bytes`);
  for (let i = 0; i < count; i++) out.push(Math.floor(value / 256 ** i) % 256);
}

function putVarint(out, difference) {
  let value = ((difference << 1) ^ (difference >> 31)) >>> 0;
  for (; value >= 0x80; value >>>= 7) out.push((value & 0x7f) | 0x80);
  out.push(value);
}

function putFrame(out, values, viseme, expression, before) {
  const at = out.length;
  for (let i = 0; i < MASK_BYTES; i++) out.push(0);
  const differs = (a, b) => a.some((value, i) => value !== b[i]);
  if (differs(viseme, before.viseme)) {
    out[at] |= 1;
    out.push(...viseme);
  }
  if (differs(expression, before.expression)) {
    out[at] |= 2;
    out.push(...expression);
  }
  for (let n = 3; n <= FAP_COUNT; n++) {
    const difference = (values[n] - before.values[n]) | 0;
    if (!difference) continue;
    out[at + ((n - 1) >> 3)] |= 1 << ((n - 1) & 7);
    putVarint(out, difference);
  }
}

function checkForEncoding({ audioCodec, fapCodec, sampleRate, fps, samples, frames }, audioBytes) {
  const check = (fine, name) => {
    if (!fine) throw new RangeError(`a media chunk cannot have this ${name}`);
  };
  check(audioCodec === AUDIO_SILENCE || audioCodec === AUDIO_PCM_S16LE, 'audioCodec');
  check(audioBytes === (audioCodec === AUDIO_SILENCE ? 0 : samples * 2), 'audio');
  check(fapCodec === FAP_PLAIN || (fapCodec === FAP_NONE && frames.length === 0), 'frames');
  check(sampleRate > 0, 'sampleRate');
  check(Math.round(fps * 100) > 0, 'fps');
}

/**
 * @param {Chunk} chunk visemes and expressions may be left out
 * @returns {Uint8Array}
 * @throws {RangeError} when a member is out of range
 */
export function encodeChunk(chunk) {
  const audioBytes = chunk.audio?.byteLength ?? 0;
  checkForEncoding(chunk, audioBytes);
  const out = [MAGIC, VERSION, chunk.audioCodec, chunk.fapCodec];
  putNumber(out, 4, chunk.utterance);
  putNumber(out, 4, chunk.sampleRate);
  putNumber(out, 2, Math.round(chunk.fps * 100));
  putNumber(out, 2, chunk.frames.length);
  putNumber(out, 4, chunk.start);
  putNumber(out, 4, chunk.samples);
  putNumber(out, 4, chunk.firstFrame);
  putNumber(out, 4, audioBytes);
  let before = {
    values: new Int32Array(FAP_COUNT + 1),
    viseme: Array(4).fill(0),
    expression: Array(6).fill(0),
  };
  chunk.frames.forEach((values, i) => {
    const viseme = chunk.visemes?.[i] ?? before.viseme;
    const expression = chunk.expressions?.[i] ?? before.expression;
    putFrame(out, values, viseme, expression, before);
    before = { values, viseme, expression };
  });
  const bytes = new Uint8Array(out.length + audioBytes);
  bytes.set(out.slice(0, HEADER_BYTES));
  const { audio } = chunk;
  if (audio) bytes.set(new Uint8Array(audio.buffer, audio.byteOffset, audioBytes), HEADER_BYTES);
  bytes.set(out.slice(HEADER_BYTES), HEADER_BYTES + audioBytes);
  return bytes;
}
