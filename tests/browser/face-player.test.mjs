// SPDX-License-Identifier: GPL-3.0-or-later
// The Face Player in a browser: what was just spoken is seen, played, scrubbed, edited, taken back, saved.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { after, before, test } from 'node:test';
import { violations } from '../lib/axe.mjs';
import { launch } from '../lib/browser.mjs';
import { Daemon } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';

let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('what was spoken: plots, frames beside the head, a key dragged, undone, saved, opened again', async () => {
  const page = await browser.newPage({ viewport: { width: 1300, height: 950 }, locale: 'it-IT', acceptDownloads: true });
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
  await page.goto(`${daemon.url}/player.html`);
  await page.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open');
  await page.click('#open button');
  await page.waitForSelector('[data-plot="curves"]');
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('[data-plot]')].map((plot) => plot.dataset.plot)), ['wave', 'spectrum', 'phones', 'curves']);
  assert.deepEqual(await violations(page), []);
  const last = await page.evaluate(() => Number(document.querySelector('#scrub').max));
  assert.ok(last > 20, `${last}`);
  const jaw = () => page.evaluate(() => document.querySelector('#head').faps[3] ?? 0);
  const at = async (frame) => {
    await page.evaluate((k) => ((document.querySelector('#scrub').value = k), document.querySelector('#scrub').dispatchEvent(new Event('input'))), frame);
    await page.evaluate(async () => {
      for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame);
    });
    return jaw();
  };
  const values = [];
  for (const frame of [0, 8, 12]) values.push(await at(frame));
  assert.ok(new Set(values).size > 1, `${values}`);
  await page.fill('#value', '900');
  await page.click('#set');
  assert.equal(await at(12), 900);
  await page.click('#undo');
  assert.equal(await at(12), values[2]);
  await page.click('#redo');
  assert.equal(await at(12), 900);
  const over = await page.locator('[data-plot="curves"] .u-over').boundingBox();
  const place = { x: over.x + (over.width * 12) / 25 / (await page.evaluate(() => document.querySelector('#scrub').max / 25)), y: over.y + 20 };
  await page.mouse.dblclick(place.x, place.y + over.height / 2); // another key, by mouse
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
  const file = await download.path();
  const saved = parseFap(fs.readFileSync(file, 'utf8'));
  assert.equal(saved.frames.length, last + 1);
  assert.ok(saved.frames.some((frame) => frame[3] === 900) || (await jaw()) !== 900);
  await page.click('#play');
  await page.waitForFunction(() => Number(document.querySelector('#scrub').value) > 15 || document.querySelector('#play').textContent === 'Avvia');
  await page.waitForFunction(() => document.querySelector('#play').textContent === 'Avvia', null, { timeout: 60000 });
  await page.setInputFiles('#files', { name: 'mio.fap', mimeType: 'text/plain', buffer: fs.readFileSync(file) });
  await page.waitForFunction(() => document.querySelector('#news').textContent.startsWith('mio'));
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('[data-plot]')].map((plot) => plot.dataset.plot)), ['curves']);
  await page.setInputFiles('#files', { name: 'rotto.fap', mimeType: 'text/plain', buffer: Buffer.from('2.1 x 25 1\n1 2 3\n') });
  await page.waitForSelector('#problem .place');
  assert.match(await page.textContent('#problem'), /2/);
  assert.deepEqual(problems, []);
  await page.close();
});
