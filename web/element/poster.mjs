// SPDX-License-Identifier: MIT
import { httpBase } from './head/model/source.mjs';

/** The picture that stands in for the head: until it has come, and where it cannot be drawn. */
export class Poster {
  #drawn = false;

  /** @param {HTMLImageElement} image @param {HTMLElement} stage that it lies in */
  constructor(image, stage) {
    this.image = image;
    this.stage = stage;
    image.addEventListener('load', () => this.#show());
    image.addEventListener('error', () => this.#show());
  }

  /**
   * @param {string|null} wish the attribute: an address, or `off`; else that of the head
   * @param {string|null} stream address of it @param {{name?: string, poster?: string}} model what is known of the head
   */
  choose(wish, stream, model) {
    let address = wish;
    if (wish === 'off') address = null;
    else if (!wish && stream && (model.poster || model.name))
      address = httpBase(stream) + (model.poster ?? `models/${encodeURIComponent(model.name)}.webp`);
    if (!address) this.image.removeAttribute('src');
    else if (this.image.getAttribute('src') !== address) this.image.src = address;
    this.#show();
  }

  /** @param {boolean} drawn whether the head itself is to be seen */
  set drawn(drawn) {
    this.#drawn = drawn;
    this.#show();
  }

  #show() {
    const { image } = this;
    const there = image.hasAttribute('src') && image.complete && image.naturalWidth > 0;
    image.hidden = this.#drawn || !there;
    this.stage.classList.toggle('posing', !image.hidden);
  }
}
