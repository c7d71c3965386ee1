// SPDX-License-Identifier: GPL-3.0-or-later
// Turns a head in front of the camera (a film of Bruno): the page chooses three pictures, and none leaves it.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { unpack } from '../../../models/tools/lib/deform.mjs';
import { drawHead } from '../../../models/tools/lib/portrait.mjs';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { models } from '../../lib/built-heads.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { checkStayed, watchPage } from '../../lib/page-private.mjs';

const sharp = createRequire(new URL('../../../models/package.json', import.meta.url))('sharp');
const TURNS = [0, 20, 42, 0, -20, -42]; // degrees, one after the other, again and again
const HELD = 24; // frames
let daemon, browser, folder;

/** Writes concatenated JPEG frames, the MJPEG file that Chromium's fake camera plays. */
async function film(file) {
  const bruno = unpack(JSON.parse(fs.readFileSync(path.join(models, 'heads/bruno.json'), 'utf8')));
  const seen = new Map();
  for (const yaw of new Set(TURNS)) {
    const { data, width, height } = await drawHead(bruno, { width: 400, height: 480, yaw, shadows: false });
    seen.set(yaw, await sharp(Buffer.from(data.buffer), { raw: { width, height, channels: 4 } }).flatten({ background: '#b8c0c4' }).jpeg({ quality: 92 }).toBuffer());
  }
  fs.writeFileSync(file, Buffer.concat(TURNS.flatMap((yaw) => Array(HELD).fill(seen.get(yaw)))));
}

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-turn-'));
  const file = path.join(folder, 'bruno.mjpeg');
  await film(file);
  daemon = await Daemon.start();
  browser = await launch({ webgl: false, flags: ['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${file}`] });
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
  assert.equal((await daemon.stop()).code, 0);
});

test('takes the front and both sides from a turn of the head, and makes a head of them', async () => {
  const page = await browser.newPage({ locale: 'en-GB', viewport: { width: 1100, height: 900 } });
  const watched = watchPage(page);
  await page.addInitScript(() => {
    window.told = [];
    addEventListener('DOMContentLoaded', () => new MutationObserver(() => window.told.push(document.querySelector('#state').textContent)).observe(document.querySelector('#state'), { childList: true }));
  });
  await page.goto(`${daemon.url}/avatar.html`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  assert.equal(await page.evaluate(() => document.querySelector('#video').srcObject), null, 'no camera before it is asked for');
  await page.click('#camera');
  await page.click('#turn');
  await page.waitForFunction(() => document.querySelector('#turn').ariaPressed === 'true');
  assert.deepEqual(await violations(page), []);
  await page.waitForFunction(() => document.querySelectorAll('#pictures li').length === 3, null, { timeout: 240000 });
  await page.waitForFunction(() => document.querySelector('#state').textContent.includes('Found.'));
  assert.equal(await page.getAttribute('#turn', 'aria-pressed'), 'false');
  fs.mkdirSync(artefacts, { recursive: true });
  await page.screenshot({ path: path.join(artefacts, 'portrait-turn.png'), fullPage: true });
  assert.ok((await page.evaluate(() => window.told)).some((text) => text.includes('turn your head') || text.includes('Look straight')), 'it says where to turn');

  const yaws = await page.evaluate(() => [...document.querySelectorAll('#pictures li')].map((item) => {
    const left = (name) => parseFloat(item.querySelector(`[data-point="${name}"]`).style.left);
    return (left('noseTip') - (left('cheekLeft') + left('cheekRight')) / 2) / (left('cheekLeft') - left('cheekRight'));
  }));
  assert.ok(Math.abs(yaws[0]) < 0.15, `the front: ${yaws}`);
  assert.ok(yaws[1] * yaws[2] < 0 && Math.min(Math.abs(yaws[1]), Math.abs(yaws[2])) > 0.15, `the sides: ${yaws}`);

  await page.click('#camera-off');
  assert.equal(await page.evaluate(() => document.querySelector('#video').srcObject), null);
  await page.selectOption('#like', 'mara');
  await page.check('#style input[value="mara"]', { force: true });
  await page.click('#make');
  await page.waitForFunction(() => document.querySelector('#state').textContent.includes('Made'), null, { timeout: 120000 });
  checkStayed(watched, daemon.url);
  await page.close();
});
