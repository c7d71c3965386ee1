// SPDX-License-Identifier: GPL-3.0-or-later
// A real Chromium on the demo page, and pictures of the face.
import fs from 'node:fs';
import path from 'node:path';
import { chromium } from 'playwright-core';
import { PNG } from 'pngjs';
import './built-heads.mjs';
import { artefacts } from './daemon.mjs';

const flags = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync'];
/** As Chromium is where there is no graphics processor: WebGL is drawn by SwiftShader, the page by the browser itself. */
const PLAIN = ['--disable-gpu'];
/** The page is drawn by SwiftShader, too, as by a graphics processor: one that shows no face takes more than without. */
const FORCED = ['--use-angle=swiftshader'];

/**
 * @param {{webgl?: boolean, forced?: boolean, idling?: boolean, whole?: boolean, flags?: string[]}} [options] webgl: false where nobody looks
 *   at the face, which takes most of the time; forced: see FORCED; idling: faces idle, which takes most of a processor: else pages are as for
 *   people who asked for less motion, unless newPage says otherwise; whole: the browser with its windows, which are drawn around each page
 *   though nobody sees them: else the same pages without any; flags: more of the browser's
 */
export async function launch({ webgl = true, forced = webgl, idling = false, whole = webgl, flags: more = [] } = {}) {
  const args = [...flags, ...(forced ? FORCED : PLAIN), ...more, ...(webgl ? [] : ['--disable-3d-apis'])];
  const browser = await chromium.launch({ executablePath: `/usr/bin/chromium${whole ? '' : '-headless-shell'}`, headless: true, args });
  if (!idling) {
    for (const opens of ['newPage', 'newContext']) {
      const open = browser[opens].bind(browser);
      browser[opens] = (options) => open({ reducedMotion: 'reduce', ...options });
    }
  }
  return browser;
}

/** The demo page in Italian, or as the options of newPage say, with the head loaded. Errors of the page fail the test that looks at page.problems. */
export async function openPage(browser, url, { quality = 'low', ...options } = {}) {
  const page = await browser.newPage({ viewport: { width: 1000, height: 800 }, locale: 'it-IT', ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.addInitScript((level) => {
    addEventListener('DOMContentLoaded', () => document.querySelector('talking-head').setAttribute('quality', level));
  }, quality);
  await page.goto(url);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 180000 });
  return page;
}

/** Keeps what the element says of itself, some fifty times a second, in window.log until window.logging is false. */
export const record = (page) => page.evaluate(() => {
  const element = document.querySelector('talking-head');
  window.log = [];
  window.logging = true;
  const timer = setInterval(() => {
    if (!window.logging) clearInterval(timer);
    const { audioTime, frameTime, frameAge, running, fapValues, underruns, state } = element.debug();
    window.log.push({ now: performance.now(), audioTime, frameTime, frameAge, running, fapValues, underruns, state });
  }, 20);
});

/** Poses the face (values by FAP number, or null for rest), waits until it is drawn, and keeps the picture. */
export async function picture(page, name, faps) {
  await page.evaluate(async (values) => {
    document.querySelector('talking-head').pose(values);
    for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame);
  }, faps);
  const png = await page.locator('talking-head canvas').screenshot();
  fs.mkdirSync(artefacts, { recursive: true });
  fs.writeFileSync(path.join(artefacts, `${name}.png`), png);
  return PNG.sync.read(png);
}

/**
 * How many pixels differ clearly between two pictures (in a box of the picture), and the box that holds them. The last row
 * is left out: half of it may be what lies below.
 */
export function difference(a, b, within = { left: 0, top: 0, right: a.width - 1, bottom: a.height - 2 }, threshold = 60) {
  const box = { left: a.width, top: a.height, right: 0, bottom: 0, count: 0 };
  for (let y = within.top; y <= within.bottom; y++)
    for (let x = within.left; x <= within.right; x++) {
      const i = 4 * (y * a.width + x);
      const d = Math.max(...[0, 1, 2].map((c) => Math.abs(a.data[i + c] - b.data[i + c])));
      if (d < threshold) continue;
      box.count++;
      box.left = Math.min(box.left, x);
      box.right = Math.max(box.right, x);
      box.top = Math.min(box.top, y);
      box.bottom = Math.max(box.bottom, y);
    }
  return box;
}
