// SPDX-License-Identifier: GPL-3.0-or-later
// The page that compares voices, by keyboard: lists the voices of a language; each speaks on the same face.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
  page = await openPage(browser, `${daemon.url}/voices.html`);
  await page.waitForSelector('#voices button');
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

const ended = (n) => page.waitForFunction((count) => window.ends?.length >= count, n, { timeout: 60000 });

test('lists the voices of the selected language only', async () => {
  const { voices } = await (await daemon.get('/v1/voices')).json();
  const listed = () => page.locator('#voices button').evaluateAll((all) => all.map((b) => b.dataset.voice));
  const of = (lang) => voices.filter((v) => v.lang.split('-')[0].toLowerCase() === lang).map((v) => v.id);
  assert.deepEqual(await listed(), of('it'));
  assert.ok((await listed()).includes('espeak:it'));
  await page.selectOption('#lang', 'tr');
  assert.deepEqual(await listed(), of('tr'));
  assert.equal(await page.getAttribute('#text', 'lang'), 'tr');
  assert.equal(await page.getAttribute('html', 'lang'), 'it', 'the page stays in the language of its reader');
  assert.match(await page.inputValue('#text'), /Gelin/);
  await page.selectOption('#lang', 'it');
});

test('the keyboard reaches and starts each voice', async () => {
  await page.evaluate(() => {
    window.begins = [];
    window.ends = [];
    const head = document.querySelector('talking-head');
    head.addEventListener('begin', ({ detail }) => window.begins.push({ voice: detail.voice, marked: document.querySelector('#voices [aria-current]')?.dataset.voice }));
    head.addEventListener('end', ({ detail }) => window.ends.push(detail.reason));
  });
  await page.fill('#text', 'Ciao.');
  await page.focus('#text');
  const reached = [];
  for (let i = 0; i < 6; i++) {
    await page.keyboard.press('Tab');
    reached.push(await page.evaluate(() => document.activeElement.id || document.activeElement.dataset.voice));
  }
  assert.deepEqual(reached.slice(0, 3), ['lang', 'all', 'stop']);
  const first = reached[3];
  assert.ok(first.includes(':'), first);
  await page.focus(`[data-voice="${first}"]`);
  await page.keyboard.press('Enter');
  await ended(1);
  assert.deepEqual(await page.evaluate(() => window.begins), [{ voice: first, marked: first }]);
  assert.deepEqual(await page.evaluate(() => window.ends), ['done']);
});

test('plays all voices of a language in turn, until Esc', async () => {
  await page.evaluate(() => {
    window.begins = [];
    window.ends = [];
  });
  const ids = await page.locator('#voices button').evaluateAll((all) => all.map((b) => b.dataset.voice));
  await page.focus('#all');
  await page.keyboard.press('Enter');
  await ended(2);
  await page.keyboard.press('Escape');
  await ended(ids.length);
  const begun = await page.evaluate(() => window.begins.map((b) => b.voice));
  assert.deepEqual(begun, ids.slice(0, begun.length));
  assert.deepEqual(page.problems, []);
});
