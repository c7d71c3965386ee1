// SPDX-License-Identifier: MIT
// Compact media chunks (version 2): ../README.md, section "Compact chunks". A stream has one reader.
import { AUDIO_SILENCE, ChunkError, FAP_NONE } from './chunk.mjs';
import { FapcDecoder } from '../fapc/fapc.mjs';
import { unpackEvents } from './packed.mjs';

export const AUDIO_OPUS = 2;
export const FAP_FAPC = 2;

/** Clock rate of Opus in Hz, at any sample rate of the utterance. */
export const OPUS_RATE = 48000;
/** Samples at OPUS_RATE that the decoder drops at an utterance's beginning. */
export const OPUS_SKIP = 312;
export const OPUS_PACKET_SAMPLES = 960;

/** Is it a compact chunk? (else one of version 1) */
export const isCompact = (data) => new Uint8Array(data.buffer ?? data, data.byteOffset ?? 0, 1)[0] >= 0x80;

/** The packets of an Opus part, each after its length (RFC 6716, 3.2.1). */
export function opusPackets(bytes) {
  const packets = [];
  for (let at = 0; at < bytes.length; ) {
    let size = bytes[at++];
    if (size >= 252) size += 4 * bytes[at++];
    if (!(at + size <= bytes.length)) throw new ChunkError('an Opus packet is cut short', at);
    packets.push(bytes.slice(at, at + size));
    at += size;
  }
  return packets;
}

export class CompactReader {
  #next = null;
  #fapc = new FapcDecoder();

  /**
   * @param {ArrayBuffer|Uint8Array} data one message
   * @returns the chunk as decodeChunk gives it, and the number of its first Opus packet; `audio` is an Int16Array for PCM, a list of packets for Opus, or null; `events` the messages
   *   that were packed into it;
   *   without frames (`missing` true) when the packets that they build on have not come
   */
  decode(data) {
    const bytes = data instanceof Uint8Array ? data : new Uint8Array(data);
    let at = 0;
    const byte = () => {
      if (at >= bytes.length) throw new ChunkError('the header is cut short', at);
      return bytes[at++];
    };
    const number = () => {
      let value = 0;
      for (let scale = 1; scale <= 2 ** 28; scale *= 128) {
        const b = byte();
        if (scale === 2 ** 28 && b > 15) break;
        value += (b & 0x7f) * scale;
        if (b < 0x80) return value;
      }
      throw new ChunkError('a number of more than 32 bits', at - 1);
    };
    const flags = byte();
    if (flags < 0x80) throw new ChunkError('not a compact chunk', 0);
    const audioCodec = (flags >> 4) & 3;
    const fapCodec = (flags >> 2) & 3;
    if (audioCodec > AUDIO_OPUS || (fapCodec !== FAP_NONE && fapCodec !== FAP_FAPC)) throw new ChunkError('a codec that is not known here', 0);
    if (!(flags & 0x40) && !this.#next) throw new ChunkError('no chunk to begin with has come yet', 0);
    const chunk = { ...this.#next };
    if (flags & 0x40) {
      Object.assign(chunk, { utterance: number(), sampleRate: number(), fps: number() / 100, start: number(), firstFrame: number() });
      chunk.firstPacket = audioCodec === AUDIO_OPUS ? number() : 0;
      if (!chunk.sampleRate || !chunk.fps || chunk.fps > 655.35) throw new ChunkError('a rate that cannot be', at);
      if (!(flags & 2)) throw new ChunkError('a position without a duration', at);
    }
    if (flags & 2) chunk.samples = number();
    const count = number();
    const audioBytes = number();
    const eventBytes = flags & 1 ? number() : 0;
    if (eventBytes > bytes.length - at) throw new ChunkError('the events are cut short', at);
    const events = unpackEvents(bytes.subarray(at, at + eventBytes), chunk);
    at += eventBytes;
    if (audioBytes > bytes.length - at) throw new ChunkError('the audio is cut short', at);
    if (count && fapCodec === FAP_NONE) throw new ChunkError('frames without a codec', at);
    const audio = bytes.slice(at, at + audioBytes);
    const packets = audioCodec === AUDIO_OPUS ? opusPackets(audio) : null;
    this.#next = {
      firstPacket: chunk.firstPacket + (packets?.length ?? 0),
      utterance: chunk.utterance,
      sampleRate: chunk.sampleRate,
      fps: chunk.fps,
      start: chunk.start + chunk.samples,
      firstFrame: chunk.firstFrame + count,
      samples: chunk.samples,
    };
    chunk.events = events;
    chunk.audioCodec = audioCodec;
    chunk.fapCodec = fapCodec;
    chunk.audio = packets ?? (audioCodec === AUDIO_SILENCE ? null : new Int16Array(audio.buffer, 0, audioBytes >> 1));
    this.#takeFrames(chunk, bytes.subarray(at + audioBytes), count);
    return chunk;
  }

  #takeFrames(chunk, bytes, count) {
    let frames = [];
    chunk.missing = false;
    try {
      if (chunk.fapCodec === FAP_FAPC) frames = this.#fapc.decode(bytes, count);
    } catch (error) {
      if (error.name !== 'FapcError') throw error;
      chunk.missing = true;
    }
    chunk.frames = frames.map((frame) => frame.values);
    chunk.visemes = frames.map((frame) => frame.viseme);
    chunk.expressions = frames.map((frame) => frame.expression);
  }
}
