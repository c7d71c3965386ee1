// SPDX-License-Identifier: MIT
// Fetches recordings: protocol/bundle.md.
import { BundleError, readBundle, readPair } from '../../../protocol/bundle.mjs';

const HEAD_MAX = 64 << 20; // bytes of JSON

/** Whether an address is that of a recording, not of a stream. @param {string|null} src @param {string} page its address */
export function isRecording(src, page) {
  if (!src) return false;
  try {
    const { pathname, searchParams } = new URL(src, page);
    return /\.(faccia|fapc)$/i.test(pathname) || searchParams.get('format') === 'bundle';
  } catch {
    return false;
  }
}

async function fetched(address, signal) {
  const answer = await fetch(address, { signal });
  if (!answer.ok) throw Object.assign(new Error(`${address}: ${answer.status}`), { missing: true });
  return new Uint8Array(await answer.arrayBuffer());
}

/**
 * @param {string} src address @param {string|null} audio address of the sound, where it is not in the same file
 * @param {string} page address of the page @param {AbortSignal} signal
 * @returns {Promise<import('../../../protocol/bundle.mjs').Recording>} its `model` as a whole address
 */
export async function fetchRecording(src, audio, page, signal) {
  const address = new URL(src, page).href;
  if (!/\.fapc$/i.test(new URL(address).pathname)) {
    const recording = readBundle(await fetched(address, signal));
    return { ...recording, model: recording.model === null ? null : new URL(recording.model, address).href };
  }
  const [face, sound] = await Promise.all([fetched(address, signal), audio && fetched(new URL(audio, page).href, signal)]);
  if (!sound) throw new BundleError('a .fapc file has no sound: its address belongs into the attribute audio', 0);
  return readPair(face, sound);
}

/** Unpacks the head of a recording. @param {Uint8Array} packed by gzip @returns {Promise<object>} */
export async function unpackHead(packed) {
  const reader = new Blob([packed]).stream().pipeThrough(new globalThis.DecompressionStream('gzip')).getReader();
  const pieces = [];
  for (let size = 0; ; ) {
    const { done, value } = await reader.read();
    if (done) break;
    pieces.push(value);
    if ((size += value.length) > HEAD_MAX) throw new Error('the head in the recording is larger than 64 MiB');
  }
  return JSON.parse(await new Blob(pieces).text());
}
