// SPDX-License-Identifier: MIT
// `.fapc` files: ../fapc.md, section "Files".
import { FAPC_FRAMES_MAX, FapcDecoder } from './fapc.mjs';

const HEADER_BYTES = 8;
const PACKET_BYTES = 3;
const FPS_MAX = 1000;

/** A file that breaks the format; `at` is the byte where. */
export class FapcFileError extends Error {
  constructor(message, at) {
    super(`${message} (byte ${at})`);
    this.name = 'FapcFileError';
    this.reason = message;
    this.at = at;
  }
}

/** Finds the packets, before any is decoded: a frame may take less than a bit. */
function packetsOf(bytes, view, most) {
  const packets = [];
  for (let at = HEADER_BYTES, frames = 0; at < bytes.length; ) {
    if (bytes.length - at < PACKET_BYTES) throw new FapcFileError('the file ends within the head of a packet', at);
    const count = bytes[at];
    if (!count || count > FAPC_FRAMES_MAX) throw new FapcFileError('a packet must have 1 to 64 frames', at);
    const end = at + PACKET_BYTES + view.getUint16(at + 1, true);
    if (end > bytes.length) throw new FapcFileError('the file ends within a packet', at);
    if ((frames += count) > most) throw new FapcFileError('more frames than one file may have', at);
    packets.push({ at, count, data: bytes.subarray(at + PACKET_BYTES, end) });
    at = end;
  }
  return packets;
}

/**
 * @param {Uint8Array} bytes @param {number} most frames
 * @returns {{fps: number, frames: Int32Array[], high: number[][][]}} values by FAP number, from 3 on; FAPs that are not in a
 *   frame's mask are 0. high: FAP 1 and 2 of each frame, where they are in its mask
 * @throws {FapcFileError}
 */
export function readFapcFile(bytes, most) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (String.fromCharCode(...bytes.subarray(0, 4)) !== 'FPC1') throw new FapcFileError('does not begin with FPC1', 0);
  if (bytes.length < HEADER_BYTES) throw new FapcFileError('the file ends within its header', bytes.length);
  const fps = view.getUint32(4, true) / 100;
  if (!(fps > 0 && fps <= FPS_MAX)) throw new FapcFileError('the frame rate is not over 0 and at most 1000', 4);
  const decoder = new FapcDecoder();
  const [frames, high] = [[], []];
  for (const { at, count, data } of packetsOf(bytes, view, most)) {
    try {
      for (const { mask, values, viseme, expression } of decoder.decode(data, count)) {
        frames.push(values.map((value, n) => (mask[n] && n > 2 ? value : 0)));
        high.push([mask[1] ? [...viseme] : undefined, mask[2] ? [...expression] : undefined]);
      }
    } catch (error) {
      throw new FapcFileError(error.message, at);
    }
  }
  if (!frames.length) throw new FapcFileError('there are no frames', bytes.length);
  return { fps, frames, high };
}
