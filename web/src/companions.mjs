// SPDX-License-Identifier: MIT
// Where the files lie that the element fetches when it needs them: beside its script, unless a page that bundles it tells.
let folder = import.meta.url;

/** @param {string|URL} address of the folder, in the page's own terms */
export function setCompanions(address) {
  const url = new URL(address, globalThis.document?.baseURI).href;
  folder = url.endsWith('/') ? url : `${url}/`;
}

/** @param {string} name @returns {string} its address */
export const companion = (name) => new URL(name, folder).href;
