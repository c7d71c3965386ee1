// SPDX-License-Identifier: MIT
import { CAPTION_LEAST_EM } from './captions/captions.mjs';
import { roomCss } from './room-backdrop.mjs';

// A page's own rules go over those of :host, so nothing inside depends on them: `.layout` fills the element, and is
// 20rem by 26rem unless the page sets a size (`display: block` with `height: auto`, `all: unset`).

// The word that is heard differs by its ground, by a line under it and, where the system chooses the colours, by a frame.
// `caption-size` and `caption-colours` only choose values of the custom properties that a page can set, too.
export const captionStyle = `
  .captions { flex: none; box-sizing: border-box; min-block-size: ${CAPTION_LEAST_EM}em; display: grid; place-items: center;
    padding: 0.35em 0.6em; text-align: center;
    font-size: var(--talking-head-caption-size, 1.15em); line-height: 1.35;
    background: var(--talking-head-caption-background, #101014);
    color: var(--talking-head-caption-color, #fff); border-radius: 0.4em; overflow-wrap: anywhere; }
  .captions.empty { display: none; }
  .over .captions { position: absolute; inset-inline: 0; inset-block-end: 0; }
  .captions p { margin: 0; }
  .who { font-weight: 600; }
  .said { color: color-mix(in srgb, currentcolor var(--talking-head-said-strength, 72%), transparent); }
  .word:not(:empty) { background: var(--talking-head-word-background, #ffd60a); color: var(--talking-head-word-color, #101014);
    border-radius: 0.2em; box-shadow: 0 0 0 0.12em var(--talking-head-word-background, #ffd60a);
    text-decoration: underline 0.1em; text-underline-offset: 0.14em; }
  :host([caption-size='large']) { --talking-head-caption-size: 1.5em; }
  :host([caption-size='larger']) { --talking-head-caption-size: 2em; }
  :host([caption-size='largest']) { --talking-head-caption-size: 2.6em; }
  :host([caption-colours='contrast']) { --talking-head-caption-background: #000; --talking-head-caption-color: #fff;
    --talking-head-word-background: #fff; --talking-head-word-color: #000; --talking-head-said-strength: 100%; }
  :host([caption-colours='light']) { --talking-head-caption-background: #fff; --talking-head-caption-color: #14110f;
    --talking-head-word-background: #123f8c; --talking-head-word-color: #fff; }
  :host([caption-colours='yellow']) { --talking-head-caption-background: #000; --talking-head-caption-color: #ffe600;
    --talking-head-word-background: #ffe600; --talking-head-word-color: #000; --talking-head-said-strength: 100%; }
  @media (forced-colors: active) {
    .captions { background: Canvas; color: CanvasText; border: 2px solid CanvasText; }
    .said { color: inherit; }
    .word:not(:empty) { forced-color-adjust: none; background: Highlight; color: HighlightText; box-shadow: none;
      outline: 2px solid CanvasText; }
    .message, button { border: 2px solid; }
  }
`;

