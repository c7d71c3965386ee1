// SPDX-License-Identifier: GPL-3.0-or-later
// Adaptive quality without a GPU: fewer triangles, and no visible step when it changes.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ idling: true });
  page = await openPage(browser, daemon.url);
});
after(async () => {
  await browser?.close();
  await daemon?.stop();
});

const PATIENCE = { timeout: 180000 };
const debug = () => page.evaluate(() => document.querySelector('talking-head').debug());
const canvases = (count) => page.waitForFunction((n) => document.querySelector('talking-head').shadowRoot.querySelectorAll('canvas').length === n, count, PATIENCE);

test('low quality draws only as many triangles as the picture can show', async () => {
  const model = await page.evaluate(async () => {
    const { parts } = await (await fetch('/v1/models/mara')).json();
    return parts.reduce((sum, { index }) => sum + atob(index.data).length / 6, 0);
  });
  await page.waitForFunction((all) => document.querySelector('talking-head').debug().triangles < 0.6 * all, model, PATIENCE);
  assert.ok((await debug()).triangles > 0.2 * model);
});

test('a change of quality cross-fades the pictures', async () => {
  await page.evaluate(() => {
    const element = document.querySelector('talking-head');
    window.veils = [];
    new MutationObserver((changes) => changes.forEach(({ addedNodes }) => addedNodes.forEach((node) => {
      if (node.nodeName !== 'CANVAS') return;
      const { width, height } = node;
      const { data } = node.getContext('2d').getImageData(0, 0, width, height);
      window.veils.push({ width, height, drawn: data.some((value) => value), hidden: node.getAttribute('aria-hidden') });
    }))).observe(element.shadowRoot.querySelector('.stage'), { childList: true });
    element.setAttribute('quality', 'high');
  });
  await page.waitForFunction(() => window.veils.length === 1, null, PATIENCE);
  await canvases(1);
  const [veil] = await page.evaluate(() => window.veils);
  assert.ok(veil.drawn, 'it shows the face');
  assert.equal(veil.hidden, 'true');
  assert.equal((await debug()).level, 'high');
  assert.deepEqual(page.problems, []);
});
