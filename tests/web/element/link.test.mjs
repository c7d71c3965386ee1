// SPDX-License-Identifier: MIT
// Messages of the element when the server is unreachable, and when they appear.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Link } from '../../../web/element/stream/link.mjs';

/** A link in a page, with a browser played by the test. */
function rig(t, { src = 'ws://there/v1/stream', token = null, refuses = null, fetches = () => Promise.reject(new TypeError()), https = false } = {}) {
  let link = null;
  t.after(() => link.close()); // while there is still a page
  const sockets = [];
  const said = [];
  class Socket {
    constructor() {
      if (refuses) throw new DOMException('refused', refuses);
      sockets.push(this);
    }
    send() {}
    close() {}
  }
  const page = Object.assign(new EventTarget(), { baseURI: `http${https ? 's' : ''}://page/` });
  const world = { document: page, location: { protocol: https ? 'https:' : 'http:' }, origin: 'http://page', WebSocket: Socket, fetch: fetches };
  for (const [name, value] of Object.entries(world)) {
    const before = Object.getOwnPropertyDescriptor(globalThis, name);
    Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
    t.after(() => (before ? Object.defineProperty(globalThis, name, before) : delete globalThis[name]));
  }
  link = new Link({
    source: () => ({ src, token }), onstate() {}, onmessage() {}, onmedia() {},
    ontrouble: (name, values, told) => said.push(name === null ? null : { name, ...values, ...(told ? { told } : {}) }),
  });
  link.open();
  // Starts one timer after the other: on a busy machine a single one may fire before those set after it.
  const settle = async () => {
    for (let i = 0; i < 4; i++) await new Promise((resolve) => setTimeout(resolve, 5));
  };
  const hear = (message) => sockets.at(-1).onmessage({ data: JSON.stringify(message) });
  return { link, page, said, sockets, settle, hear };
}
const there = { src: 'ws://there/v1/stream', server: 'http://there', origin: 'http://page' };

test('explains the first failing attempt, and later ones only for a new reason', async (t) => {
  const { said, sockets, settle, link, hear } = rig(t);
  sockets[0].onclose();
  await settle();
  assert.deepEqual(said, [{ name: 'noServer', ...there }]);
  link.hurry();
  sockets[1].onclose();
  await settle();
  assert.equal(said.length, 1);
  globalThis.fetch = async (_, { mode }) => (mode === 'cors' ? Promise.reject(new TypeError()) : {});
  link.hurry();
  sockets[2].onclose();
  await settle();
  assert.deepEqual(said.slice(1), [{ name: 'forbiddenOrigin', ...there }]);
  link.hurry();
  hear({ type: 'hello' });
  assert.equal(said.at(-1), null);
  sockets[3].onclose();
  await settle();
  assert.equal(said.at(-1), null, 'a link that is lost is tried again before anything is said');
});

test('refused by the browser at once', async (t) => {
  await t.test('no address', (t1) => assert.equal(rig(t1, { src: 'ws://:' }).said[0].name, 'badAddress'));
  await t.test('insecure address on an https: page', (t1) => assert.equal(rig(t1, { refuses: 'SecurityError', https: true }).said[0].name, 'mixedContent'));
  await t.test('blocked by policy', (t1) => assert.equal(rig(t1, { refuses: 'SecurityError' }).said[0].name, 'blockedByPolicy'));
});

test('names the violated policy of the page', async (t) => {
  const { page, said, sockets, settle } = rig(t);
  page.dispatchEvent(Object.assign(new Event('securitypolicyviolation'), { effectiveDirective: 'connect-src', blockedURI: 'ws://there/v1/stream' }));
  sockets[0].onerror();
  await settle();
  assert.deepEqual(said.map(({ name }) => name), ['blockedByPolicy']);
});

test('reports a missing token at once, and an invalid one when the server does', async (t) => {
  const fetches = async () => ({ status: 401 });
  await t.test('missing', async (t1) => {
    const { hear, settle, said } = rig(t1, { fetches });
    hear({ type: 'hello', tokens: true });
    await settle();
    assert.deepEqual(said, [{ name: 'tokenNeeded', ...there }]);
    hear({ type: 'authorized' });
    assert.equal(said.at(-1), null);
  });
  for (const [name, given] of Object.entries({ 'in the address': { src: 'ws://there/v1/stream?token=x' }, given: { token: 'x' } }))
    await t.test(name, async (t1) => {
      const { hear, settle, said } = rig(t1, { fetches, ...given });
      hear({ type: 'hello', tokens: true });
      await settle();
      assert.deepEqual(said, []);
      hear({ type: 'error', code: 'expired-token' });
      assert.deepEqual(said.map(({ name: what, told }) => [what, told]), [['badToken', true]]);
    });
});
