// SPDX-License-Identifier: MIT
// Local and session storage. A page also works in a browser whose user has switched them off.

const attempt = (act) => {
  try {
    return act();
  } catch {
    return null; // storage is closed to this page, or full
  }
};

/** For all visits. */
export const forGood = {
  get: (key) => attempt(() => localStorage.getItem(key)),
  set: (key, value) => attempt(() => localStorage.setItem(key, value)),
};

/** For this tab. */
export const forTab = {
  get: (key) => attempt(() => sessionStorage.getItem(key)),
  set: (key, value) => attempt(() => sessionStorage.setItem(key, value)),
  remove: (key) => attempt(() => sessionStorage.removeItem(key)),
};
