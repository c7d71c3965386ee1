// SPDX-License-Identifier: GPL-3.0-or-later
// The pronunciation coach: Chromium's microphone is a file of another voice than the model's, its camera a film of a head.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { learner } from '../../lib/learner.mjs';

const TEXT = 'La mamma mangia il pane nella casa.';
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-coach-'));
let daemon, browser, seconds;

before(async () => {
  const says = learner(folder, { text: TEXT.replace('casa', 'cosa'), lang: 'it', voice: 'espeak:it', model: 'luca' });
  seconds = says.seconds;
  daemon = await Daemon.start();
  browser = await launch({ flags: says.flags });
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  await browser?.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

async function visit(query = '', options = {}) {
  const page = await browser.newPage({ viewport: { width: 1100, height: 900 }, locale: 'en-GB', ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.addInitScript(() => {
    window.asked = [];
    const { mediaDevices } = navigator, open = mediaDevices.getUserMedia.bind(mediaDevices);
    mediaDevices.getUserMedia = (what) => {
      window.asked.push(what);
      return open(what);
    };
    addEventListener('DOMContentLoaded', () => document.querySelector('talking-head')?.setAttribute('quality', 'low'));
  });
  await page.goto(`${daemon.url}/coach.html${query}`);
  await page.waitForFunction(() => document.getElementById('head').debug?.().state === 'idle', null, { timeout: 180000 });
  return page;
}

const asked = `?${new URLSearchParams({ text: TEXT, lang: 'it' })}`;

/** Records until the sentence is said: the microphone's file begins when it is opened. */
async function record(page) {
  await page.waitForSelector('#recording:not([hidden])', { timeout: 60000 });
  await page.waitForTimeout(1000 * (seconds + 1));
  await page.click('#record');
  await page.waitForSelector('#result:not([hidden]), #problem p', { timeout: 120000 });
}

test('the microphone is off until somebody agrees, and is off again after the recording', async () => {
  const page = await visit(asked);
  assert.equal(await page.inputValue('#text'), TEXT);
  assert.deepEqual(await violations(page), []);
  await page.click('#record');
  assert.match(await page.textContent('#consent'), /does not keep it/);
  assert.ok(await page.isHidden('#consent-camera'));
  await page.screenshot({ path: path.join(artefacts, 'coach-consent.png') });
  await page.click('#consent-no');
  assert.deepEqual(await page.evaluate(() => window.asked), []);
  await page.click('#record');
  await page.click('#consent-yes');
  await page.waitForSelector('#recording:not([hidden])', { timeout: 60000 });
  assert.equal(await page.getAttribute('#record', 'aria-pressed'), 'true');
  const [wish] = await page.evaluate(() => window.asked);
  assert.ok(wish.audio.noiseSuppression === false && wish.video === false, JSON.stringify(wish));
  await page.screenshot({ path: path.join(artefacts, 'coach-recording.png') });
  await record(page);
  await page.waitForSelector('#recording', { state: 'hidden' });
  assert.equal(await page.textContent('#problem'), '');
  assert.deepEqual(page.problems, []);
  await page.close();
});

/** A page with the result of a recording. */
async function recorded(options, camera = false) {
  const page = await visit(asked, options);
  if (camera) await page.check('#camera');
  await page.click('#record');
  if (camera) assert.ok(await page.isVisible('#consent-camera'));
  await page.click('#consent-yes');
  await record(page);
  assert.equal(await page.textContent('#problem'), '');
  return page;
}
const poseOf = (page) => page.evaluate(() => document.getElementById('head').debug().fapValues.slice(0, 20).join());

test('the vowel that is another is marked, not by colour alone; keys step through the sounds, and the mouth follows', async () => {
  const page = await recorded();
  const sounds = await page.$$eval('#words .sounds button', (all) => all.map((one) => one.getAttribute('aria-label')));
  assert.deepEqual(sounds.filter((label) => /different/.test(label)), ['a: different'], sounds.join('; '));
  assert.ok(sounds.filter((label) => /good/.test(label)).length > sounds.length / 2, sounds.join('; '));
  assert.equal(await page.$eval('#words li[data-state="different"] .word', (word) => word.textContent), 'casa');
  const marks = await page.$$eval('#words b', (all) => all.map((mark) => getComputedStyle(mark, '::after').content.replaceAll('"', '')));
  assert.equal(marks.join(''), sounds.map((label) => (/good/.test(label) ? '✓' : /different/.test(label) ? '≠' : '?')).join(''));
  assert.match(await page.textContent('#sound-heard'), /o, ɔ/);
  assert.match(await page.textContent('#sound-lips'), /open/);
  await page.screenshot({ path: path.join(artefacts, 'coach-result.png'), fullPage: true });
  const open = await poseOf(page);
  await page.focus('#words [aria-current]');
  await page.keyboard.press('ArrowLeft');
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute('aria-current')), 'true');
  await page.waitForFunction((before) => document.getElementById('head').debug().fapValues.slice(0, 20).join() !== before, open, { timeout: 60000 });
  for (let i = 0; i < sounds.length; i++) await page.keyboard.press('ArrowLeft');
  assert.match(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), /^l:/);
  await page.click('#melody-box summary');
  await page.waitForFunction(() => document.getElementById('melody').getContext('2d').getImageData(0, 0, 640, 160).data.some(Boolean));
  assert.deepEqual(await violations(page), []);
  for (const id of ['own-word', 'model-word', 'both-words', 'slowly']) await page.click(`#${id}`);
  await page.fill('#text', 'Un’altra frase.');
  assert.ok(await page.isHidden('#result'));
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('with the camera, the own mouth at the same sound is beside the model\'s; on a phone, too', async () => {
  const page = await recorded({ viewport: { width: 390, height: 844 } }, true);
  const [wish] = await page.evaluate(() => window.asked);
  assert.ok(wish.video && wish.audio, JSON.stringify(wish));
  const picture = () => page.$eval('#frame', (canvas) => (canvas.hidden ? null : canvas.toDataURL()));
  const pictures = new Set();
  for (const sound of await page.$$('#words .sounds button')) {
    await sound.click();
    pictures.add(await picture());
  }
  assert.ok(pictures.size > 8 && !pictures.has(null), `${pictures.size} pictures of the own mouth`);
  assert.equal(await page.$eval('#preview', (video) => video.srcObject), null);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the screen');
  const [model, own] = await page.$$eval('.mouths figure', (all) => all.map((one) => one.getBoundingClientRect().toJSON()));
  assert.ok(Math.abs(model.top - own.top) < 2 && own.left >= model.right, JSON.stringify([model, own]));
  assert.deepEqual(await violations(page), []);
  await page.click('#words li:nth-child(2) .sounds button:nth-child(2)');
  await page.screenshot({ path: path.join(artefacts, 'coach-phone.png') });
  assert.deepEqual(page.problems, []);
  await page.close();
});
