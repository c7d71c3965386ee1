// SPDX-License-Identifier: GPL-3.0-or-later
// A face before the camera (a film of Luca) moves the face of the page, and of a room; its movements are recorded. No picture leaves the page.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon, eventually } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { film, headOf } from '../../lib/film.mjs';
import { checkStayed, watchPage } from '../../lib/page-private.mjs';

const sharp = createRequire(new URL('../../../models/package.json', import.meta.url))('sharp');
const [JAW, LIP, YAW] = [3, 5, 49];
const HELD = 90; // frames of the film: on a busy machine a look takes a second
let daemon, browser, folder;

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-mirror-page-'));
  const poses = [{}, { 3: 900, 5: -800, 10: -700, 11: -700, 52: -800 }, { 49: 25000 }];
  await film(headOf('luca'), poses, folder, { height: 480 });
  const shots = await Promise.all(poses.map((_, k) => sharp(path.join(folder, `000${k + 1}.png`)).resize(480, 540).jpeg({ quality: 92 }).toBuffer()));
  const file = path.join(folder, 'luca.mjpeg');
  fs.writeFileSync(file, Buffer.concat([0, 0, 1, 2].flatMap((k) => Array(HELD).fill(shots[k]))));
  daemon = await Daemon.start([], {}, { voices: false });
  browser = await launch({ webgl: false, flags: ['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${file}`] });
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
  assert.equal((await daemon.stop()).code, 0);
});

async function open(address) {
  const page = await browser.newPage({ locale: 'en-GB', viewport: { width: 1100, height: 900 } });
  const watched = watchPage(page);
  await page.addInitScript(() => {
    window.asked = 0;
    const ask = navigator.mediaDevices.getUserMedia.bind(navigator.mediaDevices);
    navigator.mediaDevices.getUserMedia = (wish) => {
      window.asked++;
      return ask(wish);
    };
    addEventListener('DOMContentLoaded', () => {
      window.told = [];
      new MutationObserver(() => window.told.push(document.querySelector('#state').textContent)).observe(document.querySelector('#state'), { childList: true });
    });
  });
  await page.goto(`${daemon.url}/${address}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  return { page, watched };
}

test('drives a room with the face before the camera, and records it', async () => {
  const screen = await daemon.stream('?room=studio');
  await screen.wait({ type: 'joined' });
  screen.send({ type: 'idle', life: 0 });
  const { page, watched } = await open('mirror.html?room=studio');
  assert.match(await page.textContent('#consent'), /neither sent nor kept.*everyone in the room studio/);
  assert.equal(await page.evaluate(() => window.asked), 0, 'no camera before it is asked for');
  assert.equal(await page.isVisible('#off'), false);
  assert.deepEqual(await violations(page), []);
  await page.click('#on');
  await screen.wait({ type: 'driven', on: true }, { timeout: 240000 });
  assert.equal(await page.evaluate(() => window.asked), 1);
  await page.click('#record');
  assert.equal(await page.getAttribute('#record', 'aria-pressed'), 'true');
  const last = (fap) => screen.chunks.at(-1)?.frames.at(-1)?.[fap] ?? 0;
  await screen.until(() => last(LIP) < -200 && last(JAW) > 200, 240000);
  await screen.until(() => last(YAW) > 9000, 240000); // others see the user as they would face to face
  assert.deepEqual(await violations(page), []);
  fs.mkdirSync(artefacts, { recursive: true });
  await page.screenshot({ path: path.join(artefacts, 'mirror.png'), fullPage: true });
  await page.click('#record');
  const download = page.waitForEvent('download');
  await page.click('#save');
  const { fps, frames } = parseFap(fs.readFileSync(await (await download).path(), 'utf8'));
  assert.equal(fps, 25);
  assert.ok(frames.some((frame) => frame[LIP] < -200) && frames.some((frame) => frame[YAW] > 9000), `${frames.length} frames`);
  await page.click('#off');
  await screen.wait({ type: 'driven', on: false });
  assert.equal(await page.evaluate(() => document.querySelector('#video').srcObject), null);
  checkStayed(watched, daemon.url);
  await page.close();
  await screen.close();
});

test('moves the page’s own face as a mirror does, and says what is wrong', async () => {
  const { page, watched } = await open('mirror.html');
  assert.doesNotMatch(await page.textContent('#consent'), /everyone/);
  await page.click('#on');
  await page.waitForFunction(() => document.querySelector('#state').textContent === 'The face follows you.', null, { timeout: 240000 });
  const yaws = () => watched.sent.map((payload) => JSON.parse(payload)).flatMap(({ type, frames }) => (type === 'drive' ? frames ?? [] : [])).map(({ faps }) => faps[YAW]);
  await eventually(() => yaws().some((yaw) => yaw < -9000), 'a turn', 240000);
  assert.ok(yaws().every((yaw) => yaw < 9000));
  assert.ok((await page.evaluate(() => window.told)).some((text) => /lips closed/.test(text)));
  for (const [lang, text] of [['it', 'Specchio'], ['pt', 'Espelho'], ['tr', 'Ayna']]) {
    await page.selectOption('#page-lang', lang);
    assert.equal(await page.textContent('#camera-title'), text);
  }
  await page.selectOption('#page-lang', 'en');
  await page.click('#off');
  await page.evaluate(() => (navigator.mediaDevices.getUserMedia = async () => { throw new Error('no'); }));
  await page.click('#on');
  await page.waitForFunction(() => document.querySelector('#state').textContent.startsWith('There is no camera'), null, { timeout: 60000 });
  await page.close();
});
