// SPDX-License-Identifier: MIT
// Scrolls along with what is read, and lets go as soon as the reader scrolls away, until what is read is in sight again.

const OWN_MS = 900; // duration of our own smooth scroll
const SETTLE_MS = 400; // duration of the scroll by which the user chose the start

export class Follow {
  #on = true;
  #own = 0; // until when scrolling is ours
  #away = () => (this.#on = false);
  #scrolled = () => {
    if (performance.now() > this.#own) this.#on = false;
  };

  /** @param {Element} root what is read */
  constructor(root) {
    this.page = root.ownerDocument;
    this.calm = this.page.defaultView.matchMedia('(prefers-reduced-motion: reduce)');
    this.box = scrollerOf(root);
    this.again();
    for (const type of ['wheel', 'touchmove']) this.page.addEventListener(type, this.#away, { passive: true });
    this.page.addEventListener('scroll', this.#scrolled, { capture: true, passive: true });
  }

  close() {
    for (const type of ['wheel', 'touchmove']) this.page.removeEventListener(type, this.#away);
    this.page.removeEventListener('scroll', this.#scrolled, { capture: true });
  }

  /** The reader has chosen where to go on: that is to be seen. */
  again() {
    this.#on = true;
    this.#own = Math.max(this.#own, performance.now() + SETTLE_MS);
  }

  /** @param {Range} range what is read now */
  to(range) {
    const { top, bottom, height } = range.getBoundingClientRect();
    if (!height) return;
    const view = this.#view();
    const room = view.bottom - view.top;
    const seen = bottom > view.top && top < view.bottom;
    if (seen) this.#on = true;
    const [high, low] = [view.top + room * 0.12, view.bottom - room * 0.25];
    if (!this.#on || (top >= high && bottom <= low)) return;
    this.#own = performance.now() + OWN_MS;
    const distance = top - (view.top + room * 0.3);
    (this.box ?? this.page.scrollingElement).scrollBy({ top: distance, behavior: this.calm.matches ? 'instant' : 'smooth' });
  }

  /** Returns the visible area of the scroll container, without sticky content over it (given by scroll-padding). */
  #view() {
    const { innerHeight } = this.page.defaultView;
    const element = this.box ?? this.page.documentElement;
    const style = this.page.defaultView.getComputedStyle(element);
    const box = this.box ? this.box.getBoundingClientRect() : { top: 0, bottom: innerHeight };
    return {
      top: Math.max(0, box.top) + (parseFloat(style.scrollPaddingTop) || 0),
      bottom: Math.min(innerHeight, box.bottom) - (parseFloat(style.scrollPaddingBottom) || 0),
    };
  }
}

/** The element that scrolls the text; null: the page. */
function scrollerOf(root) {
  const { body, documentElement, defaultView } = root.ownerDocument;
  for (let element = root; element && element !== body && element !== documentElement; element = element.parentElement) {
    const { overflowY } = defaultView.getComputedStyle(element);
    if (/auto|scroll/.test(overflowY) && element.scrollHeight > element.clientHeight + 1) return element;
  }
  return null;
}
