// SPDX-License-Identifier: MIT
// A picture or a film behind the face, or a room (room-backdrop.mjs). It says nothing: assistive technology skips it.
const ROOM = 'room';
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

  /**
   * @param {HTMLElement} stage that it lies in, behind all else
   * @param {(there: boolean) => void} changed told whether there is one
   */
  constructor(stage, changed) {
    this.stage = stage;
    this.changed = changed;
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
    this.#element = source === ROOM ? this.#room() : source ? this.#picture(source) : null;
    if (this.#element) this.stage.prepend(this.#element);
    this.changed(Boolean(this.#element));
  }

  #made(name, className = 'backdrop') {
    const element = this.stage.ownerDocument.createElement(name);
    element.className = className;
    element.setAttribute('part', 'backdrop');
    element.ariaHidden = 'true';
    return element;
  }

  #room() {
    return this.#made('div', 'backdrop room');
  }

  #picture(source) {
    const { ownerDocument: page } = this.stage, url = addressOf(source, page.baseURI);
    if (!url) return null;
    const film = FILM.test(url.pathname), element = this.#made(film ? 'video' : 'img');
    const moving = { muted: true, loop: true, autoplay: true, playsInline: true };
    Object.assign(element, film ? moving : { alt: '', decoding: 'async' });
    element.addEventListener('error', () => {
      element.remove(); // rather nothing than a broken picture
      if (this.#element === element) this.changed(false);
    });
    element.src = url.href;
    if (film && page.defaultView?.matchMedia('(prefers-reduced-motion: reduce)').matches) element.autoplay = false;
    return element;
  }
}
