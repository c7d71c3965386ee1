// SPDX-License-Identifier: MIT
// One AudioContext for all the heads of a page: each one costs the browser an audio thread.

let context = null;
let users = 0;

/** @returns {AudioContext|null} null where the browser has none, or refuses one */
export function acquireContext() {
  const Context = globalThis.AudioContext ?? globalThis.webkitAudioContext;
  try {
    context ??= new Context({ latencyHint: 'interactive' });
  } catch {
    return null;
  }
  users++;
  return context;
}

export function releaseContext() {
  if (--users === 0) {
    context.close();
    context = null;
  }
}

const outputs = new WeakMap(); // context -> node

/** Where all heads of the page play, so that it can be captured. @param {AudioContext} to @returns {AudioNode} */
export function outputOf(to) {
  if (!outputs.has(to)) {
    const node = to.createGain();
    node.connect(to.destination);
    outputs.set(to, node);
  }
  return outputs.get(to);
}

/** The sound of all heads, as a stream. It keeps the context open. @returns {MediaStream|null} null without sound */
export function captureOutput() {
  const from = acquireContext();
  if (!from) return null;
  const sink = from.createMediaStreamDestination();
  outputOf(from).connect(sink);
  return sink.stream;
}
