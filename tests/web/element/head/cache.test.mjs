// SPDX-License-Identifier: GPL-3.0-or-later
// Two faces of a page that show the same head: it comes, is read and is worked out once.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { fingerprint, readOnce, shared, fetchOnce, prepareOnce } from '../../../../web/element/head/model/cache.mjs';

const never = () => new AbortController().signal;
const nothing = () => {};

/** A load that ends when told to. */
function slow() {
  const told = { loads: 0, aborted: 0 };
  const load = (onprogress, signal) => {
    told.loads++;
    signal.addEventListener('abort', () => told.aborted++);
    told.progress = onprogress;
    return new Promise((resolve, reject) => Object.assign(told, { resolve, reject }));
  };
  return { told, load };
}

test('two requests for the same head share one answer, and both get progress', async () => {
  const { told, load } = slow();
  const heard = [[], []];
  const both = heard.map((list) => fetchOnce('a', load, (...p) => list.push(p), never()));
  told.progress(1, 2);
  told.resolve({ name: 'mara' });
  const [one, other] = await Promise.all(both);
  assert.equal(one, other);
  assert.deepEqual(heard, [[[1, 2]], [[1, 2]]]);
  assert.equal(told.loads, 1);
});

test('an aborted request does not affect the other; the load ends without any', async () => {
  const { told, load } = slow();
  const [first, second] = [new AbortController(), new AbortController()];
  const one = fetchOnce('b', load, nothing, first.signal);
  const other = fetchOnce('b', load, nothing, second.signal);
  first.abort();
  await assert.rejects(one, { name: 'AbortError' });
  assert.equal(told.aborted, 0);
  second.abort();
  await assert.rejects(other, { name: 'AbortError' });
  assert.equal(told.aborted, 1);
  const again = fetchOnce('b', load, nothing, never());
  assert.equal(told.loads, 2);
  told.resolve({});
  await again;
});

test('fetches again after a failure', async () => {
  const { told, load } = slow();
  const one = fetchOnce('c', load, nothing, never());
  told.reject(new Error('no way'));
  await assert.rejects(one, /no way/);
  const again = fetchOnce('c', load, nothing, never());
  told.resolve({});
  await again;
  assert.equal(told.loads, 2);
});

test('reads a fetched model once and shares it; reads a model of the page each time', async () => {
  const { told, load } = slow();
  const coming = fetchOnce('d', load, nothing, never());
  told.resolve({ parts: 1 });
  const json = await coming;
  const read = () => ({ model: true });
  const model = readOnce(json, read);
  assert.equal(readOnce(json, read), model);
  assert.equal(await fetchOnce('d', load, nothing, never()), model);
  assert.equal(readOnce(model, read), model);
  assert.equal(told.loads, 1);
  const own = {};
  assert.notEqual(readOnce(own, read), readOnce(own, read));
});

test('computes derived data of a model once', async () => {
  const [model, other] = [{}, {}];
  let count = 0;
  const make = async () => ++count;
  assert.deepEqual([await prepareOnce(model, 'light', make), await prepareOnce(model, 'light', make)], [1, 1]);
  assert.equal(await prepareOnce(model, 'triangles', make), 2);
  assert.equal(await prepareOnce(other, 'light', make), 3);
});

test('makes equal things once, and different things separately', () => {
  let made = 0;
  const make = () => ({ number: made++ });
  const one = shared('list', 'AAAA', make);
  assert.equal(shared('list', 'AAAA', make), one);
  assert.notEqual(shared('list', 'AAAB', make), one);
  assert.notEqual(shared('uv', 'AAAA', make), one, 'another kind of thing is made of it');
  assert.equal(made, 3);
});

test('fingerprints of similar texts differ', () => {
  const texts = Array.from({ length: 20000 }, (_, i) => `AAAA${i.toString(36).padStart(4, '0')}AAAA`);
  assert.equal(new Set(texts.map(fingerprint)).size, texts.length);
});
