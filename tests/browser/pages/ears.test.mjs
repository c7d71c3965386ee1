// SPDX-License-Identifier: GPL-3.0-or-later
// The room's page hears: Chromium's microphone is a file of flite's English, pocketsphinx recognises it.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { POCKETSPHINX } from '../../lib/heard-speech.mjs';
import { microphoneFlags, sayInto } from '../../lib/microphone.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-ears-'));
let daemon, browser, desk;
before(async () => {
  sayInto(path.join(folder, 'fake.wav'), 'the second one');
  daemon = await Daemon.start(['--recogniser', POCKETSPHINX]);
  browser = await launch({ webgl: false, flags: microphoneFlags(path.join(folder, 'fake.wav')) });
  desk = await daemon.stream('?room=kitchen&watch=1');
  await desk.wait({ type: 'observers' });
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  await browser?.close();
  await desk?.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

/** Opens the page of the room, and counts how often it opens the microphone. */
async function visit(url = daemon.url, lang = 'en') {
  const page = await browser.newPage({ viewport: { width: 800, height: 700 } });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.addInitScript(() => {
    window.opened = 0;
    const { mediaDevices } = navigator, open = mediaDevices.getUserMedia.bind(mediaDevices);
    mediaDevices.getUserMedia = (what) => {
      window.opened++;
      window.asked = what;
      return open(what);
    };
  });
  await page.goto(`${url}/room.html?room=kitchen&lang=${lang}`);
  await page.waitForFunction(() => document.body.dataset.state === 'idle', null, { timeout: 60000 });
  return page;
}
const isOn = (page, on) => page.waitForFunction((on) => document.getElementById('microphone').hidden === !on, on, { timeout: 60000 });
const news = (page, text) => page.waitForFunction((text) => document.getElementById('news').textContent === text, text, { timeout: 60000 });
const words = (from = 0) => desk.wait({ type: 'heard', final: true, text: 'the second one' }, { from });

test('is off until somebody agrees; a tap listens until silence, and the words choose an answer', async () => {
  const page = await visit();
  assert.equal(await page.textContent('#talk .text'), 'Hold to speak');
  assert.ok(await page.isHidden('#microphone'));
  await page.click('#talk');
  assert.match(await page.textContent('#ears-consent'), /sound is not kept/);
  await page.screenshot({ path: path.join(artefacts, 'ears-consent.png') });
  await page.click('#ears-no');
  assert.ok(await page.isHidden('#ears-consent'));
  assert.equal(await page.evaluate(() => window.opened), 0);
  desk.send({ type: 'choices', id: 'q', question: 'What would you like?', choices: ['Tea', 'Coffee'] });
  await page.waitForSelector('#question .answers button');
  await page.click('#talk');
  await page.click('#ears-yes');
  await isOn(page, true);
  assert.equal(await page.evaluate(() => window.asked.audio.echoCancellation), true);
  await page.screenshot({ path: path.join(artefacts, 'ears-on.png') });
  assert.deepEqual(await violations(page), []);
  await desk.wait({ type: 'state', state: 'listening' });
  const { by } = await words();
  assert.equal((await desk.wait({ type: 'chosen', id: 'q' })).text, 'Coffee');
  assert.equal((await desk.wait({ type: 'chosen', id: 'q' })).by, by);
  await isOn(page, false);
  await page.waitForFunction(() => document.getElementById('question').hidden);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('hears while the button, or the space bar, is held', async () => {
  const page = await visit();
  await page.click('#talk');
  await page.click('#ears-yes');
  await isOn(page, true);
  await page.click('#talk'); // not longer
  await isOn(page, false);
  for (const [down, up] of [[() => page.mouse.down(), () => page.mouse.up()], [() => page.keyboard.down('Space'), () => page.keyboard.up('Space')]]) {
    const from = desk.messages.length;
    await page.hover('#talk');
    await page.evaluate(() => document.activeElement.blur());
    await down();
    await isOn(page, true);
    await page.waitForFunction(() => document.getElementById('talk').getAttribute('aria-pressed') === 'true');
    await page.waitForTimeout(3500); // the file has been played once
    await up();
    await words(from);
    await isOn(page, false);
    await news(page, 'Heard: the second one');
  }
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('hears hands-free: one utterance after another, stops her when somebody speaks, and answers a question', async () => {
  const page = await visit(), operator = await browser.newPage({ locale: 'en-GB' });
  await operator.goto(`${daemon.url}/operator.html?room=kitchen&name=Anna`);
  await desk.wait(({ type, observers }) => type === 'observers' && observers.some(({ name }) => name === 'Anna'));
  await page.check('#hands-free');
  await page.click('#ears-yes');
  await isOn(page, true);
  let from = desk.messages.length;
  for (let i = 0; i < 2; i++) {
    await words(from);
    from = desk.messages.length;
  }
  await operator.waitForFunction(() => document.getElementById('said').textContent.includes('Heard: the second one'));
  await operator.close();
  await daemon.get('/v1/say?room=kitchen&lang=en&id=long', { method: 'POST', body: 'This is a long story, which nobody wants to hear to its end, because they know it already. '.repeat(8) }); // 45 s
  assert.equal((await desk.wait({ type: 'end', id: 'long' }, { from })).reason, 'stopped');
  const answer = await daemon.get('/v1/rooms/kitchen/commands', { method: 'POST', body: JSON.stringify({ type: 'ask', lang: 'en', text: 'Which?' }) });
  assert.deepEqual((({ reason, text }) => [reason, text])(await answer.json()), ['heard', 'the second one']);
  await page.uncheck('#hands-free');
  await isOn(page, false);
  assert.equal(await page.evaluate(() => window.opened), 1);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('shows no microphone where the daemon does not hear', async () => {
  const deaf = await Daemon.start(), page = await visit(deaf.url);
  assert.ok(await page.isHidden('#talk'));
  await page.keyboard.press('Space');
  assert.equal(await page.evaluate(() => window.opened), 0);
  await page.close();
  assert.equal((await deaf.stop()).code, 0);
});

test('the texts fit in each language', async () => {
  for (const lang of ['it', 'pt', 'tr']) {
    const page = await visit(daemon.url, lang);
    await page.setViewportSize({ width: 360, height: 640 });
    await page.click('#talk');
    for (const id of ['ears-yes', 'ears-no']) assert.ok(await page.evaluate((id) => {
      const { scrollWidth, clientWidth } = document.getElementById(id), { bottom } = document.getElementById(id).getBoundingClientRect();
      return scrollWidth <= clientWidth && bottom <= innerHeight;
    }, id), `${lang} ${id}`);
    await page.screenshot({ path: path.join(artefacts, `ears-${lang}.png`) });
    await page.close();
  }
});
