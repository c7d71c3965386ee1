// SPDX-License-Identifier: GPL-3.0-or-later
// The documentation served by the daemon under its policy: pages render, search and links work, and a face in them speaks.
import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../lib/browser.mjs';
import { artefacts, Daemon } from '../lib/daemon.mjs';

let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a page and records policy violations and errors. */
async function open(address, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  page.on('response', (response) => response.status() >= 400 && page.problems.push(`${response.status()} ${response.url()}`));
  await page.goto(`${daemon.url}${address}`);
  await page.waitForFunction(() => document.querySelector('#app')?.__vue_app__);
  return page;
}

test('redirects /docs to /docs/ and serves it with the policy of pages', async () => {
  const moved = await fetch(`${daemon.url}/docs`, { redirect: 'manual' });
  assert.equal(moved.status, 308);
  assert.equal(moved.headers.get('location'), 'docs/');
  const home = await fetch(`${daemon.url}/docs`);
  assert.equal(home.url, `${daemon.url}/docs/`);
  assert.match(home.headers.get('content-security-policy'), /script-src 'self'/);
  assert.match(await home.text(), /A face that speaks/);
  assert.equal((await fetch(`${daemon.url}/docs/nowhere.html`)).status, 404);
  assert.equal((await fetch(`${daemon.url}/docs/assets`)).status, 404);
});

for (const address of ['/docs/', '/docs/start/page.html', '/docs/protocol/websocket.html', '/docs/protocol/openapi.html', '/docs/research/'])
  test(`draws ${address} without violating the content security policy`, async () => {
    const page = await open(address);
    await page.screenshot({ path: path.join(artefacts, `docs${address.replace(/\W+/g, '-')}.png`) });
    assert.ok((await page.locator('#VPContent').innerText()).length > 200);
    assert.deepEqual(page.problems, []);
    await page.close();
  });

test('colours code through classes', async () => {
  const page = await open('/docs/start/page.html');
  const colours = await page.locator('.language-html span[class^=c]').evaluateAll((spans) => new Set(spans.map((span) => getComputedStyle(span).color)).size);
  assert.ok(colours >= 3, `${colours} colours`);
  await page.close();
});

test('lets a reader move from page to page and to the face', async () => {
  const page = await open('/docs/start/');
  await page.locator('main').getByRole('link', { name: 'On a page' }).first().click();
  await page.waitForURL(/\/docs\/start\/page\.html$/);
  await page.waitForFunction(() => document.querySelector('h1')?.textContent.includes('On a page'));
  await page.locator('main').getByRole('link', { name: 'examples' }).first().click();
  await page.waitForURL(/\/examples\.html$/);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('finds the words of a page by search', async () => {
  const page = await open('/docs/');
  await page.keyboard.press('Control+k');
  await page.locator('.VPLocalSearchBox input').fill('lookahead');
  await page.locator('.VPLocalSearchBox a.result').first().waitFor();
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('lets a face in the documentation speak', async () => {
  const page = await open('/docs/start/page.html');
  await page.evaluate(() => {
    window.ended = new Promise((resolve) => document.addEventListener('end', ({ detail }) => resolve(detail.reason), { capture: true, once: true }));
  });
  await page.locator('.live-face button').click();
  assert.equal(await page.evaluate(() => window.ended), 'done');
  assert.equal(await page.locator('.live-face talking-head').count(), 1);
  assert.deepEqual(page.problems, []);
  await page.close();
});
