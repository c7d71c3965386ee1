// SPDX-License-Identifier: MIT
import { companion } from '../companions.mjs';

const load = () => import(/* webpackIgnore: true */ /* @vite-ignore */ companion('talking-head-avatar.js'));

/** Brings an avatar, and before it the script that can read one. */
export class AvatarSource {
  #wanted = ''; // its address, and its mapping's
  #aborter = null;

  /**
   * @param {object} ports progress({loaded, total, ratio}); show(model): it is here; fail(reason, message): it will not come
   */
  constructor(ports) {
    this.ports = ports;
  }

  /** Whether one is here, or on its way. */
  get there() {
    return Boolean(this.#aborter);
  }

  /** @param {string|null} avatar its address; null: none is wanted @param {string|null} map of its mapping file */
  open(avatar, map) {
    const wanted = avatar ? `${avatar} ${map ?? ''}` : '';
    if (wanted === this.#wanted) return;
    this.close();
    this.#wanted = wanted;
    if (wanted) this.#bring(avatar, map);
  }

  close() {
    this.#aborter?.abort();
    this.#aborter = null;
    this.#wanted = '';
  }

  async #bring(avatar, map) {
    const aborter = (this.#aborter = new AbortController());
    const { signal } = aborter;
    const absolute = (address) => new URL(address, document.baseURI).href;
    const progress = (loaded, total) => this.ports.progress({ loaded, total, ratio: total ? loaded / total : null });
    try {
      const { openAvatar } = await load().catch((error) => {
        throw Object.assign(error, { reason: 'no-script' });
      });
      const unpackers = { draco: companion('talking-head-draco.js'), basis: companion('talking-head-basis.js') };
      const model = await openAvatar(absolute(avatar), { map: map ? absolute(map) : null, signal, progress, unpackers });
      if (!signal.aborted) this.ports.show(model);
    } catch (error) {
      if (signal.aborted) return;
      this.#aborter = null; // but what was wanted is kept: it is not tried again
      this.ports.fail(error.reason ?? 'damaged', String(error.message));
    }
  }
}
