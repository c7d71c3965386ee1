// SPDX-License-Identifier: MIT
// A picture or a film behind the face. It says nothing: assistive technology skips it.
const FILM = /\.(?:mp4|m4v|webm|ogv)$/i;
const SCHEMES = ['http:', 'https:', 'blob:'];

/** @returns {URL|null} the address, if it is one that a picture may have */
function addressOf(source, base) {
  try {
    const url = new URL(source, base);
    return SCHEMES.includes(url.protocol) || /^data:image\/(?:png|jpeg|webp|gif|avif)[;,]/.test(url.href) ? url : null;
  } catch {
    return null;
  }
}

export class Backdrop {
  #own = null; // of the attribute
  #told = null; // of the room, which goes first
  #shown = '';
  #element = null;

  /** @param {HTMLElement} stage that it lies in, behind all else */
  constructor(stage) {
    this.stage = stage;
  }

  /** @param {string|null} source of the attribute */
  set own(source) {
    this.#own = source;
    this.#show();
  }

  /** @param {string|null} source that the room shows; empty: none */
  set told(source) {
    this.#told = source;
    this.#show();
  }

  #show() {
    const source = this.#told || this.#own || '';
    if (source === this.#shown) return;
    this.#shown = source;
    this.#element?.remove();
    this.#element = null;
    const { ownerDocument: page } = this.stage, url = source && addressOf(source, page.baseURI);
    if (!url) return;
    const film = FILM.test(url.pathname), element = page.createElement(film ? 'video' : 'img');
    Object.assign(element, film ? { muted: true, loop: true, autoplay: true, playsInline: true } : { alt: '', decoding: 'async' });
    element.className = 'backdrop';
    element.setAttribute('part', 'backdrop');
    element.ariaHidden = 'true';
    element.addEventListener('error', () => element.remove()); // rather nothing than a broken picture
    element.src = url.href;
    this.#element = element;
    this.stage.prepend(element);
    if (film && page.defaultView?.matchMedia('(prefers-reduced-motion: reduce)').matches) element.autoplay = false;
  }
}
