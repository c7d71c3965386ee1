// SPDX-License-Identifier: MIT
// Mixes channels to one, as server/base/sound/mixdown.c: a channel that is another one inverted is turned over first, since
// the plain mean of both would be silence.

const INVERTED = -0.7; // correlations at which a channel counts as inverted, and no longer
const UPRIGHT = 0;
const KEEP = 1 - 1 / 20000; // of what was heard, at each sample
const HEARD_LEAST = 256; // samples before a channel is judged

export class Mixdown {
  #channels = [];

  /** @param {ArrayLike<number>[]} channels @param {number} i @returns {number} the mean of their samples at i */
  sample(channels, i) {
    let sum = channels[0][i];
    for (let c = 1; c < channels.length; c++) {
      const x = channels[c][i];
      const one = (this.#channels[c] ??= { energy: 0, rest: 0, both: 0, heard: 0, inverted: false });
      one.energy = KEEP * one.energy + x * x;
      one.rest = KEEP * one.rest + sum * sum;
      one.both = KEEP * one.both + x * sum;
      if (one.heard < HEARD_LEAST) one.heard += Number(x * sum !== 0);
      else one.inverted = one.both < (one.inverted ? UPRIGHT : INVERTED) * Math.sqrt(one.energy * one.rest);
      sum += one.inverted ? -x : x;
    }
    return sum / channels.length;
  }
}

/** @param {AudioBuffer} buffer @returns {Float32Array} its channels as one */
export function mono(buffer) {
  const channels = Array.from({ length: buffer.numberOfChannels }, (_, c) => buffer.getChannelData(c));
  const mixdown = new Mixdown();
  return channels.length === 1 ? channels[0] : Float32Array.from(channels[0], (_, i) => mixdown.sample(channels, i));
}
