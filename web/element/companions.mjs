// SPDX-License-Identifier: MIT
// Addresses of the files that the element fetches on demand: beside its script. Each address is written out as
// `new URL('./NAME', import.meta.url)`, the pattern that Vite, webpack and tools based on them look for: they copy the file
// and replace the address. It is evaluated only on use, because it does not exist during server-side rendering.
const BESIDE = {
  'talking-head-worklet.js': () => new URL('./talking-head-worklet.js', import.meta.url),
  'opus-decoder.js': () => new URL('./opus-decoder.js', import.meta.url),
  'talking-head-avatar.js': () => new URL('./talking-head-avatar.js', import.meta.url),
  'talking-head-draco.js': () => new URL('./talking-head-draco.js', import.meta.url), // this one and the next: for the script of avatars
  'talking-head-basis.js': () => new URL('./talking-head-basis.js', import.meta.url),
};

let folder = null; // where a page has said that they are

/** @param {string|URL} address of the folder, in the page's own terms */
export function setCompanions(address) {
  const url = new URL(address, globalThis.document?.baseURI).href;
  folder = url.endsWith('/') ? url : `${url}/`;
}

/** @param {keyof typeof BESIDE} name @returns {string} its address */
export const companion = (name) => (folder === null ? BESIDE[name]() : new URL(name, folder)).href;
