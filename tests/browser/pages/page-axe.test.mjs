// SPDX-License-Identifier: GPL-3.0-or-later
// Runs axe-core on every page in each of its states.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch, openPage } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';

const long = 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura, ché la diritta via era smarrita. '.repeat(4);
let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Checks the page by all rules, and its contrast also in dark mode and forced colours. */
async function flawless(page, state) {
  const looks = [['light', {}], ['dark', { colorScheme: 'dark' }, ['color-contrast']], ['forced', { forcedColors: 'active' }, ['color-contrast']]];
  for (const [name, media, rules] of looks) {
    await page.emulateMedia({ colorScheme: 'light', forcedColors: 'none', ...media });
    assert.deepEqual(await violations(page, rules), [], `${state}, ${name}`);
    await page.screenshot({ path: path.join(artefacts, `axe-${state}-${name}.png`), fullPage: true });
  }
  await page.emulateMedia({ colorScheme: 'light', forcedColors: 'none' });
}

test('the first page: loading, idle, paused inside a word, with an error, fully expanded', async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  const page = await browser.newPage({ locale: 'it-IT', viewport: { width: 1100, height: 900 } });
  let go;
  const held = new Promise((resolve) => (go = resolve));
  await page.route('**/v1/models/**', async (route) => {
    await held;
    await route.continue();
  });
  await page.goto(daemon.url);
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
  await flawless(page, 'loading');
  go();
  await page.evaluate(() => document.querySelector('talking-head').setAttribute('quality', 'low'));
  await page.waitForFunction(() => document.querySelector('talking-head').debug().state === 'idle', null, { timeout: 60000 });
  await flawless(page, 'rest');
  await page.fill('#text', long);
  await page.click('#speak');
  await page.waitForSelector('#said mark:not(:empty)');
  await page.click('#pause'); // the word stays highlighted
  await page.waitForFunction(() => document.querySelector('#pause').textContent === 'Continua');
  await flawless(page, 'halted');
  await page.click('#stop');
  await page.fill('#text', '<speak>Ciao.</spaek>');
  await page.click('#speak');
  await page.waitForSelector('#problem .place');
  await page.click('#more summary');
  await page.click('#caption-box summary');
  await page.evaluate(() => Object.defineProperty(navigator, 'clipboard', { value: undefined })); // as in insecure contexts
  await page.click('#link');
  await page.waitForSelector('#link-field');
  await flawless(page, 'open');
  await page.close();
});

test('the pages for emotions and voices: initial, expanded, speaking', async () => {
  const emotion = await openPage(browser, `${daemon.url}/emotion.html`);
  await emotion.waitForSelector('#affects g');
  await emotion.selectOption('#affect', 'joy');
  await emotion.click('#faps-box summary');
  await emotion.click('#caption-box summary');
  await emotion.click('#speak');
  await emotion.waitForFunction(() => document.querySelector('talking-head').debug().running);
  await flawless(emotion, 'emotion');
  await emotion.close();
  const voices = await openPage(browser, `${daemon.url}/voices.html`);
  await voices.waitForSelector('#voices button');
  await voices.fill('#text', long);
  await voices.click('#voices button');
  await voices.waitForSelector('#voices [aria-current]');
  await flawless(voices, 'voices');
  await voices.close();
});

test('every page that asks for a token', async (t) => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-axe-'));
  const secrets = path.join(folder, 'secrets');
  fs.writeFileSync(secrets, 'x'.repeat(40), { mode: 0o600 });
  const other = await Daemon.start(['--secret-file', secrets]);
  t.after(async () => {
    await other.stop();
    fs.rmSync(folder, { recursive: true });
  });
  for (const name of ['', 'emotion.html', 'voices.html']) {
    const page = await browser.newPage({ locale: 'it-IT' });
    await page.goto(`${other.url}/${name}?token=wrong`);
    await page.waitForSelector('#access .why:not(:empty)');
    await flawless(page, `token-${name.split('.')[0] || 'index'}`);
    await page.close();
  }
});
