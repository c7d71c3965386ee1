// SPDX-License-Identifier: GPL-3.0-or-later
// Runs Chromium on the demo page, and takes pictures of the face.
import fs from 'node:fs';
import path from 'node:path';
import { chromium } from 'playwright-core';
import { PNG } from 'pngjs';
import './built-heads.mjs';
import { artefacts } from './daemon.mjs';

const flags = ['--no-sandbox', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync'];
/** Flags for no GPU: SwiftShader draws WebGL, the browser's software renderer draws the page. */
const PLAIN = ['--disable-gpu'];
/** Flags that let SwiftShader draw the page, too, as a GPU would; slower for pages without a face. */
const FORCED = ['--use-angle=swiftshader'];
/** Flags for a graphics card, also one without a display. FACCIA_GPU_FLAGS: others for the machine at hand, separated by spaces. */
const CARD = process.env.FACCIA_GPU_FLAGS?.split(' ') ?? ['--ignore-gpu-blocklist', '--enable-gpu', '--use-angle=vulkan', '--enable-features=Vulkan', '--disable-vulkan-surface'];

/**
 * @param {{webgl?: boolean, forced?: boolean, card?: boolean, idling?: boolean, whole?: boolean, flags?: string[]}} [options] webgl: false for tests that need
 *   no face, because drawing it takes most of the time; forced: see FORCED; card: see CARD; idling: let faces idle, which uses most of a processor; else pages
 *   get prefers-reduced-motion unless newPage overrides it; whole: the full browser with windows, else the headless shell; flags: further flags
 *   of the browser
 */
export async function launch({ webgl = true, forced = webgl, card = false, idling = false, whole = webgl, flags: more = [] } = {}) {
  const args = [...flags, ...(card ? CARD : forced ? FORCED : PLAIN), ...more, ...(webgl ? [] : ['--disable-3d-apis'])];
  const browser = await chromium.launch({ executablePath: `/usr/bin/chromium${whole ? '' : '-headless-shell'}`, headless: true, args });
  if (!idling) {
    for (const opens of ['newPage', 'newContext']) {
      const open = browser[opens].bind(browser);
      browser[opens] = (options) => open({ reducedMotion: 'reduce', ...options });
    }
  }
  return browser;
}

/** Opens the demo page, in Italian unless the options of newPage differ, and waits for the head. Collects errors of the page in page.problems. */
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

/** Records the element's state about fifty times a second in window.log, until window.logging is false. */
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

/** Poses the face (values by FAP number; null: at rest), waits until it is drawn, and saves the picture. */
export async function picture(page, name, faps) {
  await page.evaluate(async (values) => {
    const head = document.querySelector('talking-head');
    head.pose(values);
    head.shadowRoot.querySelector('.captions').style.visibility = 'hidden'; // they may linger over the picture
    // until hair has come to rest, too
    for (let i = 0, same = 0, before = -1; i < 200 && same < 3; i++) {
      await new Promise(requestAnimationFrame);
      const { frames } = head.debug();
      same = frames === before ? same + 1 : 0;
      before = frames;
    }
  }, faps);
  const png = await page.locator('talking-head canvas').screenshot();
  await page.evaluate(() => (document.querySelector('talking-head').shadowRoot.querySelector('.captions').style.visibility = ''));
  fs.mkdirSync(artefacts, { recursive: true });
  fs.writeFileSync(path.join(artefacts, `${name}.png`), png);
  return PNG.sync.read(png);
}

/**
 * Counts pixels that differ clearly between two pictures (within a box), and returns the box that contains them. Ignores the
 * last row, which may be partly covered.
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
