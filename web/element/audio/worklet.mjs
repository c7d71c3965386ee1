// SPDX-License-Identifier: MIT
/* global AudioWorkletProcessor, registerProcessor, sampleRate, currentFrame */
import { Mixdown } from './mixdown.mjs';
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

const BLOCK_SECONDS = 0.02;

/** Hands on what comes in, mixed to one channel. */
registerProcessor(
  'faccia-capture',
  class extends AudioWorkletProcessor {
    constructor() {
      super();
      this.block = new Float32Array(Math.round(BLOCK_SECONDS * sampleRate));
      this.mixdown = new Mixdown();
      this.filled = 0;
      this.closed = false;
      this.port.onmessage = () => (this.closed = true);
    }

    process([channels]) {
      const length = channels[0]?.length ?? 0; // nothing is connected, or it has ended
      for (let i = 0; i < length; i++) {
        this.block[this.filled++] = this.mixdown.sample(channels, i);
        if (this.filled < this.block.length) continue;
        this.port.postMessage(this.block);
        this.filled = 0;
      }
      return !this.closed;
    }
  },
);
