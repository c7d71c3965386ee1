// SPDX-License-Identifier: MIT
// Marks stretches of the page without touching its text: with the CSS Custom Highlight API, or with boxes that lie over it.

const CSS_HIGHLIGHT = `@layer talking-head {
  ::highlight(talking-head-sentence) { background-color: rgb(255 214 10 / 0.22); }
  ::highlight(talking-head-word) { background-color: #ffd60a; color: #101014; }
  @media (forced-colors: active) { ::highlight(talking-head-word) { background-color: Highlight; color: HighlightText; } }
}`;
const NAMES = { word: 'talking-head-word', sentence: 'talking-head-sentence' };
const sheets = new WeakMap(); // document -> the sheet

/** @param {Document} page @param {Record<string, Range|null>} ranges the range that each kind of mark currently covers */
class Highlights {
  #own = {};

  constructor(page) {
    this.view = page.defaultView;
    if (!sheets.has(page)) {
      const sheet = new this.view.CSSStyleSheet();
      sheet.replaceSync(CSS_HIGHLIGHT);
      sheets.set(page, sheet);
      page.adoptedStyleSheets = [...page.adoptedStyleSheets, sheet];
    }
    for (const [kind, name] of Object.entries(NAMES)) {
      const { highlights } = this.view.CSS;
      if (!highlights.has(name)) highlights.set(name, new this.view.Highlight());
      highlights.get(name).priority = kind === 'word' ? 1 : 0;
    }
  }

  show(kind, range) {
    const marks = this.view.CSS.highlights.get(NAMES[kind]);
    if (this.#own[kind]) marks.delete(this.#own[kind]);
    this.#own[kind] = range;
    if (range) marks.add(range);
  }

  close() {
    for (const kind of Object.keys(NAMES)) this.show(kind, null);
  }
}

/** Boxes at the end of the page; the text is seen through them. */
class Overlays {
  #ranges = {};
  #place = () => Object.keys(this.#ranges).forEach((kind) => this.#draw(kind));

  constructor(page) {
    this.page = page;
    this.host = page.createElement('div');
    this.host.ariaHidden = 'true';
    this.host.setAttribute('data-talking-head-marks', '');
    Object.assign(this.host.style, { position: 'absolute', insetBlockStart: '0', insetInlineStart: '0', pointerEvents: 'none' });
    const root = this.host.attachShadow({ mode: 'open' });
    for (const kind of ['sentence', 'word']) {
      const layer = page.createElement('div');
      layer.dataset.kind = kind;
      root.append(layer);
    }
    page.body.append(this.host);
    page.defaultView.addEventListener('resize', this.#place);
    page.addEventListener('scroll', this.#place, { capture: true, passive: true });
  }

  show(kind, range) {
    this.#ranges[kind] = range;
    this.#draw(kind);
  }

  close() {
    this.page.defaultView.removeEventListener('resize', this.#place);
    this.page.removeEventListener('scroll', this.#place, { capture: true });
    this.host.remove();
  }

  #draw(kind) {
    const range = this.#ranges[kind];
    const zero = this.host.getBoundingClientRect();
    const boxes = [...(range?.getClientRects() ?? [])].map(({ left, top, width, height }) => {
      const box = this.page.createElement('div');
      Object.assign(box.style, {
        position: 'absolute', left: `${left - zero.left}px`, top: `${top - zero.top}px`, width: `${width}px`, height: `${height}px`,
        backgroundColor: kind === 'word' ? 'rgb(255 190 10 / 0.45)' : 'rgb(255 214 10 / 0.16)', borderRadius: '0.15em',
        boxShadow: kind === 'word' ? 'inset 0 -0.14em 0 #c28a00' : 'none',
      });
      return box;
    });
    this.host.shadowRoot.querySelector(`[data-kind="${kind}"]`).replaceChildren(...boxes);
  }
}

/** @param {Document} page @returns {{show(kind: 'word'|'sentence', range: Range|null): void, close(): void}} */
export function openMarks(page) {
  const view = page.defaultView;
  const can = view.CSS?.highlights && view.Highlight && 'adoptedStyleSheets' in page;
  return can ? new Highlights(page) : new Overlays(page);
}
