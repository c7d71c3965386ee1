// SPDX-License-Identifier: MIT

let webgl = null; // whether the browser can draw a head; null: not known yet

function hasWebgl() {
  if (webgl === null) {
    const context = document.createElement('canvas').getContext('webgl2');
    webgl = context !== null;
    context?.getExtension('WEBGL_lose_context')?.loseContext(); // it counts among those of the page
  }
  return webgl;
}

/**
 * Whether pictures are to be shown, where there are some: when they are asked for, or a head cannot be drawn.
 * @param {string|null} quality the attribute
 */
export const wantsPictures = (quality) => quality === 'pictures' || !hasWebgl();
