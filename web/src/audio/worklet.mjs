// SPDX-License-Identifier: MIT
/* global AudioWorkletProcessor, registerProcessor, sampleRate, currentFrame */
import { PlayoutBuffer } from './playout-buffer.mjs';

registerProcessor(
  'faccia-playout',
  class extends AudioWorkletProcessor {
    constructor() {
      super();
      const buffer = new PlayoutBuffer(sampleRate, (report) => this.port.postMessage(report));
      this.buffer = buffer;
      this.port.onmessage = ({ data: [method, block] }) => buffer[method](block);
    }

    process(inputs, outputs) {
      this.buffer.render(outputs[0][0], currentFrame);
      return true;
    }
  },
);
