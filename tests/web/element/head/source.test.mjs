// SPDX-License-Identifier: GPL-3.0-or-later
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { ModelSource } from '../../../../web/element/head/model/source.mjs';

const stream = 'ws://example.org/x/v1/stream?room=a';
const hello = { models: [{ name: 'mara', bytes: 12 }, { name: 'other' }] };
const parts = [
  { index: 0, count: 2, kind: 'head', data: { name: 'mara' } },
  { index: 1, count: 2, kind: 'part', part: 'skin', data: { name: 'skin' } },
];

/** A source whose fetches answer as told (a Response, or an error), and what it did. */
function source(t, ...answers) {
  const done = { fetched: [], asked: [], shown: [], progress: [] };
  t.mock.method(globalThis, 'fetch', async (url, { signal }) => {
    done.fetched.push(url);
    const answer = answers.shift();
    if (answer === 'hang') await new Promise((_, fail) => signal.addEventListener('abort', () => fail(signal.reason)));
    if (answer instanceof Error) throw answer;
    return answer;
  });
  const models = new ModelSource({ ask: (m) => done.asked.push(m), progress: (p) => done.progress.push(p), show: (json) => done.shown.push(json) });
  return { models, done };
}
const json = () => new Response('{"name":"mara"}');

test('fetches a model over HTTP, next to the stream, once', async (t) => {
  const { models, done } = source(t, json());
  await models.open(stream, hello, null);
  await models.open(stream, hello, null); // the stream was lost and is there again
  assert.deepEqual(done.fetched, ['http://example.org/x/v1/models/mara']);
  assert.deepEqual(done.shown, [{ name: 'mara' }]);
  assert.deepEqual(done.asked, []);
  assert.ok(done.progress.length && done.progress.every(({ ratio }) => ratio > 0 && ratio <= 1));
});

test('fetches by hash where the server gives one, so that caches keep it permanently', async (t) => {
  const { models, done } = source(t, json());
  await models.open(stream, { models: [{ name: 'mara', hash: 'abc12' }] }, null);
  assert.deepEqual(done.fetched, ['http://example.org/x/v1/models/mara?v=abc12']);
});

test('fetches in parts through the stream when HTTP is closed', async (t) => {
  const { models, done } = source(t, new TypeError('no way'));
  await models.open(stream, hello, 'mara');
  assert.deepEqual(done.asked, [{ type: 'model', name: 'mara' }]);
  for (const part of parts) models.take(part);
  assert.deepEqual(done.shown, [{ name: 'mara', parts: [{ name: 'skin' }], textures: {} }]);
  assert.deepEqual(done.progress.map(({ ratio }) => ratio), [0.5, 1]);
  await models.open(stream, hello, 'mara');
  assert.equal(done.fetched.length, 1, 'it is here');
});

test('fetches again after the stream was lost and restored', async (t) => {
  const { models, done } = source(t, new TypeError('the server is gone'), json());
  await models.open(stream, hello, null);
  models.take(parts[0]);
  await models.open(stream, hello, null);
  assert.equal(done.fetched.length, 2);
  assert.deepEqual(done.shown, [{ name: 'mara' }]);
});

test('a request for another model discards the pending one', async (t) => {
  const { models, done } = source(t, 'hang', json());
  const first = models.open(stream, hello, null);
  models.close();
  await first;
  await models.open(stream, hello, 'other');
  assert.deepEqual(done.fetched.map((url) => url.split('/').at(-1)), ['mara', 'other']);
  assert.equal(done.shown.length, 1);
  assert.deepEqual(done.asked, []);
});
