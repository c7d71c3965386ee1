// SPDX-License-Identifier: MIT
// Size, spacing and contrast of the text, stored on this device.
import { forGood } from '../shared/storage.js';

const LOOKS = 'faccia.reading';

/** @returns {{size?: string, wide?: boolean, contrast?: boolean}} */
export function keptLooks() {
  try {
    return JSON.parse(forGood.get(LOOKS)) ?? {};
  } catch {
    return {}; // not ours
  }
}

export const keepLooks = (looks) => forGood.set(LOOKS, JSON.stringify(looks));

/** @param {HTMLElement} passage @param {{size?: string, wide?: boolean, contrast?: boolean}} looks */
export function applyLooks(passage, { size, wide = false, contrast = false }) {
  if (size) passage.style.setProperty('--size', `${size}rem`);
  passage.classList.toggle('wide', wide);
  document.documentElement.classList.toggle('contrast', contrast);
}
