// SPDX-License-Identifier: MIT

/** Whether an element can be seen: on the page's visible part, and the page not hidden. */
export class Visibility {
  /** @param {Element} element @param {() => void} onchange */
  constructor(element, onchange) {
    this.element = element;
    this.onchange = onchange;
    this.near = false;
    this.observer = new IntersectionObserver((entries) => this.#set(entries.at(-1).isIntersecting));
  }

  get seen() {
    return this.near && document.visibilityState !== 'hidden';
  }

  open() {
    this.observer.observe(this.element);
    document.addEventListener('visibilitychange', this.onchange);
  }

  close() {
    this.observer.disconnect();
    document.removeEventListener('visibilitychange', this.onchange);
    this.near = false;
  }

  #set(near) {
    this.near = near;
    this.onchange();
  }
}
