// SPDX-License-Identifier: MIT
// Bundles: bundle.md. A speech in one file, with its sound, its face, its words and perhaps its head.
import { OPUS_RATE } from './chunk/compact.mjs';
import { readFapcFile } from './fapc/fapcfile.mjs';
import { readOggOpus } from './ogg.mjs';

const MAGIC = 'FACCIA1\n';
const PART_BYTES = 8; // before the content of a part
const PART_MAX = 64 << 20;
const TEXT_MAX = 1 << 20; // bytes
const SECONDS_MAX = 7200;
const FRAMES_MAX = SECONDS_MAX * 120;
const EVENT_MAX = 1e6;
const ORDER = ['INFO', 'EVNT', 'FAPC', 'OPUS', 'HEAD', 'SUM '];
const OPTIONAL = 'HEAD';
const EVENTS = ['begin', 'sentence', 'speaker', 'word', 'phone', 'mark', 'end'];

/** A bundle that breaks the format; `at` is the byte where. */
export class BundleError extends Error {
  constructor(message, at) {
    super(`${message} (byte ${at})`);
    this.name = 'BundleError';
    this.reason = message;
    this.at = at;
  }
}

/**
 * @typedef {Object} Recording
 * @property {string} text @property {string|null} model address of the head
 * @property {object[]} events @property {number} fps @property {Int32Array[]} frames values by FAP number
 * @property {Uint8Array[]} packets of Opus, 20 ms each @property {number} skip @property {number} samples see readOggOpus
 * @property {Uint8Array|null} head gzip
 */

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; bit++) n = (n >>> 1) ^ (n & 1 ? 0xedb88320 : 0);
  return n;
});

/** CRC-32 of gzip and PNG. */
export function crc32(bytes) {
  let sum = -1;
  for (const byte of bytes) sum = (sum >>> 8) ^ TABLE[(sum ^ byte) & 255];
  return ~sum >>> 0;
}

const typeAt = (bytes, at) => String.fromCharCode(...bytes.subarray(at, at + 4));

/** @returns {Map<string, {at: number, data: Uint8Array}>} the known parts; at: the first byte of their content */
function partsOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const parts = new Map();
  for (let at = MAGIC.length; at < bytes.length; ) {
    if (parts.has('SUM ')) throw new BundleError('something follows the checksum', at);
    if (bytes.length - at < PART_BYTES) throw new BundleError('the file ends within the head of a part', at);
    const type = typeAt(bytes, at);
    const size = view.getUint32(at + 4, true);
    const known = ORDER.includes(type);
    if (!known && !/^[a-z]/.test(type)) throw new BundleError('a part that is not known here', at);
    if (size > PART_MAX) throw new BundleError('a part is larger than 64 MiB', at + 4);
    if (size > bytes.length - at - PART_BYTES) throw new BundleError('the file ends within a part', at);
    if (known && [...parts.keys()].some((other) => ORDER.indexOf(other) >= ORDER.indexOf(type))) throw new BundleError('a part is not in its place', at);
    if (type === 'SUM ' && (size !== 4 || view.getUint32(at + PART_BYTES, true) !== crc32(bytes.subarray(0, at))))
      throw new BundleError('the file is damaged: its checksum does not fit', at);
    if (known) parts.set(type, { at: at + PART_BYTES, data: bytes.subarray(at + PART_BYTES, at + PART_BYTES + size) });
    at += PART_BYTES + size;
  }
  const missing = ORDER.find((type) => type !== OPTIONAL && !parts.has(type));
  if (missing) throw new BundleError(`the part ${missing.trim()} is missing`, bytes.length);
  return parts;
}

/** @param {Uint8Array} data @param {number} at its first byte */
function readJson(data, at) {
  try {
    const value = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(data));
    if (value && typeof value === 'object' && !Array.isArray(value)) return value;
  } catch {
    // falls through
  }
  throw new BundleError('this is no JSON object', at);
}

