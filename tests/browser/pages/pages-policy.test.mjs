// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon's pages under their content security policy, and in frames of other sites.
import assert from 'node:assert/strict';
import http from 'node:http';
import { once } from 'node:events';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a page and records violations and errors. */
async function open(url) {
  const page = await browser.newPage({ viewport: { width: 1000, height: 800 } });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.addInitScript(() => {
    addEventListener('DOMContentLoaded', () => document.querySelector('talking-head')?.setAttribute('quality', 'low'));
  });
  await page.goto(url);
  return page;
}

for (const name of ['', 'voices.html', 'emotion.html'])
  test(`/${name} draws, speaks and plays sound without a violation`, async () => {
    const page = await open(`${daemon.url}/${name}`);
    await page.waitForFunction(() => document.querySelector('talking-head')?.debug?.().state === 'idle', null, { timeout: 60000 });
    await page.mouse.click(500, 5); // browsers allow sound only after a user gesture
    const end = await page.evaluate(() => document.querySelector('talking-head').speak('La mamma parla.', { lang: 'it' }));
    assert.equal(end.reason, 'done');
    assert.deepEqual(page.problems, []);
    await page.close();
  });

test('a page of another origin may frame ours only when --embed names it', async () => {
  const server = http.createServer((request, response) => {
    response.setHeader('content-type', 'text/html');
    response.end(`<!doctype html><title>portal</title><iframe src="${request.url.slice(1)}"></iframe>`);
  }).listen(0, '127.0.0.1');
  await once(server, 'listening');
  const portal = `http://localhost:${server.address().port}`;
  const own = await Daemon.start(['--embed', portal]);
  const framed = async (url) => {
    const page = await open(`${portal}/${url}/`);
    await page.waitForLoadState();
    const [frame] = page.mainFrame().childFrames();
    const title = await frame.title().catch(() => '');
    const refused = page.problems.some((text) => /frame-ancestors|X-Frame-Options/.test(text));
    await page.close();
    return { title, refused };
  };
  const { title, refused } = await framed(own.url);
  assert.match(title, /faccia/);
  assert.equal(refused, false);
  assert.equal((await framed(daemon.url)).refused, true);
  server.close();
  assert.equal((await own.stop()).code, 0);
});
