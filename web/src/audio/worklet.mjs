// SPDX-License-Identifier: MIT
/* global AudioWorkletProcessor, registerProcessor, sampleRate, currentFrame */
import { Pump } from './pump.mjs';

registerProcessor(
  'faccia-pump',
  class extends AudioWorkletProcessor {
    constructor() {
      super();
      const pump = new Pump(sampleRate, (report) => this.port.postMessage(report));
      this.pump = pump;
      this.port.onmessage = ({ data: [method, block] }) => pump[method](block);
    }

    process(inputs, outputs) {
      this.pump.render(outputs[0][0], currentFrame);
      return true;
    }
  },
);
