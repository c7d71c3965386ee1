// SPDX-License-Identifier: MIT
// Speech on the page's own clock: the model with its face, and the learner's recording, whole or in part.
import { bearer } from '../shared/bearer.js';
import { readFap, wholeWav } from '../player/file.js';

let context = null;
export const audio = () => (context ??= new AudioContext());

/** Plays parts of sounds, one at a time. */
export class Player {
  #node = null;
  #end = null;

  /** @param {(seconds: number|null) => void} at the moment of the model that is heard; null: none is */
  constructor(at) {
    this.at = at;
  }

  stop() {
    this.#node?.stop();
    this.#end?.();
  }

  /**
   * @param {AudioBuffer} buffer @param {{from?: number, to?: number, model?: boolean}} [part] seconds; model: it moves the face
   * @returns {Promise<boolean>} when it has ended; false: it was stopped
   */
  async play(buffer, { from = 0, to = buffer.duration, model = false } = {}) {
    this.stop();
    const sound = audio(), node = sound.createBufferSource();
    await sound.resume();
    node.buffer = buffer;
    node.connect(sound.destination);
    const began = sound.currentTime;
    node.start(0, from, Math.max(0.02, to - from));
    this.#node = node;
    const show = () => {
      if (this.#node !== node) return;
      const heard = from + sound.currentTime - began - (sound.outputLatency || 0);
      if (model) this.at(Math.min(to, Math.max(from, heard)));
      requestAnimationFrame(show);
    };
    requestAnimationFrame(show);
    return new Promise((resolve) => {
      const done = (whole) => {
        if (this.#node !== node) return;
        this.#node = this.#end = null;
        if (model) this.at(null);
        resolve(whole);
      };
      this.#end = () => done(false);
      node.onended = () => done(true);
    });
  }
}

/** A text as the server speaks it. */
export class Model {
  /** @param {{text: string, lang: string}} wish members of speak @param {string|null} token */
  static async load(wish, token) {
    const get = async (format) => {
      const answer = await fetch('v1/speech', {
        method: 'POST',
        headers: { 'content-type': 'application/json', ...bearer(token) },
        body: JSON.stringify({ ...wish, seed: 1, fps: 50, life: 0, format }),
      });
      if (!answer.ok) throw await answer.json();
      return answer;
    };
    const [face, sound] = await Promise.all([get('fap'), get('wav')]);
    const buffer = await audio().decodeAudioData(wholeWav(await sound.arrayBuffer()));
    return new Model(readFap(await face.text()), buffer);
  }

  constructor({ fps, frames }, buffer) {
    Object.assign(this, { fps, frames, buffer });
  }

  /** @returns {Record<number, number>} the face at that moment */
  pose(seconds) {
    const pose = {};
    const at = Math.min(this.frames.length - 1, Math.max(0, Math.round(seconds * this.fps)));
    this.frames[at].forEach((value, n) => n > 2 && value && (pose[n] = value));
    return pose;
  }
}
