// SPDX-License-Identifier: MIT
// What is the same in two heads (the mesh of a mouth, the texture of teeth) is kept once while both are loaded.

const kept = new Map(); // key -> WeakRef
const gone = new FinalizationRegistry((key) => {
  if (!kept.get(key)?.deref()) kept.delete(key);
});

/** 53 bits of a text (two multiplicative hashes); the length counts, too. @param {string} text @returns {string} */
export function fingerprint(text) {
  let [a, b] = [0xdeadbeef, 0x41c6ce57];
  for (let i = 0; i < text.length; i++) {
    const code = text.charCodeAt(i);
    a = Math.imul(a ^ code, 2654435761);
    b = Math.imul(b ^ code, 1597334677);
  }
  a = Math.imul(a ^ (a >>> 16), 2246822507) ^ Math.imul(b ^ (b >>> 13), 3266489909);
  b = Math.imul(b ^ (b >>> 16), 2246822507) ^ Math.imul(a ^ (a >>> 13), 3266489909);
  return `${text.length}.${(4294967296 * (2097151 & b) + (a >>> 0)).toString(36)}`;
}

/**
 * @template {object} T
 * @param {string} kind what is made of the text @param {string} text @param {() => T} make @returns {T} never to be changed
 */
export function shared(kind, text, make) {
  const key = `${kind} ${fingerprint(text)}`;
  const there = kept.get(key)?.deref();
  if (there) return there;
  const made = make();
  kept.set(key, new WeakRef(made));
  gone.register(made, key);
  return made;
}
