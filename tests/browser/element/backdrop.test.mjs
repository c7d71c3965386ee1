// SPDX-License-Identifier: GPL-3.0-or-later
// What the element shows behind the face: nothing unless a page asks, a room without loading anything, or a picture.
import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

const WAIT = { timeout: 180000 };
let daemon, browser, pages;

/** A page whose policy allows no pictures. */
const page = (daemonUrl, attributes) => ({
  body: `<!doctype html><style>body { margin: 0; background: #ff00ff }</style><script type="module" src="${daemonUrl}/talking-head.js"></script>
    <talking-head style="display: block; inline-size: 400px; block-size: 500px" src="${daemonUrl.replace('http', 'ws')}/v1/stream"
      quality="low" captions="off" poster="off" still ${attributes}></talking-head>`,
  headers: { 'content-security-policy': `default-src 'none'; script-src ${daemonUrl}; style-src 'unsafe-inline'; connect-src ${daemonUrl} ${daemonUrl.replace('http', 'ws')}` },
});

before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  pages = await servePages({
    '/none': page(daemon.url, ''), '/room': page(daemon.url, 'backdrop="room"'), '/broken': page(daemon.url, 'backdrop="nothing.png"'),
  });
});
after(async () => {
  await browser?.close();
  await pages?.close();
  await daemon?.stop();
});

/**
 * Opens a page with a face; returns its picture, and what tells about the backdrop.
 * @param {boolean} [ends] whether the face is one that ends at its shoulders, as imported ones do
 */
async function shown(name, ends = false) {
  const tab = await browser.newPage({ viewport: { width: 400, height: 500 } });
  if (ends)
    await tab.route(/\/v1\/models\/mara(\?.*)?$/, async (route) => {
      const response = await route.fetch();
      const json = await response.json();
      delete json.view.bottom;
      await route.fulfill({ response, json });
    });
  const refused = [];
  tab.on('console', (message) => /Content.Security.Policy/i.test(message.text()) && refused.push(message.text()));
  await tab.goto(`${pages.url}/${name}`);
  await tab.waitForFunction(() => document.querySelector('talking-head').debug?.().frames, null, WAIT);
  const look = () => tab.evaluate(() => {
    const found = document.querySelector('talking-head').shadowRoot.querySelector('.backdrop');
    return found && { name: found.localName, part: found.part.value, hidden: found.ariaHidden, image: getComputedStyle(found).backgroundImage };
  });
  const picture = async () => {
    await tab.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    return PNG.sync.read(await tab.screenshot({ path: path.join(artefacts, `backdrop-${name}.png`) }));
  };
  return { tab, look, picture, refused };
}

const at = ({ data, width }, x, y) => [...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)];
const PAGE = [255, 0, 255];
const CORNERS = [[5, 5], [394, 5]];
const BREAST = [200, 497]; // where the shoulders have faded out

const isPage = ([red, green, blue]) => red > 200 && green < 60 && blue > 200;

test('without the attribute the page shows through; a body goes out of the picture, and shoulders that end fade out', async () => {
  for (const ends of [false, true]) {
    const { tab, look, picture } = await shown('none', ends);
    assert.equal(await look(), null);
    const png = await picture();
    for (const place of CORNERS) assert.deepEqual(at(png, ...place), PAGE);
    assert.equal(isPage(at(png, ...BREAST)), ends, `${at(png, ...BREAST)}`);
    await tab.close();
  }
});

test('a room is warm, lighter on the side of its window\'s light, cuts the shoulders, and loads nothing', async () => {
  const { tab, look, picture, refused } = await shown('room', true);
  const { image, ...found } = await look();
  assert.deepEqual(found, { name: 'div', part: 'backdrop', hidden: 'true' });
  assert.match(image, /radial-gradient/);
  const png = await picture();
  const [[r1, g1, b1], [r2, g2, b2]] = CORNERS.map((place) => at(png, ...place));
  assert.ok(r1 > b1 && r2 > b2 && r1 < 240 && r2 < 240, `${r1} ${g1} ${b1}, ${r2} ${g2} ${b2}`);
  const [dark, bright] = [[20, 120], [380, 120]].map((place) => at(png, ...place)[1]);
  assert.ok(bright > dark + 15, `${dark} on the left, ${bright} on the right`);
  assert.ok(!isPage(at(png, ...BREAST)), 'the page shows through the breast');
  await tab.evaluate(() => document.querySelector('talking-head').removeAttribute('backdrop'));
  assert.equal(await look(), null);
  const without = await picture();
  assert.deepEqual(at(without, 5, 5), PAGE);
  assert.ok(isPage(at(without, ...BREAST)), 'the shoulders fade out again');
  assert.deepEqual(refused, []);
  await tab.close();
});

test('a picture that cannot be shown leaves the page as it was', async () => {
  const { tab, look, picture } = await shown('broken', true);
  await tab.waitForFunction(() => !document.querySelector('talking-head').shadowRoot.querySelector('.backdrop'), null, WAIT);
  assert.equal(await look(), null);
  const png = await picture();
  assert.deepEqual(at(png, 5, 5), PAGE);
  assert.ok(isPage(at(png, ...BREAST)), 'the shoulders fade out');
  await tab.close();
});
