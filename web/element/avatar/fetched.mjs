// SPDX-License-Identifier: MIT
import { AvatarProblem } from './problem.mjs';

const MB = 1 << 20;

/**
 * Fetches a file up to a size limit.
 * @param {string} address @param {number} most bytes @param {AbortSignal} signal
 * @param {(loaded: number, total: number|null) => void} [progress]
 * @returns {Promise<Uint8Array>}
 */
export async function fetched(address, most, signal, progress = () => {}) {
  const tooLarge = () => new AvatarProblem('too-large', `${address} has more than ${most / MB} MB`);
  let response;
  try {
    response = await fetch(address, { signal });
  } catch (error) {
    if (signal.aborted) throw error;
    throw new AvatarProblem('missing', `${address} cannot be fetched: nothing answers, or this page is not let in`);
  }
  if (!response.ok) throw new AvatarProblem('missing', `${address} is not there: ${response.status}`);
  const stated = Number(response.headers.get('content-length')) || null;
  const total = response.headers.get('content-encoding') ? null : stated; // else the length is that of the packed form
  if (total > most) {
    response.body.cancel();
    throw tooLarge();
  }
  const pieces = [];
  let loaded = 0;
  for (const reader = response.body.getReader(); ; ) {
    const { done, value } = await reader.read().catch((error) => {
      if (signal.aborted) throw error;
      throw new AvatarProblem('missing', `${address} broke off after ${loaded} bytes`);
    });
    if (done) break;
    loaded += value.length;
    if (loaded > most) {
      reader.cancel();
      throw tooLarge();
    }
    pieces.push(value);
    progress(loaded, total && Math.max(total, loaded));
  }
  return new Uint8Array(await new Blob(pieces).arrayBuffer());
}
