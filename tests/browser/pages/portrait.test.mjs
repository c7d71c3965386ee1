// SPDX-License-Identifier: GPL-3.0-or-later
// The page that makes a head from a picture, with NASA's public domain portrait of Eileen Collins from Debian's python3-skimage.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch, picture } from '../../lib/browser.mjs';
import '../../lib/built-heads.mjs';
import { artefacts, build, Daemon } from '../../lib/daemon.mjs';
import { photograph, writePng } from '../../lib/drawn-photographs.mjs';
import { checkStayed, watchPage } from '../../lib/page-private.mjs';

const astronaut = '/usr/lib/python3/dist-packages/skimage/data/astronaut.png';
const state = (page, word) => page.waitForFunction((text) => document.querySelector('#state').textContent.includes(text), word, { timeout: 120000 });
let daemon, browser;
before(async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  daemon = await Daemon.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('makes a speaking head from a picture, which never leaves the page', async () => {
  const page = await browser.newPage({ locale: 'en-GB', viewport: { width: 1100, height: 900 } });
  const watched = watchPage(page);
  await page.addInitScript(() => addEventListener('DOMContentLoaded', () => document.querySelector('talking-head').setAttribute('quality', 'low')));
  await page.goto(`${daemon.url}/avatar.html`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  assert.ok(!watched.asked.some((request) => /portrait\.js|\.bin|\.wasm|face-points/.test(request.url())), 'nothing of it is asked for before there is a picture');
  assert.deepEqual(await violations(page), []);

  await page.setInputFiles('#files', { name: 'broken.png', mimeType: 'image/png', buffer: Buffer.from('no picture') });
  await state(page, 'not a picture that can be read');
  await page.setInputFiles('#files', astronaut);
  await state(page, 'Found.');
  assert.deepEqual(await violations(page), []);
  await page.screenshot({ path: path.join(artefacts, 'portrait-points.png'), fullPage: true });
  for (const media of [{ colorScheme: 'dark', forcedColors: 'none' }, { colorScheme: 'light', forcedColors: 'active' }]) {
    await page.emulateMedia(media);
    assert.deepEqual(await violations(page, ['color-contrast']), [], JSON.stringify(media));
  }
  await page.emulateMedia({ colorScheme: 'light', forcedColors: 'none' });

  const point = page.locator('[data-point="noseTip"]');
  const place = () => point.evaluate(({ style }) => [style.left, style.top].map(parseFloat));
  const before = await place();
  await page.locator('#pictures select').selectOption('noseTip');
  await page.locator('[data-step="leftward"]').press('Enter');
  await page.locator('[data-step="leftward"]').press('Shift+ArrowLeft');
  const moved = await place();
  assert.ok(moved[0] < before[0] - 1 && moved[1] === before[1], 'buttons and keys move a point');
  await point.scrollIntoViewIfNeeded();
  const box = await point.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 30, box.y + box.height / 2, { steps: 3 });
  await page.mouse.up();
  assert.ok((await place())[0] > before[0], 'and so does the pointer');

  assert.match(await page.textContent('#pictures-hint'), /an approximation, not a likeness/);
  await page.click('#make');
  await state(page, 'whose build');
  assert.ok(await page.locator('#save').isDisabled(), 'no head is made of a sex that nobody chose');
  assert.equal(await page.locator('#like optgroup').first().locator('option').count(), 3, 'the most similar faces come first');
  assert.deepEqual(await page.locator('#hair option').evaluateAll((options) => options.map(({ value }) => value)), ['photo', 'head', 'black', 'dark', 'brown', 'blond', 'red', 'grey', 'white']);
  assert.equal(await page.inputValue('#hair'), 'photo');
  const styles = await page.locator('#style input').evaluateAll((inputs) => inputs.map(({ value }) => value));
  const tables = await Promise.all(['face-points', 'face-wear'].map((name) => page.evaluate((file) => fetch(file).then((reply) => reply.json()), `${name}.json`)));
  const all = tables.flatMap(Object.keys).length;
  assert.ok(all >= 17, `${all} hairstyles`);
  assert.deepEqual([styles.indexOf('none'), styles.length], [3, all + 1], 'the three most similar hairstyles, then none, then the others');
  assert.deepEqual([await page.inputValue('#beard'), await page.inputValue('#glasses')], ['none', 'none']);
  await page.selectOption('#like', 'mara');
  await page.selectOption('#eyes', 'bruno');
  await page.check('#style input[value="mei"]', { force: true });
  await page.selectOption('#glasses', 'some');
  assert.equal(await page.inputValue('#age'), '', 'nobody is old who does not say so');
  await page.selectOption('#age', '68');
  await page.click('#make');
  await state(page, 'Made, in');
  for (const viewport of [{ width: 390, height: 844 }, { width: 1100, height: 900 }]) {
    await page.setViewportSize(viewport);
    const [photo, face] = await Promise.all(['#look-photo', 'talking-head'].map((one) => page.locator(one).boundingBox()));
    assert.ok(photo.x >= face.x + face.width && photo.x + photo.width <= viewport.width && Math.abs(photo.y - face.y) < 4, `the photograph is beside the head: ${JSON.stringify([photo, face])}`);
    await page.locator('#look-photo').scrollIntoViewIfNeeded();
    await page.screenshot({ path: path.join(artefacts, `portrait-look-${viewport.width}.png`) });
  }
  assert.ok(await page.locator('#save').isDisabled(), 'nobody looked at it yet');
  assert.deepEqual(await violations(page), []);
  await page.screenshot({ path: path.join(artefacts, 'portrait-look.png'), fullPage: true });
  await page.click('#accept');
  assert.ok(await page.locator('#look-photo').isHidden());
  await state(page, 'Done');
  assert.match(await page.textContent('#state'), /an approximation, not a likeness/, 'and again where the result is seen');
  assert.deepEqual(await violations(page), []);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
  const file = path.join(artefacts, 'portrait-page.json');
  await download.saveAs(file);
  const head = JSON.parse(fs.readFileSync(file, 'utf8'));
  assert.equal(head.format, 'faccia-head');
  const partOf = (word) => head.parts.find(({ name }) => name.startsWith(word));
  assert.ok(partOf('glasses') && !partOf('beard'), 'it wears what was chosen');
  const mei = await page.evaluate(() => fetch('v1/models/mei').then((reply) => reply.json()));
  assert.equal(partOf('hair').vertices, mei.parts.find(({ name }) => name === 'hair').vertices, 'hair of another head');
  assert.match(await page.textContent('#credits'), /whose rights are those of the person/);

  await page.selectOption('#lang', 'it');
  await page.fill('#text', 'Ciao, sono io.');
  const ended = page.evaluate(() => new Promise((resolve) => document.querySelector('talking-head').addEventListener('end', ({ detail }) => resolve(detail.reason), { once: true })));
  await page.click('#speak');
  assert.equal(await ended, 'done');
  assert.match(await page.textContent('#credits'), /whose rights/, 'it is still the head of the picture');
  for (const [name, faps] of Object.entries({ rest: {}, a: { 3: 420, 4: -180, 5: -260, 8: -150, 9: -150, 10: -200, 11: -200, 51: -180, 52: -260, 55: -150, 56: -150, 57: -200, 58: -200 }, smile: { 6: 120, 7: 120, 12: 220, 13: 220, 53: 120, 54: 120, 59: 220, 60: 220, 41: 150, 42: 150 }, blink: { 19: 700, 20: 700, 21: 324, 22: 324 } }))
    await picture(page, `portrait-${name}`, faps);

  assert.ok(watched.asked.some((request) => request.url().endsWith('/portrait.js')));
  checkStayed(watched, daemon.url);
  await page.close();
});

test('accepts a side view as a profile, together with a front view', async () => {
  const heads = path.join(process.env.FACCIA_MODELS ?? path.join(build, 'models'), 'heads');
  const files = [];
  for (const yaw of [90, 0]) {
    files.push(path.join(artefacts, `photograph-mei-${yaw}.png`));
    await writePng(await photograph(heads, 'mei', yaw), files.at(-1));
  }
  const page = await browser.newPage({ locale: 'en-GB', viewport: { width: 1100, height: 900 } });
  await page.goto(`${daemon.url}/avatar.html`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  await page.setInputFiles('#files', files[0]);
  await state(page, 'Taken as a profile');
  assert.ok(await page.locator('#making').isHidden(), 'alone it makes no head');
  assert.deepEqual(await violations(page), []);
  await page.setInputFiles('#files', files[1]);
  await state(page, 'Found.');
  await page.screenshot({ path: path.join(artefacts, 'portrait-profile.png'), fullPage: true });
  await page.selectOption('#like', 'luca');
  await page.check('#style input[value="luca"]', { force: true });
  await page.click('#make');
  await state(page, 'Made');
  await page.close();
});

test('offers a dark beard, removes it where it is not wanted, and says so', async () => {
  const file = path.join(artefacts, 'photograph-bruno.png');
  await writePng(await photograph(path.join(process.env.FACCIA_MODELS ?? path.join(build, 'models'), 'heads'), 'bruno', 0), file);
  const page = await browser.newPage({ locale: 'en-GB', viewport: { width: 1100, height: 900 } });
  await page.goto(`${daemon.url}/avatar.html`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  await page.setInputFiles('#files', file);
  await state(page, 'Found.');
  assert.match(await page.textContent('#seen'), /beard/, 'it is recognised, or at least asked for');
  await page.selectOption('#like', 'mara');
  await page.check('#style input[value="none"]', { force: true });
  await page.selectOption('#beard', 'full');
  await page.click('#make');
  await state(page, 'Made');
  await picture(page, 'portrait-bearded', {});
  await page.click('#accept');
  await page.selectOption('#beard', 'none');
  await state(page, 'The dark beard was taken off');
  assert.ok(await page.locator('#save').isDisabled(), 'what is changed is looked at again');
  await picture(page, 'portrait-beardless', {});
  await page.close();
});
