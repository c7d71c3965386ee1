// SPDX-License-Identifier: MIT

const sheets = new WeakMap(); // document -> the sheet that all elements in it share

/**
 * Styles a shadow root. A constructed sheet needs no leave of a content security policy; browsers without them get a
 * `style` element.
 * @param {ShadowRoot} root @param {string} css
 */
export function applyStyles(root, css) {
  const page = root.ownerDocument;
  const Sheet = page.defaultView?.CSSStyleSheet;
  if (!('adoptedStyleSheets' in root) || !Sheet?.prototype.replaceSync) {
    if (root.querySelector('style')) return;
    const style = page.createElement('style');
    style.textContent = css;
    root.prepend(style);
    return;
  }
  if (!sheets.has(page)) {
    const sheet = new Sheet();
    sheet.replaceSync(css);
    sheets.set(page, sheet);
  }
  root.adoptedStyleSheets = [sheets.get(page)];
}