const isCount = (value) => Number.isInteger(value) && value >= 0;
const isText = (value) => typeof value === 'string';
const isTime = (value) => typeof value === 'number' && value >= 0 && value <= SECONDS_MAX;
const isSpan = (event) => isTime(event.duration) && isCount(event.utf16_start) && isCount(event.utf16_end) && event.utf16_end >= event.utf16_start;
const FORMS = {
  begin: ({ fps }) => fps > 0,
  sentence: isSpan,
  speaker: ({ speaker, name }) => isText(speaker) && isText(name),
  word: (event) => isSpan(event) && isText(event.text),
  phone: ({ duration, ipa }) => isTime(duration) && isText(ipa),
  mark: ({ name }) => isText(name),
  end: ({ reason }) => isText(reason),
};

function readEvents({ at, data }) {
  const events = [];
  let last = 0;
  for (let from = 0; from < data.length; ) {
    const line = data.indexOf(10, from);
    if (line < 0) throw new BundleError('a line of the events is cut short', at + from);
    const event = readJson(data.subarray(from, line), at + from);
    const refuse = (message) => {
      throw new BundleError(message, at + from);
    };
    if (!EVENTS.includes(event.type)) refuse('an event that is not known here');
    if ((event.type === 'begin') !== !events.length || events.at(-1)?.type === 'end') refuse('begin is not the first event, or end not the last');
    const timed = event.type !== 'begin' && event.type !== 'end';
    if (!FORMS[event.type](event) || (timed && !isTime(event.time))) refuse(`a member of ${event.type} is missing or has another form`);
    if (timed && event.time < last) refuse('an event is not in the order of time');
    if (timed) last = event.time;
    if (events.push(event) > EVENT_MAX) refuse('there are more than a million events');
    from = line + 1;
  }
  if (events.at(-1)?.type !== 'end') throw new BundleError('the events have no end', at + data.length);
  return events;
}

/** Reads a part by another reader, whose errors have their place in the part. */
function inside({ at, data }, read) {
  try {
    return read(data);
  } catch (error) {
    if (error.at === undefined) throw error;
    throw new BundleError(error.reason, at + error.at);
  }
}

function media(face, sound) {
  const { fps, frames } = inside(face, (data) => readFapcFile(data, FRAMES_MAX));
  const opus = inside(sound, readOggOpus);
  if (opus.samples > SECONDS_MAX * OPUS_RATE) throw new BundleError('the sound is longer than two hours', sound.at);
  return { fps, frames, ...opus };
}

/** @param {Uint8Array} bytes of a `.faccia` file @returns {Recording} @throws {BundleError} */
export function readBundle(bytes) {
  if (String.fromCharCode(...bytes.subarray(0, MAGIC.length)) !== MAGIC) throw new BundleError('does not begin with FACCIA1', 0);
  const parts = partsOf(bytes);
  const { at, data } = parts.get('INFO');
  const info = data.length <= TEXT_MAX ? readJson(data, at) : {};
  if (!isText(info.text) || (info.model !== undefined && !isText(info.model))) throw new BundleError('a member of INFO is missing or has another form', at);
  const recording = { text: info.text, model: info.model ?? null, events: readEvents(parts.get('EVNT')), ...media(parts.get('FAPC'), parts.get('OPUS')) };
  if (recording.events[0].fps !== recording.fps) throw new BundleError('the frame rates of the events and of the face differ', parts.get('FAPC').at + 4);
  return { ...recording, head: parts.get('HEAD')?.data ?? null };
}

/**
 * The same of a face and its sound in two files. @param {Uint8Array} fapc @param {Uint8Array} ogg
 * @returns {Recording} @throws {FapcFileError|OggError}
 */
export function readPair(fapc, ogg) {
  const recording = { ...readFapcFile(fapc, FRAMES_MAX), ...readOggOpus(ogg) };
  const { fps, samples } = recording;
  const events = [{ type: 'begin', rate: OPUS_RATE, fps, markup: 'plain' }, { type: 'end', reason: 'done', duration: samples / OPUS_RATE }];
  return { text: '', model: null, events, head: null, ...recording };
}
