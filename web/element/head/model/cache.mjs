// SPDX-License-Identifier: MIT
// What several faces of a page have in common: a head that two of them show is fetched once, read once, and worked out once.

const coming = new Map(); // address -> {promise, aborter, told: Set of onprogress}
const addresses = new WeakMap(); // JSON that has come -> its address
const models = new Map(); // address -> WeakRef of what was read from it
const readings = new WeakMap(); // JSON, or what was read from it -> that
const results = new WeakMap(); // model -> Map of promises

const gone = new FinalizationRegistry((address) => {
  if (!models.get(address)?.deref()) models.delete(address);
});

/**
 * @param {string} address whose answer never changes
 * @param {(onprogress: (...progress: number[]) => void, signal: AbortSignal) => Promise<object>} load
 * @param {(...progress: number[]) => void} onprogress @param {AbortSignal} signal of this one alone: the others go on waiting
 * @returns {Promise<object>} the JSON, or what has been read from it already
 */
export function together(address, load, onprogress, signal) {
  const model = models.get(address)?.deref();
  if (model) return Promise.resolve(model);
  const one = coming.get(address) ?? begin(address, load);
  const tell = (...progress) => onprogress(...progress); // its own, whoever else has the same
  one.told.add(tell);
  return new Promise((resolve, reject) => {
    one.promise.then(resolve, reject);
    signal.addEventListener('abort', () => {
      one.told.delete(tell);
      reject(signal.reason);
      if (one.told.size || coming.get(address) !== one) return;
      coming.delete(address);
      one.aborter.abort(); // nobody waits any more
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
 * Reads what has come together() once only; what a page brings may have changed since.
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
  gone.register(model, address);
  return model;
}

/**
 * What is worked out of a model, for all heads that show it.
 * @template T @param {object} model @param {string} what
 * @param {() => Promise<T>} make @returns {Promise<T>} never to be changed
 */
export function workedOut(model, what, make) {
  const known = results.get(model) ?? results.set(model, new Map()).get(model);
  if (!known.has(what)) known.set(what, make());
  return known.get(what);
}
