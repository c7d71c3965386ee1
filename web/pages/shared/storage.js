// SPDX-License-Identifier: MIT
// What the browser keeps for a page. Where it keeps nothing (a setting of the user), a page works all the same.

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
