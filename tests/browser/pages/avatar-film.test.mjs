// SPDX-License-Identifier: GPL-3.0-or-later
// Uploads a video of poses to the page that makes a head from pictures: it takes the strongest picture of each pose, and reports videos of anything else.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { heads } from '../../lib/built-heads.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { photograph, writePng } from '../../lib/drawn-photographs.mjs';
import { posesOf, withHabits } from '../../lib/habits.mjs';
import { checkStayed, watchPage } from '../../lib/page-private.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-page-film-'));
const file = (name) => path.join(folder, name);
const HELD_MS = 700; // duration of each picture in the video
const WAIT = { timeout: 400000 }; // a busy machine analyses a video slowly
let daemon, browser, page, watched;

const draw = async (name, head, faps, change) => writePng(await photograph(heads, head, 0, undefined, { width: 360, height: 468, faps, change }), file(name));

before(async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  const poses = posesOf();
  await draw('front.png', 'luca', {}, withHabits);
  await draw('smile.png', 'luca', poses.smile, withHabits);
  await draw('brows.png', 'luca', poses['brows-up'], withHabits);
  await draw('stranger.png', 'bruno', poses.smile);
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
  page = await browser.newPage({ locale: 'en-GB', viewport: { width: 1100, height: 900 } });
  watched = watchPage(page);
  await page.goto(`${daemon.url}/avatar.html`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, WAIT);
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true, force: true });
  assert.equal((await daemon.stop()).code, 0);
});

/** Records pictures one after the other with the browser's MediaRecorder: a WebM without a duration. */
async function recorded(names) {
  const bytes = await page.evaluate(async ([pictures, held]) => {
    const images = await Promise.all(pictures.map(async (data) => {
      const image = Object.assign(new Image(), { src: `data:image/png;base64,${data}` });
      await image.decode();
      return image;
    }));
    const canvas = Object.assign(document.createElement('canvas'), { width: images[0].naturalWidth, height: images[0].naturalHeight });
    const context = canvas.getContext('2d');
    const recorder = new MediaRecorder(canvas.captureStream(10), { mimeType: 'video/webm;codecs=vp8', videoBitsPerSecond: 4e6 });
    const pieces = [];
    recorder.addEventListener('dataavailable', ({ data }) => pieces.push(data));
    const stopped = new Promise((resolve) => recorder.addEventListener('stop', resolve));
    recorder.start();
    for (const image of images)
      for (const end = performance.now() + held; performance.now() < end; ) {
        context.drawImage(image, 0, 0);
        await new Promise((resolve) => setTimeout(resolve, 50));
      }
    recorder.stop();
    await stopped;
    return [...new Uint8Array(await new Blob(pieces).arrayBuffer())];
  }, [names.map((name) => fs.readFileSync(file(name)).toString('base64')), HELD_MS]);
  return Buffer.from(bytes);
}

const video = (name, buffer) => ({ name, mimeType: 'video/webm', buffer });
const items = () => page.evaluate(() => [...document.querySelectorAll('#poses li')].map((item) => item.querySelector('select').value));
const state = (word) => page.waitForFunction((text) => document.querySelector('#state').textContent.includes(text), word, WAIT);

test('finds each pose in a video', async (t) => {
  await page.setInputFiles('#files', file('front.png'));
  await state('Found.');
  await page.setInputFiles('#pose-files', [video('me.webm', await recorded(['front.png', 'smile.png', 'front.png', 'brows.png']))]);
  await state('Poses found');
  await page.screenshot({ path: path.join(artefacts, 'portrait-film.png'), fullPage: true });
  t.diagnostic(`${await items()}`);
  assert.deepEqual((await items()).sort(), ['brows-up', 'smile']);
});

test('reports a file that is not a video and a video of another person; accepts other videos', async () => {
  const stranger = await recorded(['stranger.png']);
  const picture = { name: 'brows-up.png', mimeType: 'image/png', buffer: fs.readFileSync(file('brows.png')) };
  await page.setInputFiles('#pose-files', [video('no.webm', Buffer.from('no video')), video('other.webm', stranger), picture]);
  await state('Not used:');
  assert.equal(await page.textContent('#state'), 'Not used: no.webm: This video cannot be read here. other.webm: The face of the picture is not seen in the video.');
  assert.deepEqual((await items()).sort(), ['brows-up', 'brows-up', 'smile']);
});

test('keeps the video in the page, whose policy allows it to play', () => checkStayed(watched, daemon.url));
