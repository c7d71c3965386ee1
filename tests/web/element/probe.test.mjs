// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { streamAddress, withEvents } from '../../../web/element/stream/link.mjs';
import { reasonOf, serverOf, wantsToken } from '../../../web/element/stream/probe.mjs';

const page = new EventTarget();

/** A fetch that answers by mode: a status, or null for a failure. */
const answering = (cors, opaque, before = () => {}) => (url, { mode }) => {
  before(url, mode);
  const status = mode === 'no-cors' ? opaque : cors;
  return status === null ? Promise.reject(new TypeError('failed')) : Promise.resolve({ status });
};
const ask = (...answers) => reasonOf('wss://there:1/v1/stream?token=secret#x', { fetch: answering(...answers), page });

test('finds out why a WebSocket does not open', async () => {
  assert.equal(await ask(null, null), 'noServer');
  assert.equal(await ask(null, 0), 'forbiddenOrigin');
  assert.equal(await ask(403, 0), 'forbiddenOrigin', 'the page’s own server, under another name');
  assert.equal(await ask(426, 0), 'serverBusy');
  assert.equal(await ask(503, 0), 'serverBusy');
  assert.equal(await ask(404, 0), 'wrongAddress');
  assert.equal(await ask(200, 0), 'wrongAddress', 'some other server');
});

test('does not blame the server for the page’s own policy', async () => {
  const violate = (url) => page.dispatchEvent(Object.assign(new Event('securitypolicyviolation'), { effectiveDirective: 'connect-src', blockedURI: String(url) }));
  assert.equal(await ask(null, null, violate), 'blockedByPolicy');
  assert.equal(await ask(null, null, () => violate('http://elsewhere/')), 'noServer');
});

test('never sends a token to an unknown server', async () => {
  const asked = [];
  await ask(null, null, (url) => asked.push(String(url)));
  assert.deepEqual(asked, ['https://there:1/v1/stream', 'https://there:1/v1/stream']);
  assert.equal(serverOf('ws://here:8080/v1/stream'), 'http://here:8080');
});

test('finds out whether the server requires a token', async () => {
  assert.equal(await wantsToken('ws://here/v1/stream', { fetch: async (url) => ({ status: String(url) === 'http://here/v1/rooms' ? 401 : 0 }) }), true);
  assert.equal(await wantsToken('ws://here/v1/stream', { fetch: async () => ({ status: 200 }) }), false, 'a proxy has shown one');
  assert.equal(await wantsToken('ws://here/v1/stream', { fetch: () => Promise.reject(new TypeError()) }), false);
});

test('takes the stream from the page’s attribute, then the page’s server, then the script’s', () => {
  const script = 'http://daemon:8080/talking-head.js';
  assert.equal(streamAddress('https://a/v1/stream', 'http://page/x', script), 'wss://a/v1/stream');
  assert.equal(streamAddress('../v1/stream', 'http://page/x/y', script), 'ws://page/v1/stream');
  assert.equal(streamAddress(null, 'https://page/x/', script), 'wss://page/v1/stream');
  assert.equal(streamAddress(null, 'file:///home/page.html', script), 'ws://daemon:8080/v1/stream');
  assert.equal(withEvents('ws://a/b?room=x'), 'ws://a/b?room=x&events=packed');
  assert.equal(withEvents('ws://a/b?events=text'), 'ws://a/b?events=text');
  assert.equal(withEvents('ws://a/b', 'la cucina'), 'ws://a/b?events=packed&key=la+cucina');
  assert.equal(withEvents('ws://a/b?room=x', 'y'), 'ws://a/b?room=x&events=packed');
  assert.throws(() => streamAddress('ws://:', 'http://page/', script));
});
