// SPDX-License-Identifier: GPL-3.0-or-later
// The Face Player in a browser: shows the last speech, plays, scrubs, edits, undoes and saves it.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { serveModule } from '../../lib/module.mjs';

let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('plots spoken text, shows frames beside the head, drags a key, undoes, saves and reopens', async () => {
  const page = await browser.newPage({ viewport: { width: 1300, height: 950 }, locale: 'it-IT', acceptDownloads: true });
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
  await page.goto(`${daemon.url}/player.html`);
  await page.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open');
  await page.click('#open button');
  await page.waitForSelector('[data-plot="curves"]');
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('[data-plot]')].map((plot) => plot.dataset.plot)), ['wave', 'spectrum', 'prosody', 'phones', 'curves']);
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
  await page.mouse.dblclick(place.x, place.y + over.height / 2); // adds a key by mouse
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
  await page.click('#empty-box summary');
  await page.selectOption('#empty-fps', '50');
  await page.fill('#empty-seconds', '1.5');
  await page.click('#empty button');
  await page.waitForFunction(() => document.querySelector('#scrub').max === '74');
  await page.fill('#value', '500');
  await page.click('#set');
  assert.equal(await at(0), 500, 'an empty stream is edited like another');
  await page.setInputFiles('#files', { name: 'rotto.fap', mimeType: 'text/plain', buffer: Buffer.from('2.1 x 25 1\n1 2 3\n') });
  await page.waitForSelector('#problem .place');
  assert.match(await page.textContent('#problem'), /2/);
  assert.deepEqual(problems, []);
  await page.close();
});

test('opens speech from the first page with its sound', async () => {
  const context = await browser.newContext({ viewport: { width: 1300, height: 950 }, locale: 'it-IT', reducedMotion: 'reduce' });
  const page = await context.newPage();
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
  await page.goto(`${daemon.url}/player.html#last`);
  await page.waitForFunction(() => /Qui non è ancora/.test(document.querySelector('#news').textContent));
  await page.goto(daemon.url);
  await page.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open');
  assert.equal(await page.isVisible('#to-player'), false);
  await page.fill('#text', 'La mamma prepara il pane.');
  await page.click('#speak');
  await page.click('#to-player', { timeout: 60000 });
  await page.waitForURL('**/player.html#last');
  await page.waitForSelector('[data-plot="curves"]');
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('[data-plot]')].map((plot) => plot.dataset.plot)), ['wave', 'spectrum', 'prosody', 'phones', 'curves']);
  await serveModule(page, 'pages/shared/take.js', '/take.js');
  const take = await page.evaluate(async () => {
    const { fps, frames, rate, pcm, words, phones } = await (await import('/take.js')).lastTake();
    const loud = (from, to) => pcm.slice(from * rate, to * rate).reduce((sum, x) => sum + x * x, 0) / (rate * (to - from));
    const m = phones.find(({ ipa }) => ipa === 'm'), a = phones.find(({ ipa }) => ipa.startsWith('a'));
    const lips = (phone) => frames[Math.round(((phone.start + phone.end) / 2) * fps)].slice(4, 6); // upper and lower lip
    return { face: frames.length / fps, sound: pcm.length / rate, words, phones: phones.length, pause: loud(0, phones[0].end), vowel: loud(a.start, a.end), first: phones[0].ipa, m: [...lips(m)], a: [...lips(a)] };
  });
  assert.deepEqual(take.words.map(({ text }) => text), ['La', 'mamma', 'prepara', 'il', 'pane']);
  assert.ok(take.phones > 15 && Math.abs(take.face - take.sound) < 0.3 && take.sound > 1.2, JSON.stringify(take));
  assert.ok(take.vowel > 1e5, JSON.stringify(take));
  assert.ok(take.m[0] + take.m[1] > take.a[0] + take.a[1], `the lips are nearer to each other in /m/: ${take.m}, ${take.a}`); // positive values close the lips
  assert.equal(await page.evaluate(() => Number(document.querySelector('#scrub').max) + 1), Math.round(take.face * 25));
  await page.screenshot({ path: path.join(artefacts, 'player-last.png') });
  assert.deepEqual(problems, []);
  await context.close();
});
