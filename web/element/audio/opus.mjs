// SPDX-License-Identifier: MIT
// Opus packets to samples: by the browser itself (WebCodecs), or by the npm package opus-decoder where it cannot.
import { companion } from '../companions.mjs';
import { OPUS_PACKET_SAMPLES, OPUS_RATE } from '../../../protocol/chunk/compact.mjs';

const CONFIG = { codec: 'opus', sampleRate: OPUS_RATE, numberOfChannels: 1 };

/** The browser's own decoder. A packet becomes samples a moment later, in order. */
class BrowserDecoder {
  constructor(AudioDecoder) {
    this.waiting = []; // {blocks, missing, resolve, reject}
    this.time = 0;
    this.decoder = new AudioDecoder({ output: (data) => this.#take(data), error: (error) => this.#fail(error) });
    this.decoder.configure(CONFIG);
  }

  decode(packets) {
    return new Promise((resolve, reject) => {
      this.waiting.push({ blocks: [], missing: packets.length, resolve, reject });
      for (const data of packets) {
        const type = 'key';
        const timestamp = this.time;
        this.time += (OPUS_PACKET_SAMPLES / OPUS_RATE) * 1e6;
        this.decoder.decode(new globalThis.EncodedAudioChunk({ type, timestamp, data }));
      }
    });
  }

  close() {
    if (this.decoder.state !== 'closed') this.decoder.close();
    for (const request of this.waiting.splice(0)) request.resolve(new Float32Array(0));
  }

  #take(data) {
    const block = new Float32Array(data.numberOfFrames);
    data.copyTo(block, { planeIndex: 0, format: 'f32-planar' });
    data.close();
    const request = this.waiting[0];
    request.blocks.push(block);
    if (--request.missing === 0) this.waiting.shift().resolve(joined(request.blocks));
  }

  #fail(error) {
    for (const request of this.waiting.splice(0)) request.reject(error);
  }
}

/** In WebAssembly. */
class WasmDecoder {
  constructor(load) {
    this.ready = load().then(async ({ OpusDecoder }) => {
      this.decoder = new OpusDecoder({ sampleRate: OPUS_RATE, channels: 1 });
      await this.decoder.ready;
    });
  }

  async decode(packets) {
    await this.ready;
    return this.decoder.decodeFrames(packets).channelData[0];
  }

  close() {
    this.ready.then(() => this.decoder.free()).catch(() => {});
  }
}

function joined(blocks) {
  const all = new Float32Array(blocks.reduce((sum, block) => sum + block.length, 0));
  let at = 0;
  for (const block of blocks) {
    all.set(block, at);
    at += block.length;
  }
  return all;
}

let browserCan = null; // promise of a boolean, asked once

function askBrowser(platform) {
  browserCan ??= platform.AudioDecoder?.isConfigSupported
    ? platform.AudioDecoder.isConfigSupported(CONFIG).then(({ supported }) => supported, () => false)
    : Promise.resolve(false);
  return browserCan;
}

/** Whether Opus can be decoded here at all: a page's policy may forbid WebAssembly. @param {object} [platform] of tests */
export async function canDecode(platform = globalThis) {
  if (await (platform.can ?? askBrowser(platform))) return true;
  try {
    new platform.WebAssembly.Module(Uint8Array.of(0, 0x61, 0x73, 0x6d, 1, 0, 0, 0)); // the smallest there is
    return true;
  } catch {
    return false;
  }
}

const loadFallback = () => import(/* webpackIgnore: true */ /* @vite-ignore */ companion('opus-decoder.js'));

/**
 * Decodes the Opus parts of one utterance after the other.
 * @param {object} [platform] AudioDecoder and load() of tests
 */
export class OpusSound {
  #decoder = null;
  #next = 0;
  #utterance = null;

  constructor(platform = {}) {
    this.platform = { AudioDecoder: globalThis.AudioDecoder, load: loadFallback, ...platform };
  }

  /**
   * @param {{utterance: number, firstPacket: number, audio: Uint8Array[]}} chunk
   * @returns {Promise<Float32Array>} its samples at OPUS_RATE
   */
  async decode({ utterance, firstPacket, audio }) {
    if (!audio.length) return new Float32Array(0);
    if (utterance !== this.#utterance || firstPacket !== this.#next) await this.#begin(utterance);
    this.#next = firstPacket + audio.length;
    return this.#decoder.decode(audio);
  }

  close() {
    this.#decoder?.close();
    this.#decoder = null;
    this.#utterance = null;
  }

  async #begin(utterance) {
    this.close();
    const can = await (this.platform.can ?? askBrowser(this.platform));
    this.#decoder = can ? new BrowserDecoder(this.platform.AudioDecoder) : new WasmDecoder(this.platform.load);
    this.#utterance = utterance;
  }
}
