// SPDX-License-Identifier: MIT
// Codes a voice as Opus with the browser's WebCodecs. Browsers without an encoder send PCM.
import { CAPTURE_RATE } from './capture.mjs';

const BITS = 32000; // a second: what comes back is coded once more
const CONFIG = { codec: 'opus', sampleRate: CAPTURE_RATE, numberOfChannels: 1, bitrate: BITS };

/** Bytes a second of each codec of the protocol's `voice`. */
export const BYTES = { pcm_s16le: 2 * CAPTURE_RATE, opus: BITS / 8 };

let can = null; // promise of a boolean, asked once

/** @param {string} [wanted] of the options of `listen` @returns {Promise<string>} a codec of the protocol's `voice` */
export async function voiceCodec(wanted, platform = globalThis) {
  if (wanted && wanted !== 'opus') return 'pcm_s16le';
  if (!platform.AudioEncoder || !platform.AudioData) return 'pcm_s16le';
  can ??= platform.AudioEncoder.isConfigSupported(CONFIG).then(({ supported }) => supported, () => false);
  return (await can) ? 'opus' : 'pcm_s16le';
}

/** Packets come out in order, a moment later. */
export class VoiceCoder {
  #encoder;
  #time = 0; // µs

  /** @param {(packet: Uint8Array) => void} give @param {(error: Error) => void} fail nothing more comes of it */
  constructor(give, fail) {
    this.#encoder = new globalThis.AudioEncoder({
      output: (chunk) => {
        const packet = new Uint8Array(chunk.byteLength);
        chunk.copyTo(packet);
        give(packet);
      },
      error: fail,
    });
    this.#encoder.configure(CONFIG);
  }

  /** @param {Int16Array} samples mono, CAPTURE_RATE */
  write(samples) {
    if (this.#encoder.state !== 'configured') return;
    const sound = new globalThis.AudioData({
      format: 's16', sampleRate: CAPTURE_RATE, numberOfChannels: 1, numberOfFrames: samples.length, timestamp: this.#time, data: samples,
    });
    this.#time += (samples.length / CAPTURE_RATE) * 1e6;
    this.#encoder.encode(sound);
    sound.close();
  }

  /** Gives what is left of it; also where that fails. */
  async end() {
    await (this.#encoder.state === 'configured' ? this.#encoder.flush().catch(() => {}) : null);
    this.close();
  }

  close() {
    if (this.#encoder.state !== 'closed') this.#encoder.close();
  }
}
