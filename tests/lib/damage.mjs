// SPDX-License-Identifier: GPL-3.0-or-later
// Makes variants of a document with an error in one place.

/** Splits a JSON pointer such as "/a~1b/0" (RFC 6901). */
const parts = (pointer) => pointer.split('/').slice(1).map((part) => part.replaceAll('~1', '/').replaceAll('~0', '~'));

/** Returns a copy with values set and members removed by JSON pointer ("-" appends to a list, "" is the whole document). */
export function edited(document, { set = {}, remove = [] }) {
  let out = structuredClone(document);
  const holder = (path) => path.slice(0, -1).reduce((value, part) => value[part], out);
  for (const [pointer, value] of Object.entries(set)) {
    const path = parts(pointer), last = path.at(-1);
    if (!path.length) out = value;
    else if (last === '-' && Array.isArray(holder(path))) holder(path).push(value);
    else holder(path)[last] = value;
  }
  for (const pointer of remove) {
    const path = parts(pointer), from = holder(path), last = path.at(-1);
    if (!(last in from)) throw new Error(`there is no ${pointer}`);
    if (Array.isArray(from)) from.splice(Number(last), 1);
    else delete from[last];
  }
  return out;
}

const pointerOf = (path) => path.map((part) => `/${String(part).replaceAll('~', '~0').replaceAll('/', '~1')}`).join('');

function* nodes(value, path = []) {
  yield [path, value];
  if (value && typeof value === 'object') for (const key of Array.isArray(value) ? value.keys() : Object.keys(value)) yield* nodes(value[key], [...path, key]);
}

/** Replacements for a value: values of other types, and other values of its type. */
function others(value) {
  const all = [null, true, -1, 0, 1.5, 1e9, '', 'x', [], {}, ['x'], { x: 1 }];
  return typeof value === 'number' ? [...all, -value - 1, value * 1000 + 1000] : all;
}

/**
 * Generates all edits of one place: another value, a removal, an extra member. Of similar places (equal paths except for indices) it
 * uses at most `alike`.
 */
export function* damages(document, alike = 1) {
  const seen = new Map();
  for (const [path, value] of nodes(document)) {
    const shape = JSON.stringify([path.map((part, i) => (typeof part === 'number' ? '#' : i === path.length - 1 || i < 1 ? part : '*')), typeof value]);
    seen.set(shape, (seen.get(shape) ?? 0) + 1);
    if (seen.get(shape) > alike) continue;
    const at = pointerOf(path);
    for (const other of others(value)) if (JSON.stringify(other) !== JSON.stringify(value)) yield { set: { [at]: other } };
    if (path.length) yield { remove: [at] };
    if (value && typeof value === 'object' && !Array.isArray(value)) yield { set: { [`${at}/unheard-of`]: 1 } };
    if (Array.isArray(value) && value.length) yield { set: { [`${at}/-`]: value[0] } };
  }
}
