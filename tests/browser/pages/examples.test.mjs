// SPDX-License-Identifier: GPL-3.0-or-later
// The page of examples in a real browser: every example opens and works, fields change the element, and the source is updated.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { sign } from '../../lib/tokens.mjs';
import { stories } from '../../../web/pages/examples/stories.js';

let daemon, browser, page;
before(async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  daemon = await Daemon.start(['--recogniser', 'sh -c "cat > /dev/null; echo yes"']);
  browser = await launch({ webgl: false, flags: ['--use-fake-device-for-media-stream', '--use-fake-ui-for-media-stream'] });
  page = await open(`${daemon.url}/examples.html`);
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

async function open(url, options = {}, from = browser) {
  const opened = await from.newPage({ viewport: { width: 1500, height: 1000 }, ...options });
  opened.problems = [];
  opened.on('pageerror', (error) => opened.problems.push(String(error)));
  opened.on('console', (message) => message.type() === 'error' && opened.problems.push(message.text()));
  await opened.goto(url);
  await opened.waitForSelector('#source code:not(:empty)');
  return opened;
}

/** Opens an example by its link in the list. */
async function follow(id, on = page) {
  await on.click(`#stories a[href="#${id}"]`);
  await on.waitForSelector(`#stories a[href="#${id}"][aria-current]`);
}
const logged = (name, on = page) => on.waitForSelector(`#log li[data-event="${name}"]`, { state: 'attached', timeout: 60000 });
const code = (on = page) => on.locator('#source').textContent();

/** Events that do not occur in this browser or daemon; other tests of this file cover them, and those of the room's page. */
const ELSEWHERE = { token: ['authorized'], calibrate: ['calibrated'], hear: ['asked', 'answered'], ask: ['asked'], overhear: ['overheard'] };

for (const story of stories)
  test(`the example ${story.id} opens, every button has an effect, and its events are logged`, async () => {
    page.problems.length = 0;
    await follow(story.id);
    assert.equal(await page.locator('#story-title').textContent(), story.title);
    assert.equal(await page.locator('#stage talking-head').first().getAttribute('id'), 'head');
    await page.waitForFunction(() => document.querySelector('#head').debug().connection === 'open');
    const press = (name) => page.click(`#actions [data-act="${name}"]`);
    const { stop, ...acts } = story.actions ?? {};
    for (const name of Object.keys(acts)) await press(name);
    for (const name of story.shows.filter((one) => one.startsWith('@')).map((one) => one.slice(1)))
      if (!ELSEWHERE[story.id]?.includes(name)) await logged(name);
    if (stop) await press('stop');
    for (const name of story.controls ?? []) assert.equal(await page.locator(`#fields [name="${name}"]`).count(), 1, name);
    assert.deepEqual(page.problems.filter((text) => !/missing\.glb|404/.test(text)), []);
  });

test('fields change the element and the source; other changes of the element update the fields', async () => {
  await follow('captions');
  const has = (name) => page.locator('#head').getAttribute(name);
  assert.equal(await page.isChecked('[name="captions"]'), true);
  await page.uncheck('[name="captions"]');
  assert.equal(await has('captions'), 'off');
  assert.match(await code(), /captions="off"/);
  await page.check('[name="captions"]');
  assert.equal(await has('captions'), null);
  await page.selectOption('[name="caption-size"]', 'largest');
  assert.equal(await has('caption-size'), 'largest');
  await page.evaluate(() => document.querySelector('#head').setAttribute('caption-size', 'large'));
  await page.waitForFunction(() => document.querySelector('[name="caption-size"]').value === 'large');
  assert.match(await code(), /caption-size="large"/);
  await page.click('#reset');
  assert.equal(await has('caption-size'), null);
  assert.equal(await has('lang'), 'it');
  await follow('speak');
  await page.fill('[name="rate"]', '220');
  assert.equal(await page.evaluate(() => document.querySelector('#head').rate), 220);
  assert.match(await code(), /rate="220"/);
  await page.fill('[name="lang"]', 'en');
  await page.press('[name="lang"]', 'Tab');
  assert.equal(await has('lang'), 'en');
  await follow('caption-colours');
  await page.fill('[name="--talking-head-word-background"]', '#00ff00');
  await page.fill('[name="--talking-head-caption-size"]', '2');
  assert.match(await code(), /style="--talking-head-caption-size: 2rem; --talking-head-word-background: #00ff00"/);
  await page.click('#actions [data-act="speak"]');
  await page.waitForFunction(() => getComputedStyle(document.querySelector('#head').shadowRoot.querySelector('.word')).backgroundColor === 'rgb(0, 255, 0)');
});

test('writes the source for each framework, and copies it', async () => {
  await follow('speak');
  for (const [kind, wanted] of Object.entries({ react: /useRef/, vue: /<script setup>/, svelte: /bind:this/, html: /addEventListener/ })) {
    await page.check(`#kinds [value="${kind}"]`);
    assert.match(await code(), wanted);
  }
  assert.match(await code(), /const speak = \(head\) => head\.speak\('Nel mezzo/, 'as it is written, not as bundlers shorten it');
  await page.evaluate(() => Object.defineProperty(navigator, 'clipboard', { configurable: true, value: { writeText: async (text) => (window.copied = text) } }));
  await page.click('#copy');
  await page.waitForFunction(() => document.querySelector('#news').textContent === 'Copied');
  assert.equal(await page.evaluate(() => window.copied), await code());
});

test('keyboard: skip link past the list, the example named in the address, a scrollable event list', async () => {
  const other = await open(`${daemon.url}/examples.html#pause`);
  assert.equal(await other.locator('#story-title').textContent(), 'Pause and resume');
  await other.keyboard.press('Tab');
  await other.keyboard.press('Enter');
  assert.equal(await other.evaluate(() => document.activeElement.id), 'story-title');
  assert.match(other.url(), /#pause$/);
  await other.focus('#stories a[href="#mood"]');
  await other.keyboard.press('Enter');
  await other.waitForFunction(() => document.activeElement.id === 'story-title' && document.title.startsWith('Mood'));
  await other.goBack();
  await other.waitForFunction(() => document.title.startsWith('Pause'));
  await other.focus('#log');
  assert.deepEqual(other.problems, []);
  await other.close();
});

test('axe finds no violation in light, dark, forced colours and a narrow window without overflow', async () => {
  for (const id of ['speak', 'caption-colours', 'turns']) {
    await follow(id);
    for (const [name, media, rules] of [['light', {}], ['dark', { colorScheme: 'dark' }, ['color-contrast']], ['forced', { forcedColors: 'active' }, ['color-contrast']]]) {
      await page.emulateMedia({ colorScheme: 'light', forcedColors: 'none', ...media });
      assert.deepEqual(await violations(page, rules), [], `${id}, ${name}`);
    }
    await page.emulateMedia({ colorScheme: 'light', forcedColors: 'none' });
  }
  await page.setViewportSize({ width: 360, height: 740 });
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  assert.deepEqual(await violations(page), []);
  await page.screenshot({ path: path.join(artefacts, 'examples-narrow.png'), fullPage: true });
});

test('a token in the address authenticates and is left out of the source', async (t) => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-examples-'));
  const secret = 'x'.repeat(40);
  fs.writeFileSync(path.join(folder, 'secrets'), secret, { mode: 0o600 });
  const own = await Daemon.start(['--secret-file', path.join(folder, 'secrets')]);
  t.after(async () => {
    await own.stop();
    fs.rmSync(folder, { recursive: true });
  });
  const token = sign({ secret });
  const other = await open(`${own.url}/examples.html?token=${token}#token`);
  await logged('authorized', other);
  assert.ok(!(await code(other)).includes(token) && !other.url().includes(token));
  await other.close();
});

test('with a face: draws it beside its fields, applies a shape and the example’s style', async () => {
  const seeing = await launch();
  const other = await open(`${daemon.url}/examples.html#calibrate`, {}, seeing);
  await other.waitForFunction(() => document.querySelector('#head').debug().state === 'idle', null, { timeout: 120000 });
  await other.click('#actions [data-act="all"]');
  await logged('calibrated', other);
  await follow('speak', other);
  await other.waitForFunction(() => document.querySelector('#head').debug().state === 'idle', null, { timeout: 120000 });
  await other.click('#actions [data-act="speak"]');
  await logged('word', other);
  await other.screenshot({ path: path.join(artefacts, 'examples.png') });
  assert.deepEqual(other.problems, []);
  await seeing.close();
});
