// SPDX-License-Identifier: MIT
import { fetchModel } from '../head/model/source.mjs';
import { readPictures } from './set.mjs';

/** Brings the set of pictures that the page names. */
export class PicturesSource {
  #wanted = null; // its address
  #aborter = null;

  /** @param {object} ports progress({loaded, total, ratio}); show(set): it is here; fail(message): it will not come */
  constructor(ports) {
    this.ports = ports;
  }

  /** Whether one is here, or on its way. */
  get there() {
    return Boolean(this.#aborter);
  }

  /** @param {string|null} address null: none is wanted */
  open(address) {
    if (address === this.#wanted) return;
    this.close();
    this.#wanted = address;
    if (address) this.#bring(address);
  }

  close() {
    this.#aborter?.abort();
    this.#aborter = null;
    this.#wanted = null;
  }

  async #bring(address) {
    const aborter = (this.#aborter = new AbortController());
    const { signal } = aborter;
    try {
      const progress = (loaded, total) => this.ports.progress({ loaded, total, ratio: total ? loaded / total : null });
      const set = await fetchModel(new URL(address, document.baseURI).href, undefined, progress, signal);
      readPictures(set); // reports a damaged set before anything is shown
      if (!signal.aborted) await this.ports.show(set);
    } catch (error) {
      if (signal.aborted) return;
      this.#aborter = null; // but what was wanted is kept: it is not tried again
      this.ports.fail(String(error.message));
    }
  }
}
