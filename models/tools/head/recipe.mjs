// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Reads a recipe. A recipe with `like` inherits from another: objects are merged, lists and values replaced, null removes; an object with `"like": null` inherits nothing.
 */
import fs from 'node:fs';
import path from 'node:path';

const MOST_ANCESTORS = 8;

/** @param {string} file @returns {object} the complete recipe */
export function readRecipe(file, depth = 0) {
  if (depth > MOST_ANCESTORS) throw new Error(`${file}: recipes are like each other in a circle`);
  const { like, ...own } = JSON.parse(fs.readFileSync(file, 'utf8'));
  if (like === undefined) return own;
  return merge(readRecipe(path.join(path.dirname(file), `${like}.json`), depth + 1), own);
}

export function merge(base, over) {
  const out = { ...base };
  for (const [key, value] of Object.entries(over)) {
    if (value === null) delete out[key];
    else if (isObject(value) && value.like === null) {
      const { like: _, ...alone } = value;
      out[key] = alone;
    } else if (isObject(value) && isObject(out[key])) out[key] = merge(out[key], value);
    else out[key] = value;
  }
  return out;
}

function isObject(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}
