// SPDX-License-Identifier: GPL-3.0-or-later
// Shoulders in a real browser: they rise and fall with the breath, and stay where motion is not wanted; the body reaches the lower border.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';
import { fiveLines, servePages } from '../../lib/page-server.mjs';

const SECONDS = 7; // more than a breath
let daemon, browser, pages;
before(async () => {
  pages = await servePages({});
  daemon = await Daemon.start(['--origin', pages.url]);
  pages.files['/'] = fiveLines(daemon.url);
  browser = await launch({ idling: true });
});
after(async () => {
  await browser?.close();
  await pages?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a bust on a white page. */
async function openBust(options) {
  const page = await browser.newPage({ viewport: { width: 700, height: 700 }, ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.goto(pages.url);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().frames, null, { timeout: 180000 });
  await page.evaluate(async () => {
    const face = document.querySelector('talking-head');
    Object.assign(document.body.style, { margin: 0, background: '#fff' });
    Object.assign(face.style, { display: 'block', inlineSize: '600px', blockSize: '600px' });
    face.setAttribute('captions', 'off');
    face.setAttribute('view', 'bust');
    for (let i = 0; i < 4; i++) await new Promise(requestAnimationFrame);
  });
  return page;
}

/** Pictures of some seconds, at least of that many. */
async function watch(page, seconds, least = 1) {
  const list = [];
  for (const end = Date.now() + 1000 * seconds; Date.now() < end || list.length < least;)
    list.push(PNG.sync.read(await page.locator('talking-head').screenshot()));
  return list;
}

const light = ({ data, width }, x, y) => (data[4 * (y * width + x)] + data[4 * (y * width + x) + 1] + data[4 * (y * width + x) + 2]) / 765;

/** How much of a column that the shoulder's outline crosses is white, in rows. */
function above(png) {
  const x = Math.round(0.24 * png.width);
  let sum = 0;
  for (let y = Math.round(0.4 * png.height); y < 0.85 * png.height; y++) sum += Math.min(1, Math.max(0, light(png, x, y) * 2 - 1)); // cloth is darker than half
  return sum;
}

/** The share of the lower border that the body covers between the shoulders; a button may be white. */
function covered(png) {
  let count = 0;
  const [from, to] = [Math.round(0.35 * png.width), Math.round(0.65 * png.width)];
  for (let x = from; x < to; x++) count += Number(light(png, x, png.height - 3) < 0.9);
  return count / (to - from);
}

const span = (list) => Math.max(...list) - Math.min(...list);

test('shoulders rise with a breath while she idles, and the body goes out of the picture', async (t) => {
  const page = await openBust({ reducedMotion: 'no-preference' });
  const seen = await watch(page, SECONDS, 12);
  const rows = seen.map(above);
  t.diagnostic(`${seen.length} pictures, shoulders over ${span(rows).toFixed(2)} of ${seen[0].height} rows`);
  assert.ok(Math.min(...rows) > 10, 'the column crosses the outline');
  assert.ok(span(rows) > 1.5 && span(rows) < 10, `${span(rows)} rows`);
  for (const png of seen) assert.ok(covered(png) > 0.9, `${covered(png)} of the lower border`);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('shoulders stay with prefers-reduced-motion', async () => {
  const page = await openBust({ reducedMotion: 'reduce' });
  const rows = (await watch(page, SECONDS, 6)).map(above);
  assert.ok(rows[0] > 10 && span(rows) < 0.05, `${span(rows)} rows`);
  await page.close();
});
