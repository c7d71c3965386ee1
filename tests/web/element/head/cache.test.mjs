// SPDX-License-Identifier: GPL-3.0-or-later
// Two faces of a page that show the same head: it comes, is read and is worked out once.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readOnce, together, workedOut } from '../../../../web/element/head/model/cache.mjs';

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

test('two that want the same head wait for one answer, and both hear how far it is', async () => {
  const { told, load } = slow();
  const heard = [[], []];
  const both = heard.map((list) => together('a', load, (...p) => list.push(p), never()));
  told.progress(1, 2);
  told.resolve({ name: 'mara' });
  const [one, other] = await Promise.all(both);
  assert.equal(one, other);
  assert.deepEqual(heard, [[[1, 2]], [[1, 2]]]);
  assert.equal(told.loads, 1);
});

test('one that gives up takes nothing from the other; when nobody waits any more the load ends', async () => {
  const { told, load } = slow();
  const [first, second] = [new AbortController(), new AbortController()];
  const one = together('b', load, nothing, first.signal);
  const other = together('b', load, nothing, second.signal);
  first.abort();
  await assert.rejects(one, { name: 'AbortError' });
  assert.equal(told.aborted, 0);
  second.abort();
  await assert.rejects(other, { name: 'AbortError' });
  assert.equal(told.aborted, 1);
  const again = together('b', load, nothing, never());
  assert.equal(told.loads, 2);
  told.resolve({});
  await again;
});

test('what could not be fetched is asked for anew', async () => {
  const { told, load } = slow();
  const one = together('c', load, nothing, never());
  told.reject(new Error('no way'));
  await assert.rejects(one, /no way/);
  const again = together('c', load, nothing, never());
  told.resolve({});
  await again;
  assert.equal(told.loads, 2);
});

test('what has come is read once, and later ones get it without asking; what a page brings is read each time', async () => {
  const { told, load } = slow();
  const coming = together('d', load, nothing, never());
  told.resolve({ parts: 1 });
  const json = await coming;
  const read = () => ({ model: true });
  const model = readOnce(json, read);
  assert.equal(readOnce(json, read), model);
  assert.equal(await together('d', load, nothing, never()), model);
  assert.equal(readOnce(model, read), model);
  assert.equal(told.loads, 1);
  const own = {};
  assert.notEqual(readOnce(own, read), readOnce(own, read));
});

test('what is worked out of a model is worked out once', async () => {
  const [model, other] = [{}, {}];
  let count = 0;
  const make = async () => ++count;
  assert.deepEqual([await workedOut(model, 'light', make), await workedOut(model, 'light', make)], [1, 1]);
  assert.equal(await workedOut(model, 'triangles', make), 2);
  assert.equal(await workedOut(other, 'light', make), 3);
});
