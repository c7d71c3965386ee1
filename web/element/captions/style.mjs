// SPDX-License-Identifier: MIT

// The word that is heard differs by its ground, by a line under it and, where the system chooses the colours, by a frame.
// `caption-size` and `caption-colours` only choose values of the custom properties that a page can set, too.
export const captionStyle = `
  .captions { flex: none; box-sizing: border-box; min-block-size: 3.6em; display: grid; place-items: center;
    padding: 0.35em 0.6em; text-align: center;
    font-size: var(--talking-head-caption-size, 1.15em); line-height: 1.35;
    background: var(--talking-head-caption-background, #101014);
    color: var(--talking-head-caption-color, #fff); border-radius: 0.4em; overflow-wrap: anywhere; }
  .captions.empty { background: none; }
  .captions p { margin: 0; }
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
