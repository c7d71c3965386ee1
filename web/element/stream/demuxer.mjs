// SPDX-License-Identifier: MIT
import { decodeChunk } from '../../../protocol/chunk/chunk.mjs';
import { AUDIO_OPUS, CompactReader, isCompact, OPUS_PACKET_SAMPLES, OPUS_RATE, OPUS_SKIP } from '../../../protocol/chunk/compact.mjs';
import { OpusSound } from '../audio/opus.mjs';

/**
 * Decodes media from the server and keeps the order of arrival: messages wait until the sound before them is decoded.
 */
export class Demuxer {
  /**
   * @param {{hear: (message: object) => void, media: (chunk: object) => void, mute: (error: Error) => void}} outlets mute:
   *   a chunk could not be decoded, and is silent
   * @param {OpusSound} [sound]
   */
  constructor({ hear, media, mute = () => {} }, sound = new OpusSound()) {
    Object.assign(this, { hear, media, mute, sound });
    this.reader = new CompactReader();
    this.waiting = [];
    this.busy = false;
  }

  /** A new connection: nothing of the old one counts. */
  reset() {
    this.reader = new CompactReader();
    this.waiting.length = 0;
    this.sound.close();
  }

  /** @param {object} message */
  text(message) {
    if (this.busy) this.waiting.push(() => this.hear(message));
    else this.hear(message);
  }

  /** @param {ArrayBuffer} data a media chunk */
  binary(data) {
    const chunk = isCompact(data) ? this.reader.decode(data) : decodeChunk(data);
    for (const event of chunk.events ?? []) this.text(event);
    if (chunk.audioCodec !== AUDIO_OPUS && !this.busy) this.media(chunk);
    else this.waiting.push(() => this.#deliver(chunk));
    this.#work();
  }

  async #deliver(chunk) {
    if (chunk.audioCodec === AUDIO_OPUS) {
      const samples = await this.sound.decode(chunk).catch((error) => {
        this.mute(error);
        return new Float32Array(chunk.audio.length * OPUS_PACKET_SAMPLES);
      });
      const start = chunk.firstPacket * OPUS_PACKET_SAMPLES - OPUS_SKIP;
      const skip = Math.min(samples.length, Math.max(0, -start));
      Object.assign(chunk, { audio: samples.subarray(skip), audioRate: OPUS_RATE, audioStart: Math.max(0, start) });
    }
    this.media(chunk);
  }

  async #work() {
    if (this.busy) return;
    this.busy = true;
    while (this.waiting.length) await this.waiting.shift()();
    this.busy = false;
  }
}
