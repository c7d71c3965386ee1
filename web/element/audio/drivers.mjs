// SPDX-License-Identifier: MIT
// Drivers that pull samples out of a playout buffer: an audio worklet, a script node of the page, or a clock without a device.
import { companion } from '../companions.mjs';
import { PlayoutBuffer } from './playout-buffer.mjs';
import { outputOf } from './shared-context.mjs';

const WORKLET = 'talking-head-worklet.js'; // a file, since a content security policy may forbid scripts from blob: and data:
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
    this.node.connect(outputOf(context));
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

/** Runs in the page without a worklet: browsers offer those over HTTPS and on localhost only, and a policy can forbid them. */
class ScriptDriver {
  constructor(context, report) {
    this.buffer = new PlayoutBuffer(context.sampleRate, report);
    this.node = context.createScriptProcessor(1024, 0, 1);
    this.node.onaudioprocess = ({ outputBuffer, playbackTime }) =>
      this.buffer.render(outputBuffer.getChannelData(0), Math.round(playbackTime * context.sampleRate));
    this.node.connect(outputOf(context));
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
