// SPDX-License-Identifier: MIT
// Records the last utterance of a head, as received from the server, and passes it to the Face Player.

const SECONDS_MAX = 300; // of one utterance, from its beginning; 48 kHz: 29 MB
const OPEN_MAX = 8; // utterances on their way
const [DATABASE, STORE, LAST] = ['faccia', 'takes', 'last'];

const done = (request) =>
  new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });

async function store(mode) {
  const opening = indexedDB.open(DATABASE, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(STORE);
  const database = await done(opening);
  return { database, store: database.transaction(STORE, mode).objectStore(STORE) };
}

/**
 * @typedef {{name: string, fps: number, frames: Int32Array[], high: number[][], rate: number, pcm: Int16Array,
 *   words: object[], phones: object[]}} Take as the player has a file: frames by FAP number; times in s
 */

/** @returns {Promise<Take|undefined>} what was handed on last */
export async function lastTake() {
  const { database, store: takes } = await store('readonly');
  const take = await done(takes.get(LAST));
  database.close();
  return take;
}

/** @param {Take} take */
export async function handOn(take) {
  const { database, store: takes } = await store('readwrite');
  await done(takes.put(take, LAST));
  database.close();
}

const timed = ({ time, duration, text, ipa }) => ({ start: time, end: time + duration, text, ipa });
const bounded = (x) => 32767 * Math.min(1, Math.max(-1, x));
const copyOf = (audio) => (audio instanceof Int16Array ? audio.slice() : Int16Array.from(audio, bounded));

/** Keeps the last utterance that was heard to its end, or to where it was stopped. */
export class Recorder {
  #open = new Map(); // utterance -> what has come
  #last = null;

  /** @param {HTMLElement} head @param {() => void} told there is something to be handed on */
  constructor(head, told) {
    head.addEventListener('media', ({ detail }) => this.#media(detail));
    for (const type of ['word', 'phone'])
      head.addEventListener(type, ({ detail }) => this.#open.get(detail.utterance)?.[`${type}s`].push(timed(detail)));
    head.addEventListener('end', ({ detail }) => {
      const ended = this.#open.get(detail.utterance);
      this.#open.delete(detail.utterance);
      if (!ended?.frames.length || !ended.rate) return;
      this.#last = ended;
      told();
    });
  }

  #media({ utterance, fps, firstFrame, frames, start, rate, audio }) {
    if (!this.#open.has(utterance)) {
      if (this.#open.size >= OPEN_MAX) this.#open.delete(this.#open.keys().next().value);
      this.#open.set(utterance, { fps, rate, frames: [], audio: [], words: [], phones: [] });
    }
    const take = this.#open.get(utterance);
    if (start > SECONDS_MAX * rate) return;
    frames.forEach((frame, i) => (take.frames[firstFrame + i] = Int32Array.from(frame)));
    if (audio) {
      take.rate = rate;
      take.audio.push({ start, samples: copyOf(audio) });
    }
  }

  /** @returns {Take|null} */
  get take() {
    if (!this.#last) return null;
    const { fps, rate, frames, audio, words, phones } = this.#last;
    const pcm = new Int16Array(Math.max(0, ...audio.map(({ start, samples }) => start + samples.length)));
    for (const { start, samples } of audio) pcm.set(samples, start);
    const still = new Int32Array(frames.find(Boolean).length);
    const whole = Array.from(frames, (frame, k) => (frames[k] = frame ?? frames[k - 1] ?? still));
    const name = words.slice(0, 3).map(({ text }) => text).join('-').replace(/[^\p{L}\p{N}-]/gu, '') || 'faccia';
    return { name, fps, frames: whole, high: whole.map(() => []), rate, pcm, words, phones };
  }
}
