// SPDX-License-Identifier: MIT
// Names of shapes and bones as words: `Head_blendShape.mouthSmile_L` is head, blend, shape, mouth, smile, l.

export const SIDES = { l: 'Left', r: 'Right' };

/** Letters and digits alone, small. @param {string} name */
export const keyOf = (name) => name.toLowerCase().replace(/[^a-z0-9]/g, '');

/** @param {string} name @returns {string[]} small; numbers are words of their own */
export const wordsOf = (name) => (name.match(/[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+/g) ?? []).map((word) => word.toLowerCase());

/** @param {string} word @returns {'Left'|'Right'|null} */
export const sideOf = (word) => SIDES[word] ?? { left: 'Left', right: 'Right' }[word] ?? null;
