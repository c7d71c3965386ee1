// SPDX-License-Identifier: MIT
// Orders a film from the server, waits for it, and saves it as a file.
import { bearer } from './bearer.js';

const LOOK_MS = 500; // between questions how far it is

/** @param {string|null} token @returns {(address: string, options?: object) => Promise<Response>} throws server errors */
function asker(token) {
  return async (address, options = {}) => {
    const headers = { ...options.headers, ...bearer(token) };
    const answer = await fetch(address, { ...options, headers }).catch(() => {
      throw Object.assign(new Error(''), { code: 'unreachable' });
    });
    if (answer.ok) return answer;
    const error = await answer.json().catch(() => ({ code: 'unreachable' }));
    throw Object.assign(new Error(error.message ?? ''), error);
  };
}

/** Whether this server makes films. @param {string|null} token */
export async function makesFilms(token) {
  const answer = await asker(token)('v1/films').catch(() => null);
  return Boolean(answer && (await answer.json()).available);
}

/**
 * Makes a film. @param {object} order members of POST /v1/films @param {string|null} token
 * @param {(share: number) => void} told how much of it is drawn, 0 to 1 @param {AbortSignal} signal stops it
 * @returns {Promise<Blob|null>} null: stopped
 */
export async function makeFilm(order, token, told, signal) {
  const ask = asker(token);
  const json = { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(order) };
  const { id } = await (await ask('v1/films', json)).json();
  const address = `v1/films/${id}`;
  try {
    for (;;) {
      if (signal.aborted) return null;
      const { state, progress, film, error } = await (await ask(address)).json();
      if (state === 'failed') throw Object.assign(new Error(error.message), error);
      told(progress);
      if (state === 'done') return await (await ask(film.slice(1))).blob();
      await new Promise((resolve) => setTimeout(resolve, LOOK_MS));
    }
  } finally {
    ask(address, { method: 'DELETE' }).catch(() => {}); // it may be gone, and the server, too
  }
}

/** Whether a head on the page keeps still, so that its film does, too. @param {HTMLElement & {still: boolean|null}} head */
export const keepsStill = (head) => head.still ?? matchMedia('(prefers-reduced-motion: reduce)').matches;

/** @param {Blob} film @param {string} name of the file */
export function saveFilm(film, name) {
  const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(film), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
