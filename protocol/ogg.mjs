// SPDX-License-Identifier: MIT
// Reads Opus in Ogg (RFC 3533, RFC 7845): one stream, mono, packets of 20 ms, as faccia writes it.
import { OPUS_PACKET_SAMPLES } from './chunk/compact.mjs';

const PAGE_BYTES = 27; // of a page's header, before the table of segments
const [CONTINUED, FIRST, LAST] = [1, 2, 4]; // flags of a page
const HEAD_BYTES = 19;
const SILK_60_MS = 12; // configurations below: SILK, of 10, 20, 40, 60 ms in turn
const HYBRID_20_MS = 16; // below: hybrid, of 10 and 20 ms in turn; from there on CELT, of 2.5, 5, 10, 20 ms

/** A stream that breaks the format, or has another form; `at` is the byte where. */
export class OggError extends Error {
  constructor(message, at) {
    super(`${message} (byte ${at})`);
    this.name = 'OggError';
    this.reason = message;
    this.at = at;
  }
}

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  let value = n << 24;
  for (let bit = 0; bit < 8; bit++) value = (value << 1) ^ (value & 0x80000000 ? 0x04c11db7 : 0);
  return value;
});

/** The checksum of a page, whose own place in it counts as 0. */
function pageSum(bytes, from, to) {
  let sum = 0;
  for (let at = from; at < to; at++) {
    const byte = at >= from + 22 && at < from + 26 ? 0 : bytes[at];
    sum = ((sum << 8) ^ TABLE[((sum >>> 24) ^ byte) & 255]) >>> 0;
  }
  return sum;
}

/** @returns {{at: number, end: number, flags: number, granule: number, serial: number, number: number, sizes: Uint8Array}} */
function readPage(bytes, view, at) {
  if (bytes.length - at < PAGE_BYTES) throw new OggError('the sound ends within the header of a page', at);
  if (String.fromCharCode(...bytes.subarray(at, at + 4)) !== 'OggS' || bytes[at + 4]) throw new OggError('no page of Ogg', at);
  const sizes = bytes.subarray(at + PAGE_BYTES, at + PAGE_BYTES + bytes[at + 26]);
  const end = at + PAGE_BYTES + bytes[at + 26] + sizes.reduce((sum, size) => sum + size, 0);
  if (end > bytes.length) throw new OggError('the sound ends within a page', at);
  if (pageSum(bytes, at, end) !== view.getUint32(at + 22, true)) throw new OggError('a damaged page: its checksum does not fit', at);
  const granule = Number(view.getBigInt64(at + 6, true));
  return { at, end, flags: bytes[at + 5], granule, serial: view.getUint32(at + 14, true), number: view.getUint32(at + 18, true), sizes };
}

/** Puts packets together from the pages. @returns {{packets: {at: number, data: Uint8Array}[], granule: number}} */
function packetsOf(bytes, view) {
  const packets = [];
  let [pieces, begun, granule, serial, last] = [[], 0, 0, 0, false];
  for (let at = 0, number = 0; at < bytes.length; number++) {
    const page = readPage(bytes, view, at);
    if (last) throw new OggError('something follows the end of the stream', at);
    if (!number) serial = page.serial;
    if (page.serial !== serial || page.number !== number || Boolean(page.flags & FIRST) !== !number)
      throw new OggError('a page is missing, or of another stream', at);
    if (Boolean(page.flags & CONTINUED) !== pieces.length > 0) throw new OggError('a packet is cut short', at);
    let from = at + PAGE_BYTES + page.sizes.length;
    for (const size of page.sizes) {
      if (!pieces.length) begun = from;
      pieces.push(bytes.subarray(from, from + size));
      from += size;
      if (size === 255) continue;
      packets.push({ at: begun, data: pieces.length === 1 ? pieces[0] : Uint8Array.from(pieces.flatMap((piece) => [...piece])) });
      pieces = [];
    }
    if (page.granule >= 0) ({ granule } = page); // -1: no packet ends on this page
    last = Boolean(page.flags & LAST);
    at = page.end;
  }
  if (!last || pieces.length) throw new OggError('the stream has no end', bytes.length);
  return { packets, granule };
}

/** Whether the packet is one frame of 20 ms, mono (RFC 6716, 3.1). */
function fits(packet) {
  const configuration = packet[0] >> 3;
  const twenty = configuration < SILK_60_MS ? configuration % 4 === 1 : configuration < HYBRID_20_MS ? configuration % 2 === 1 : configuration % 4 === 3;
  return packet.length > 0 && twenty && !(packet[0] & 4) && (packet[0] & 3) === 0;
}

const startsWith = (packet, text) => packet && String.fromCharCode(...packet.data.subarray(0, text.length)) === text;

/**
 * @param {Uint8Array} bytes
 * @returns {{packets: Uint8Array[], skip: number, samples: number}} skip: samples at 48 kHz that the decoder drops at the
 *   beginning; samples: that remain
 * @throws {OggError}
 */
export function readOggOpus(bytes) {
  const { packets: all, granule } = packetsOf(bytes, new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength));
  const [head, tags, ...packets] = all;
  if (!startsWith(head, 'OpusHead') || head.data.length < HEAD_BYTES) throw new OggError('the sound is not Opus', head?.at ?? 0);
  if (head.data[8] > 15 || head.data[9] !== 1 || head.data[18] !== 0) throw new OggError('the sound is not mono', head.at);
  if (!startsWith(tags, 'OpusTags')) throw new OggError('the comments of the sound are missing', tags?.at ?? bytes.length);
  for (const { at, data } of packets) if (!fits(data)) throw new OggError('a packet is not of 20 ms', at);
  const skip = head.data[10] | (head.data[11] << 8);
  const samples = granule - skip;
  if (samples <= 0 || granule > packets.length * OPUS_PACKET_SAMPLES) throw new OggError('the length of the sound is not that of its packets', bytes.length);
  return { packets: packets.map(({ data }) => data), skip, samples };
}
