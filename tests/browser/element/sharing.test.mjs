// SPDX-License-Identifier: GPL-3.0-or-later
// Several faces on one page: shared data is fetched, decoded and stored once.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

let daemon, browser, pages, page;
const asked = [];
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  const face = (name) => `<talking-head style="inline-size:160px;block-size:200px" src="${daemon.url.replace('http', 'ws')}/v1/stream" model="${name}" quality="low" captions="off"></talking-head>`;
  pages = await servePages({ '/': `<!doctype html><link rel="icon" href="data:,"><script type="module" src="${daemon.url}/talking-head.js"></script>${face('mara')}${face('mara')}` });
  page = await browser.newPage({ viewport: { width: 700, height: 600 } });
  page.on('request', (request) => /\/v1\/models\/\w+\?/.test(request.url()) && asked.push(request.url().match(/models\/(\w+)/)[1]));
  await page.addInitScript(() => {
    window.decoded = 0;
    const decode = window.createImageBitmap;
    window.createImageBitmap = (...args) => (window.decoded++, decode(...args));
  });
  await page.goto(pages.url);
});
after(async () => {
  await browser?.close();
  await pages?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Waits until all faces are drawn. */
const drawn = (count) => page.waitForFunction((wanted) => {
  const all = [...document.querySelectorAll('talking-head')];
  return all.length === wanted && all.every((head) => head.debug?.().frames > 0);
}, count, { timeout: 180000 });

const add = (name) => page.evaluate((model) => {
  const other = document.querySelector('talking-head').cloneNode();
  other.setAttribute('model', model);
  document.body.append(other);
}, name);

/** Distinct textures of the heads, separately for premultiplied and plain alpha. */
async function pictures(...names) {
  const found = new Set();
  for (const name of names) {
    const { materials, textures } = await (await daemon.get(`/v1/models/${name}`)).json();
    const used = new Map();
    for (const { texture, alpha } of Object.values(materials)) if (texture && !used.has(texture)) used.set(texture, ['blend', 'cutout'].includes(alpha));
    for (const [texture, multiplied] of used) found.add(`${multiplied} ${textures[texture].data}`);
  }
  return found.size;
}

test('fetches a head that is used twice once, and decodes its pictures once', async () => {
  await drawn(2);
  assert.deepEqual(asked, ['mara']);
  assert.equal(await page.evaluate(() => window.decoded), await pictures('mara'));
});

test('a second head loads only what the first does not have', async () => {
  await add('bruno');
  await drawn(3);
  assert.deepEqual(asked, ['mara', 'bruno']);
  const [both, apart] = [await pictures('mara', 'bruno'), (await pictures('mara')) + (await pictures('bruno'))];
  assert.ok(both < apart, 'they have something in common');
  assert.equal(await page.evaluate(() => window.decoded), both);
});

test('does not fetch a head again that is already loaded', async () => {
  await add('mara');
  await drawn(4);
  assert.deepEqual(asked, ['mara', 'bruno']);
  assert.equal(await page.evaluate(() => window.decoded), await pictures('mara', 'bruno'));
});
