// SPDX-License-Identifier: GPL-3.0-or-later
// A daemon that requires tokens: every page takes one from its address or a field, keeps it for the tab, and reports errors.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { build, Daemon } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-page-token-'));
const secrets = path.join(folder, 'secrets');
fs.writeFileSync(secrets, 'x'.repeat(40), { mode: 0o600 });
const token = (...options) => spawnSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secrets, '--subject', 'anna', ...options], { encoding: 'utf8' }).stdout.trim();

let daemon, browser;
before(async () => {
  daemon = await Daemon.start(['--secret-file', secrets]);
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

const visit = async (address, context = browser) => {
  const page = await context.newPage(context === browser ? { locale: 'it-IT' } : {});
  await page.addInitScript(() => {
    window.heard = [];
    addEventListener('DOMContentLoaded', () => {
      for (const type of ['authorized', 'begin', 'end', 'error'])
        document.querySelector('talking-head').addEventListener(type, ({ detail }) => window.heard.push(detail.reason ?? detail.code ?? type));
    });
  });
  await page.goto(daemon.url + address);
  return page;
};
const heard = (page, what) => page.waitForFunction((each) => window.heard.includes(each), what, { timeout: 30000 });
const asked = (page) => page.waitForSelector('#access .why:not(:empty)');
const why = (page) => page.textContent('#access .why');

for (const name of ['/', '/emotion.html', '/voices.html'])
  test(`${name}: takes a token from the address, removes it there, and keeps it for the tab only`, async () => {
    const context = await browser.newContext({ locale: 'it-IT' });
    const page = await visit(`${name}?token=${token()}&x=1`, context);
    await heard(page, 'authorized');
    assert.equal(new URL(page.url()).search, '?x=1');
    assert.equal(await page.isVisible('#access'), false);
    await page.reload();
    await heard(page, 'authorized');
    assert.equal(await page.isVisible('#access'), false);
    const other = await visit(name, context); // another tab of the same browser
    await asked(other);
    assert.equal(await why(other), 'Questo server chiede un codice di accesso.');
    await context.close();
  });

test('shows a token field without one; rejects a wrong token and uses a valid one at once', async () => {
  const page = await visit('/');
  await asked(page);
  assert.equal(await why(page), 'Questo server chiede un codice di accesso.');
  for (let i = 0; i < 2; i++) {
    // the same invalid token again is tried again
    await page.evaluate(() => (window.heard = []));
    await page.fill('#token', 'eyJhbGciOiJIUzI1NiJ9.eyJzdWIiOiJhbm5hIn0.AAAA');
    await page.press('#token', 'Enter');
    await heard(page, 'bad-token');
  }
  assert.equal(await why(page), 'Questo codice di accesso non vale qui. Controllarlo e inserirlo di nuovo.');
  assert.equal(await page.getAttribute('#token', 'aria-invalid'), 'true');
  await page.fill('#token', ` ${token()} `);
  await page.press('#token', 'Enter');
  await heard(page, 'authorized');
  await page.waitForSelector('#access', { state: 'hidden' });
  assert.equal(await page.textContent('#news'), 'Il codice è stato accettato.');
  await page.evaluate(() => (window.heard = []));
  await page.fill('#text', 'Sì.');
  await page.click('#speak');
  await heard(page, 'done');
  await page.close();
});

test('reports an expired token in the language of the page; a later refusal shows the field again', async () => {
  const page = await (await browser.newContext({ locale: 'tr-TR' })).newPage();
  await page.goto(`${daemon.url}/voices.html?token=${token('--expires', '1s')}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  await page.waitForFunction(() => {
    // speaks repeatedly until the token expires
    const head = document.querySelector('talking-head');
    if (document.querySelector('#access').hidden && !head.debug().running) head.speak('Evet.', { lang: 'tr' });
    return !document.querySelector('#access').hidden;
  }, null, { polling: 300, timeout: 60000 });
  assert.equal(await why(page), 'Erişim kodunun süresi doldu. Yeni bir kod girin.');
  await page.reload();
  await asked(page);
  assert.equal(await why(page), 'Bu sunucu bir erişim kodu istiyor.', 'it is not kept');
  await page.context().close();
});

test('ignores a token that the daemon does not need', async (t) => {
  const open = await Daemon.start();
  t.after(() => open.stop());
  const page = await browser.newPage({ locale: 'it-IT' });
  await page.goto(`${open.url}/?token=${token()}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  await page.waitForFunction(() => document.querySelector('#voice').options.length > 2);
  assert.equal(await page.isVisible('#access'), false);
  assert.equal(await page.textContent('#problem'), '');
  await page.close();
});
