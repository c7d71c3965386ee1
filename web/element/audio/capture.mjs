// SPDX-License-Identifier: MIT
// The sound of a node of the page's audio graph, in blocks of some 20 ms, at a rate that suits a voice. Nothing is kept.
import { loadWorklet } from './drivers.mjs';
import { Resampler } from './resampler.mjs';

export const CAPTURE_RATE = 24000;

const toPcm = (block) => Int16Array.from(block, (x) => Math.max(-32768, Math.min(32767, Math.round(x * 32768))));

export class Capture {
  #node = null;
  #source = null;

  /**
   * @param {AudioNode} source @param {(samples: Int16Array) => void} give mono, CAPTURE_RATE
   * @returns {Promise<Capture>} fails where the page has no worklets: over HTTP, but for this machine
   */
  static async open(source, give) {
    const { context } = source;
    if (!context.audioWorklet) throw new globalThis.DOMException('The page has no audio worklets.', 'NotSupportedError');
    context.resume().catch(() => {}); // a context made before a user gesture is suspended
    await loadWorklet(context);
    return new Capture(source, give);
  }

  constructor(source, give) {
    const { context } = source, resampler = new Resampler(context.sampleRate, CAPTURE_RATE);
    this.#source = source;
    this.#node = new AudioWorkletNode(context, 'faccia-capture', { numberOfOutputs: 0 });
    this.#node.port.onmessage = ({ data }) => give(toPcm(resampler.push(data)));
    source.connect(this.#node);
  }

  close() {
    if (!this.#node) return;
    this.#node.port.onmessage = null;
    this.#node.port.postMessage('close');
    this.#source.disconnect(this.#node);
    this.#node = null;
  }
}
