// SPDX-License-Identifier: MIT
// Works saved on this device, and speech without a network: sound files with the times of their words.
import { rangeIn } from './text.js';

const SPEECH = 'faccia-speech';
const MARK = 'library-word';
const WORKER = 'library-worker.js';

/** Whether this browser can store data for this page. */
export const canKeep = () => globalThis.origin !== 'null' && 'serviceWorker' in navigator && 'caches' in globalThis; // null: in a sandbox

/** @returns {Promise<boolean>} whether the service worker is available */
export async function startWorker() {
  if (!canKeep()) return false;
  try {
    const trusted = globalThis.trustedTypes?.createPolicy('faccia-worker', { createScriptURL: () => WORKER });
    await navigator.serviceWorker.register(trusted?.createScriptURL('') ?? WORKER);
    return true;
  } catch {
    return false; // the page is not secure, or the user forbids it
  }
}

const addresses = (passage) => ['ogg', 'json'].map((format) => `v1/speech?passage=${encodeURIComponent(passage)}&format=${format}`);

/**
 * Stores the speech of a section. @param {string[]} passages @param {(done: number) => void} told
 */
export async function keep(passages, told) {
  const cache = await caches.open(SPEECH);
  for (const [i, passage] of passages.entries()) {
    for (const address of addresses(passage)) {
      if (await cache.match(address)) continue;
      const answer = await fetch(address);
      if (!answer.ok) throw new Error(`${answer.status}`);
      await cache.put(address, answer);
    }
    told(i + 1);
  }
}

/** @returns {Promise<{work: string, bytes: number}[]>} stored speech by work */
export async function kept() {
  const sizes = new Map();
  const cache = await caches.open(SPEECH);
  for (const request of await cache.keys()) {
    const work = new URL(request.url).searchParams.get('passage').split(':')[0];
    const { size } = await (await cache.match(request)).blob();
    sizes.set(work, (sizes.get(work) ?? 0) + size);
  }
  return [...sizes].map(([work, bytes]) => ({ work, bytes }));
}

/** Deletes the stored speech of a work. @param {string} work */
export async function forget(work) {
  const cache = await caches.open(SPEECH);
  for (const request of await cache.keys())
    if (new URL(request.url).searchParams.get('passage').split(':')[0] === work) await cache.delete(request);
}

/** Plays stored passages one after the other, and marks their words in sync with the sound. */
export class KeptSpeech {
  #audio = new Audio();
  #stopped = true;

  constructor() {
    this.#audio.preservesPitch = true;
  }

  get playing() {
    return !this.#stopped;
  }

  set speed(value) {
    this.#audio.defaultPlaybackRate = this.#audio.playbackRate = value;
  }

  /**
   * @param {HTMLElement[]} passages @param {(passage: HTMLElement) => void} told
   * @returns {Promise<boolean>} whether all were heard
   */
  async play(passages, told) {
    this.#stopped = false;
    for (const passage of passages) {
      const [sound, times] = addresses(passage.dataset.passage);
      const answer = await fetch(times).catch(() => null);
      if (!answer?.ok) break;
      const { words } = await answer.json();
      if (this.#stopped) return false;
      told(passage);
      await this.#hear(sound, passage, words);
      if (this.#stopped) return false;
    }
    const whole = !this.#stopped;
    this.#stopped = true;
    return whole;
  }

  stop() {
    this.#stopped = true;
    this.#audio.pause();
    this.#audio.dispatchEvent(new Event('ended'));
  }

  #hear(sound, passage, words) {
    return new Promise((resolve) => {
      const mark = () => {
        const word = words.findLast(({ start }) => start <= this.#audio.currentTime);
        const range = word && rangeIn(passage, word.utf16_start, word.utf16_end);
        if (range) CSS.highlights?.set(MARK, new Highlight(range));
      };
      const timer = setInterval(mark, 40);
      const done = () => {
        clearInterval(timer);
        CSS.highlights?.delete(MARK);
        resolve();
      };
      this.#audio.addEventListener('ended', done, { once: true });
      this.#audio.src = sound;
      this.#audio.play().catch(done);
    });
  }
}
