// SPDX-License-Identifier: MIT
// Shares work between the faces of a page: a head that two of them show is fetched once, read once, and prepared once.

const coming = new Map(); // address -> {promise, aborter, told: Set of onprogress}
const addresses = new WeakMap(); // JSON that has come -> its address
const models = new Map(); // address -> WeakRef of what was read from it
const readings = new WeakMap(); // JSON, or what was read from it -> that
const results = new WeakMap(); // model -> Map of promises

const unusedModels = new FinalizationRegistry((address) => {
  if (!models.get(address)?.deref()) models.delete(address);
});

/**
 * @param {string} address whose answer never changes
 * @param {(onprogress: (...progress: number[]) => void, signal: AbortSignal) => Promise<object>} load
 * @param {(...progress: number[]) => void} onprogress @param {AbortSignal} signal of this one alone: the others go on waiting
 * @returns {Promise<object>} the JSON, or what has been read from it already
 */
export function fetchOnce(address, load, onprogress, signal) {
  const model = models.get(address)?.deref();
  if (model) return Promise.resolve(model);
  const one = coming.get(address) ?? begin(address, load);
  const tell = (...progress) => onprogress(...progress); // a function of its own: two callers may pass the same one
  one.told.add(tell);
  return new Promise((resolve, reject) => {
    one.promise.then(resolve, reject);
    signal.addEventListener('abort', () => {
      one.told.delete(tell);
      reject(signal.reason);
      if (one.told.size || coming.get(address) !== one) return;
      coming.delete(address);
      one.aborter.abort(); // the last waiter has gone
    });
  });
}

function begin(address, load) {
  const one = { told: new Set(), aborter: new AbortController() };
  one.promise = load((...progress) => one.told.forEach((tell) => tell(...progress)), one.aborter.signal)
    .then((json) => {
      addresses.set(json, address);
      return json;
    })
    .finally(() => {
      if (coming.get(address) === one) coming.delete(address);
    });
  coming.set(address, one);
  return one;
}

/**
 * Reads a model that fetchOnce() fetched only once. A model from the page is read each time, as it may have changed.
 * @template T @param {object} json @param {(json: object) => T} read @returns {T}
 */
export function readOnce(json, read) {
  const before = readings.get(json);
  if (before) return before;
  const model = read(json);
  const address = addresses.get(json);
  if (!address) return model;
  readings.set(json, model);
  readings.set(model, model);
  models.set(address, new WeakRef(model));
  unusedModels.register(model, address);
  return model;
}

/**
 * Computes derived data of a model once for all heads that show it.
 * @template T @param {object} model @param {string} what
 * @param {() => Promise<T>} make @returns {Promise<T>} never to be changed
 */
export function prepareOnce(model, what, make) {
  const known = results.get(model) ?? results.set(model, new Map()).get(model);
  if (!known.has(what)) known.set(what, make());
  return known.get(what);
}

// Data that two heads have in common (the mesh of a mouth, the texture of teeth) is kept once while both are loaded.

const sharedData = new Map(); // key -> WeakRef
const unusedData = new FinalizationRegistry((key) => {
  if (!sharedData.get(key)?.deref()) sharedData.delete(key);
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
  const there = sharedData.get(key)?.deref();
  if (there) return there;
  const made = make();
  sharedData.set(key, new WeakRef(made));
  unusedData.register(made, key);
  return made;
}
