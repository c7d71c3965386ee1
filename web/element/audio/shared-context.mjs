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
