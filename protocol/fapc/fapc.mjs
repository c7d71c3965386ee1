// SPDX-License-Identifier: MIT
// FAPC: face animation parameters at a few kilobits a second. ../fapc.md describes the coding; fapc.c is the same in C.
import { FAP_COUNT } from '../fap.mjs';
import { CTX_HIGH, CTX_MASK, FapcError, State, getValue, putValue } from './fapc-model.mjs';
import { RangeDecoder, RangeEncoder } from './rangecoder.mjs';

export { FapcError, fapcStep } from './fapc-model.mjs';
export const FAPC_QUALITY = 5;
export const FAPC_QUALITY_MAX = 31;
export const FAPC_FRAMES_MAX = 64;

/**
 * One frame as this coding has it.
 * @typedef {{mask: Uint8Array, values: Int32Array, viseme: Uint8Array, expression: Uint8Array}} FapcFrame mask: 69
 *   flags by FAP number; values by FAP number; FAP 1 and FAP 2 as in chunk.mjs
 */

/** @returns {FapcFrame} */
export const fapcFrame = () => ({
  mask: new Uint8Array(FAP_COUNT + 1),
  values: new Int32Array(FAP_COUNT + 1),
  viseme: new Uint8Array(4),
  expression: new Uint8Array(6),
});

/** Writes packets. The first packet of a stream, and any other on request, is one at which a decoder can start. */
export class FapcEncoder {
  #state = new State();
  #started = false;

  constructor(quality = FAPC_QUALITY) {
    this.quality = Math.max(0, Math.min(FAPC_QUALITY_MAX, quality));
  }

  /**
   * @param {FapcFrame[]} frames up to FAPC_FRAMES_MAX
   * @param {boolean} intra a packet to begin with
   * @returns {Uint8Array}
   */
  encode(frames, intra = false) {
    if (frames.length > FAPC_FRAMES_MAX) throw new FapcError('more frames than a packet can have');
    const s = this.#state;
    const begins = intra || !this.#started;
    const out = [s.sequence | (begins ? 0x80 : 0)];
    this.#started = true;
    if (begins) {
      out.push(this.quality);
      s.reset(this.quality);
    }
    s.sequence = (s.sequence + 1) & 0x7f;
    const coder = new RangeEncoder(s.contexts, out);
    for (const frame of frames) putFrame(s, coder, frame);
    coder.finish();
    return Uint8Array.from(out);
  }
}

/** Exported for make-fapc-prior.mjs. */
export function putFrame(s, coder, frame) {
  s.nextFrame();
  const changed = frame.mask.some((flag, n) => n > 0 && flag !== s.mask[n]);
  coder.put(CTX_MASK, changed ? 1 : 0);
  for (let n = 1; changed && n <= FAP_COUNT; n++) coder.put(CTX_MASK + 1 + s.mask[n], frame.mask[n]);
  for (let i = 0; i < 10; i++) {
    const value = i < 4 ? frame.viseme[i] : frame.expression[i - 4];
    if (!frame.mask[i < 4 ? 1 : 2]) continue;
    coder.put(CTX_HIGH + i, value !== s.high[i] ? 1 : 0);
    for (let b = 7; value !== s.high[i] && b >= 0; b--) coder.even((value >> b) & 1);
    s.high[i] = value;
  }
  s.mask.set(frame.mask);
  for (let n = 3; n <= FAP_COUNT; n++) if (frame.mask[n]) putValue(s, coder, n, frame.values[n]);
}

/** Reads packets. */
export class FapcDecoder {
  #state = new State();
  #ready = false;

  /** Has had a packet to begin with, and lost none since. */
  get ready() {
    return this.#ready;
  }

  /**
   * @param {Uint8Array} bytes one packet
   * @param {number} count how many frames it has
   * @returns {FapcFrame[]}
   */
  decode(bytes, count) {
    const was = this.#ready;
    this.#ready = false;
    if (count > FAPC_FRAMES_MAX) throw new FapcError('more frames than a packet can have');
    if (!bytes.length) throw new FapcError('an empty packet');
    const s = this.#state;
    const sequence = bytes[0] & 0x7f;
    const begins = bytes[0] >= 0x80;
    if (begins) {
      if (bytes.length < 2 || bytes[1] > FAPC_QUALITY_MAX) throw new FapcError('a packet without its quality');
      s.reset(bytes[1]);
    } else if (!was) {
      throw new FapcError('no packet to begin with has come yet');
    } else if (sequence !== s.sequence) {
      throw new FapcError('a packet was lost');
    }
    s.sequence = (sequence + 1) & 0x7f;
    const coder = new RangeDecoder(s.contexts, bytes, begins ? 2 : 1);
    const frames = Array.from({ length: count }, () => getFrame(s, coder));
    if (coder.early) throw new FapcError('a damaged packet');
    this.#ready = true;
    return frames;
  }
}

function getFrame(s, coder) {
  s.nextFrame();
  if (coder.get(CTX_MASK)) for (let n = 1; n <= FAP_COUNT; n++) s.mask[n] = coder.get(CTX_MASK + 1 + s.mask[n]);
  for (let i = 0; i < 10; i++) {
    if (!s.mask[i < 4 ? 1 : 2] || !coder.get(CTX_HIGH + i)) continue;
    let value = 0;
    for (let b = 0; b < 8; b++) value = (value << 1) | coder.even();
    s.high[i] = value;
  }
  const frame = fapcFrame();
  frame.mask.set(s.mask);
  if (s.mask[1]) frame.viseme.set(s.high.subarray(0, 4));
  if (s.mask[2]) frame.expression.set(s.high.subarray(4));
  for (let n = 3; n <= FAP_COUNT; n++) {
    if (!s.mask[n]) continue;
    getValue(s, coder, n);
    frame.values[n] = s.value[0][n];
  }
  return frame;
}
