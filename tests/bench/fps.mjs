// SPDX-License-Identifier: GPL-3.0-or-later
// Frames per second of the page in headless Chromium with software rendering, while she speaks, at low and at full quality, next
// to an empty page that only counts its frames, in one run. Usage: node tests/bench/fps.mjs
import { Daemon } from '../lib/daemon.mjs';
import { launch, openPage } from '../lib/browser.mjs';
import { prose } from './text.mjs';

const SECONDS = 8;
const daemon = await Daemon.start();
const browser = await launch();

/** Frames that a page draws in a while, by a counter that it keeps. */
async function rate(page, counter) {
  await new Promise((resolve) => setTimeout(resolve, 2000));
  const before = await page.evaluate(counter);
  const started = performance.now();
  await new Promise((resolve) => setTimeout(resolve, SECONDS * 1000));
  return ((await page.evaluate(counter)) - before) / ((performance.now() - started) / 1000);
}

const empty = await browser.newPage();
await empty.evaluate(() => {
  window.frames_ = 0;
  const tick = () => (window.frames_++, requestAnimationFrame(tick));
  tick();
});
const display = await rate(empty, () => window.frames_);
await empty.close();

for (const quality of ['low', 'high']) {
  const page = await openPage(browser, daemon.url, { quality });
  await page.evaluate(() => Object.assign(document.querySelector('talking-head').style, { width: '640px', height: '480px', position: 'fixed', inset: 0, maxWidth: 'none' }));
  await page.evaluate((text) => void document.querySelector('talking-head').speak(text, { lang: 'it' }), prose(SECONDS + 6));
  const fps = await rate(page, () => document.querySelector('talking-head').debug().frames);
  const { triangles } = await page.evaluate(() => document.querySelector('talking-head').debug());
  console.log(`${quality}: ${fps.toFixed(1)} frames a second, ${triangles} triangles, 640 x 480; an empty page: ${display.toFixed(1)} (ratio ${(fps / display).toFixed(2)})`);
  await page.close();
}
await browser.close();
await daemon.stop();
