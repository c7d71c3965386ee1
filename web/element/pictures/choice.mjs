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
 * Whether to prefer photographs over a head: on request, or without WebGL.
 * @param {string|null} quality the attribute
 */
export const wantsPictures = (quality) => quality === 'pictures' || !hasWebgl();
