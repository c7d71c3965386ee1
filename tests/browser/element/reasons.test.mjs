// SPDX-License-Identifier: GPL-3.0-or-later
// The five-line page of the README under conditions where it cannot work: the element shows advice and fires an error event at once.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { artefacts, build, Daemon } from '../../lib/daemon.mjs';
import { fiveLines, servePages } from '../../lib/page-server.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-reasons-'));
const secrets = path.join(folder, 'secrets');
fs.writeFileSync(secrets, 'x'.repeat(40), { mode: 0o600 });

let daemon, browser, server;
before(async () => {
  daemon = await Daemon.start();
  server = await servePages({});
  browser = await launch({ flags: ['--host-resolver-rules=MAP portal.test 127.0.0.1'] });
});
after(async () => {
  await browser?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

/** Opens a page and waits for its first error event. */
async function open(url, name) {
  const page = await browser.newPage({ viewport: { width: 360, height: 440 } });
  await page.addInitScript(() => {
    window.errors = [];
    document.addEventListener('error', (e) => e.target.localName === 'talking-head' && window.errors.push(e.detail), true);
  });
  await page.goto(url);
  await page.waitForFunction(() => window.errors.length, null, { timeout: 60000 });
  fs.mkdirSync(artefacts, { recursive: true });
  await page.screenshot({ path: path.join(artefacts, `reason-${name}.png`) });
  const [error] = await page.evaluate(() => window.errors);
  const message = page.locator('talking-head [part=message]');
  assert.equal(await message.textContent(), error.message);
  assert.equal(await message.isVisible(), true);
  return { page, error, message };
}

test('tells a page opened as a file how to connect', async () => {
  const file = path.join(folder, 'page.html');
  fs.writeFileSync(file, fiveLines(daemon.url, 'lang="en"'));
  const { page, error } = await open(pathToFileURL(file).href, 'file');
  assert.equal(error.code, 'forbidden-origin');
  assert.match(error.message, /--origin null$/);
  await page.close();
});

test('tells a page of another host, in the language of the element, how to allow it, and connects afterwards', async () => {
  const { port } = daemon;
  server.files['/'] = fiveLines(daemon.url);
  const origin = `http://portal.test:${server.port}`;
  const { page, error, message } = await open(origin, 'host');
  assert.equal(error.code, 'forbidden-origin');
  assert.equal(error.message, `Il server ${daemon.url} non ammette questa pagina. Avviarlo con: facciad --origin ${origin}`);
  await daemon.stop();
  daemon = await Daemon.start(['--port', String(port), '--origin', origin]);
  await page.waitForFunction(() => document.querySelector('talking-head').debug().connection === 'open', null, { timeout: 30000 });
  assert.equal(await message.isVisible(), false, 'what does not hold any more is not said');
  await page.close();
});

test('reports no answer, a foreign server, and an invalid address each with its own message', async () => {
  const stream = daemon.url.replace('http', 'ws');
  for (const [src, code, says] of [
    ['ws://127.0.0.1:9/v1/stream', 'no-server', /127\.0\.0\.1:9\..*facciad/],
    [`${stream}/v2/stream`, 'wrong-address', /v2\/stream.*src/],
    ['ws://:', 'bad-address', /ws:\/\/:/],
  ]) {
    server.files['/'] = fiveLines(daemon.url, 'lang="en"').replace(/ src="ws[^"]*"/, ` src="${src}"`);
    const { page, error } = await open(server.url, code);
    assert.equal(error.code, code);
    assert.match(error.message, says);
    await page.close();
  }
});

test('reports a required token before any speech, and accepts a valid one', async () => {
  const locked = await Daemon.start(['--secret-file', secrets]);
  const token = spawnSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secrets, '--subject', 'anna'], { encoding: 'utf8' }).stdout.trim();
  server.files['/'] = fiveLines(locked.url, 'lang="en"');
  const { page, error, message } = await open(server.url, 'token');
  assert.equal(error.code, 'token-needed');
  await page.evaluate(() => (document.querySelector('talking-head').token = 'no-token'));
  await page.waitForFunction(() => window.errors.at(-1).code === 'bad-token');
  assert.match(await message.textContent(), /does not accept the token/);
  await page.evaluate((good) => (document.querySelector('talking-head').token = good), token);
  await message.waitFor({ state: 'hidden' });
  const end = await page.evaluate(() => document.querySelector('talking-head').speak('Sì.', { lang: 'it' }));
  assert.equal(end.reason, 'done');
  await page.close();
  assert.equal((await locked.stop()).code, 0);
});

test('shows in the picture that the server is gone, until it is back', async () => {
  let gone = await Daemon.start();
  const { port, url } = gone;
  server.files['/'] = fiveLines(url, 'lang="en"');
  const page = await browser.newPage();
  await page.goto(server.url);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  const message = page.locator('talking-head [part=message]');
  assert.equal(await message.isVisible(), false);
  await gone.stop();
  await message.waitFor({ state: 'visible' });
  assert.match(await message.textContent(), /Nothing answers/);
  gone = await Daemon.start(['--port', String(port)]);
  await message.waitFor({ state: 'hidden' });
  await page.close();
  assert.equal((await gone.stop()).code, 0);
});
