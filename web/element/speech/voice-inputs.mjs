// SPDX-License-Identifier: MIT
import { Following, Listening } from './listening.mjs';

/** Live voices that the head lip-syncs: those requested by calls, and the media element that the attribute `for` names. */
export class VoiceInputs {
  #all = new Set(); // Listening, Following
  #named = null; // the Following of `for`

  /** @param {object} ports speak(options) -> OwnVoice; fail(error); wake(): there is something to see */
  constructor(ports) {
    this.ports = ports;
  }

  /** @param {MediaStream|MediaStreamTrack|null} stream @param {object} options @returns {Listening} */
  listen(stream, options) {
    return this.#add(new Listening(this.ports, stream, options));
  }

  /** @param {HTMLMediaElement} media @param {object} options @returns {Following} */
  follow(media, options) {
    return this.#add(new Following(this.ports, media, options));
  }

  /** In place of the one before. @param {Element|null} element what `for` names @param {() => object} options */
  name(element, options) {
    const media = element instanceof globalThis.HTMLMediaElement ? element : null;
    if (media === (this.#named?.media ?? null)) return;
    this.#forget(this.#named);
    this.#named = media && this.follow(media, options());
  }

  /** There is a connection (again). */
  linked() {
    for (const one of this.#all) one.linked?.();
  }

  close() {
    for (const one of [...this.#all]) this.#forget(one);
    this.#named = null;
  }

  #add(one) {
    this.#all.add(one);
    one.done?.finally(() => this.#all.delete(one)).catch(() => {}); // callers handle it themselves
    this.ports.wake();
    return one;
  }

  #forget(one) {
    one?.stop();
    this.#all.delete(one);
  }
}
