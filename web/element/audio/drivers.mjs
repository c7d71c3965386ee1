// SPDX-License-Identifier: MIT
// What pulls the samples out of a buffer: the audio thread, the page on behalf of the audio thread, or nobody but a clock.
import { companion } from '../companions.mjs';
import { PlayoutBuffer } from './playout-buffer.mjs';

const WORKLET = 'talking-head-worklet.js'; // pages may forbid scripts that are no files
const loaded = new WeakMap(); // context -> promise of its worklet module

/** @param {AudioContext} context @returns {Promise<void>} when it has the element's worklets */
export function loadWorklet(context) {
  if (!loaded.has(context)) loaded.set(context, context.audioWorklet.addModule(companion(WORKLET)));
  return loaded.get(context);
}

/** In the audio thread. */
class WorkletDriver {
  static async create(context, report) {
    await loadWorklet(context);
    return new WorkletDriver(context, report);
  }

  constructor(context, report) {
    this.node = new AudioWorkletNode(context, 'faccia-playout', { numberOfInputs: 0, outputChannelCount: [1] });
    this.node.port.onmessage = ({ data }) => report(data);
    this.node.connect(context.destination);
  }

  push(block) {
    this.node.port.postMessage(['push', block], [block.buffer]);
  }

  finish() {
    this.node.port.postMessage(['finish']);
  }

  flush() {
    this.node.port.postMessage(['flush']);
  }

  hold() {
    this.node.port.postMessage(['hold']);
  }

  release() {
    this.node.port.postMessage(['release']);
  }

  close() {
    this.node.port.onmessage = null;
    this.node.disconnect();
  }
}

/** In the page, where there is no worklet: browsers offer it over HTTPS and on localhost only, and pages can forbid it. */
class ScriptDriver {
  constructor(context, report) {
    this.buffer = new PlayoutBuffer(context.sampleRate, report);
    this.node = context.createScriptProcessor(1024, 0, 1);
    this.node.onaudioprocess = ({ outputBuffer, playbackTime }) =>
      this.buffer.render(outputBuffer.getChannelData(0), Math.round(playbackTime * context.sampleRate));
    this.node.connect(context.destination);
  }

  push(block) {
    this.buffer.push(block);
  }

  finish() {
    this.buffer.finish();
  }

  flush() {
    this.buffer.flush();
  }

  hold() {
    this.buffer.hold();
  }

  release() {
    this.buffer.release();
  }

  close() {
    this.node.onaudioprocess = null;
    this.node.disconnect();
  }
}

/** Without sound: the samples go by as time does. Frames count from the page's beginning. */
export class SilentDriver {
  constructor(rate, report) {
    this.buffer = new PlayoutBuffer(rate, report);
    this.frame = null;
    this.sink = new Float32Array(1024);
  }

  /** To be called often. @param {number} seconds the page's clock */
  run(seconds) {
    const now = Math.floor(seconds * this.buffer.rate);
    this.frame ??= now;
    while (this.frame < now) {
      const out = this.sink.subarray(0, Math.min(this.sink.length, now - this.frame));
      this.buffer.render(out, this.frame);
      this.frame += out.length;
    }
  }

  push(block) {
    this.buffer.push(block);
  }

  finish() {
    this.buffer.finish();
  }

  flush() {
    this.buffer.flush();
  }

  hold() {
    this.buffer.hold();
  }

  release() {
    this.buffer.release();
  }
}

/**
 * The best driver that this browser and page allow, connected to the context's output.
 * @returns {Promise<{driver: object, reason?: string}>} reason: why it is not the best there is
 */
export async function createAudioDriver(context, report) {
  try {
    if (context.audioWorklet) return { driver: await WorkletDriver.create(context, report) };
  } catch (error) {
    console.warn('talking-head: no audio worklet', error);
  }
  return { driver: new ScriptDriver(context, report), reason: 'no-worklet' };
}