export const styles = `
  :host { display: inline-flex; flex-direction: column; inline-size: 20rem; block-size: 26rem; min-inline-size: 0;
    min-block-size: 0; position: relative; }
  :host([hidden]), [hidden] { display: none !important; }
  .layout { display: flex; flex-direction: column; position: relative; inline-size: 100%; block-size: 100%; min-inline-size: 0;
    min-block-size: 0; contain: inline-size; contain-intrinsic-inline-size: 20rem; font-family: system-ui, sans-serif; }
  .stage { position: relative; flex: 1 1 26rem; min-block-size: 0; overflow: clip; }
  .backdrop { position: absolute; inset: 0; inline-size: 100%; block-size: 100%; object-fit: cover; }
  .room { background: ${roomCss}; }
  canvas { position: absolute; inset: 0; inline-size: 100%; block-size: 100%; display: block; }
  .poster { position: absolute; inset: 0; margin-inline: auto; max-inline-size: 100%; block-size: 100%; object-fit: contain;
    mask-image: linear-gradient(90deg, transparent, #000 12%, #000 88%, transparent); }
  .message { position: absolute; inset: 0; margin: auto; inline-size: fit-content; block-size: fit-content;
    max-inline-size: 90%; max-block-size: 100%; overflow: auto; box-sizing: border-box; padding: 0.75em 1em; border-radius: 0.5em;
    text-align: center; overflow-wrap: anywhere;
    background: #1c1c1eee; color: #fff; }
  .turnable { touch-action: pan-y pinch-zoom; user-select: none; -webkit-user-select: none; cursor: grab; }
  .turnable:active { cursor: grabbing; }
  .turn { position: absolute; inset-inline: 20%; inset-block-end: 0.5em; inline-size: 60%; block-size: 2.75em; margin: 0; opacity: 0;
    pointer-events: none; }
  .turn:focus-visible { opacity: 1; outline: 3px solid #4c9dff; outline-offset: 2px; }
  .posing .message { inset-block-start: auto; inset-block-end: 0.75em; margin-block: 0; }
  button { font: inherit; cursor: pointer; border: 2px solid #fff; background: #1c1c1eee; color: #fff;
    border-radius: 2em; min-block-size: 2.75em; min-inline-size: 2.75em; padding: 0 1em; }
  button:focus-visible { outline: 3px solid #4c9dff; outline-offset: 2px; }
  .sound { position: absolute; inset-inline: 0; inset-block-end: 0.75em; margin-inline: auto; inline-size: fit-content; }
  .over .sound, .over .turn, .over .posing .message { inset-block-end: calc(var(--talking-head-caption-size, 1.15em) * ${CAPTION_LEAST_EM} + 0.75em); }
  svg { inline-size: 1.4em; vertical-align: -0.3em; fill: none; stroke: currentColor; stroke-width: 2; stroke-linejoin: round;
    stroke-linecap: round; }
  .switch, .mouth, .play { position: absolute; inset-inline-end: 0.5em; inset-block-start: 0.5em; opacity: 0.8; padding: 0;
    font-weight: 600; font-size: 0.85em; min-block-size: 3.25em; min-inline-size: 3.25em; }
  .mouth { inset-block-start: 4.25em; }
  .play { inset-inline: 0.5em auto; }
  .play:hover, .play:focus-visible, .play:not(.playing) { opacity: 1; }
  .play:not(.playing) .off, .playing .on { display: none; }
  .switch:hover, .switch:focus-visible, .switch[aria-pressed='false'], .mouth:hover, .mouth:focus-visible { opacity: 1; }
  .mouth[aria-pressed='true'] { opacity: 1; background: #fff; color: #1c1c1e; }
  .switch[aria-pressed='false'] { text-decoration: line-through; background: #6c6c70ee; }
${captionStyle}`;

const SVG = 'http://www.w3.org/2000/svg';
const WAVES = 'M4 9v6h4l5 4V5L8 9zM16 8.5a5 5 0 0 1 0 7M18.5 6a8.5 8.5 0 0 1 0 12';
const PLAY = 'M7 4v16l13-8z';
const PAUSE = 'M8 5v14M16 5v14';
const LIPS = 'M2 12q5-7 10-3q5-4 10 3q-4 7-10 7t-10-7zq10 3 20 0';

/** Made piece by piece, since pages may forbid that text becomes markup (Trusted Types). */
function make(name, attributes = {}, children = [], namespace = 'http://www.w3.org/1999/xhtml') {
  const element = document.createElementNS(namespace, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** Makes the content of the shadow root. @returns {Node[]} */
export function parts() {
  const icon = (d, name = '') => make('svg', { viewBox: '0 0 24 24', 'aria-hidden': 'true', class: name }, [make('path', { d }, [], SVG)], SVG);
  const line = ['who', 'said', 'word', 'rest'].map((name) => make('span', { class: name, part: name }));
  const stage = make('div', { class: 'stage', part: 'stage' }, [
    make('img', { class: 'poster', part: 'poster', alt: '', hidden: '' }),
    make('canvas', { part: 'canvas', role: 'img' }),
    make('p', { class: 'message', part: 'message', role: 'status', hidden: '' }),
    make('input', { class: 'turn', part: 'turn', type: 'range' }),
    make('button', { class: 'switch', part: 'captions-button', type: 'button' }, ['CC']),
    make('button', { class: 'mouth', part: 'mouth-button', type: 'button', 'aria-pressed': 'false', hidden: '' }, [icon(LIPS)]),
    make('button', { class: 'play', part: 'play-button', type: 'button', hidden: '' }, [icon(PLAY, 'on'), icon(PAUSE, 'off')]),
    make('button', { class: 'sound', part: 'sound-button', type: 'button', hidden: '' }, [icon(WAVES), ' ', make('span')]),
  ]);
  const captions = make('div', { class: 'captions', part: 'captions', 'aria-live': 'off' }, [make('p', { dir: 'auto' }, line)]);
  return [make('div', { class: 'layout' }, [stage, captions])];
}

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
