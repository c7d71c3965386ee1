// SPDX-License-Identifier: GPL-3.0-or-later
// A tablet at home: the daemon on another address with its own certificate, whose authority the tablet trusts. All features of secure contexts
// work: microphone, wake lock, service worker, worklet.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import { build, Daemon } from '../lib/daemon.mjs';

const address = Object.values(os.networkInterfaces()).flat().find((one) => one.family === 'IPv4' && !one.internal)?.address;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-tablet-'));
const own = path.join(folder, 'tls');
let daemon, browser, token, origin;

before(async () => {
  const secret = path.join(folder, 'secret');
  fs.writeFileSync(secret, 'a secret that is long enough for tokens\n', { mode: 0o600 });
  daemon = await Daemon.start(['--host', '*', '--remote', '--secret-file', secret, '--tls-self-signed', own]);
  token = execFileSync(path.join(build, 'server/app/faccia'), ['token', '--secret-file', secret, '--subject', 'tablet', '--rights', 'listen,speak', '--expires', '1h'], { encoding: 'utf8' }).trim();
  origin = `https://${address}:${daemon.port}`;
  // the tablet's trust store
  const store = path.join(folder, '.pki/nssdb');
  fs.mkdirSync(store, { recursive: true });
  execFileSync('certutil', ['-d', `sql:${store}`, '-N', '--empty-password']);
  execFileSync('certutil', ['-d', `sql:${store}`, '-A', '-t', 'C,,', '-n', 'faccia', '-i', path.join(own, 'ca.pem')]);
  browser = await chromium.launch({ executablePath: '/usr/bin/chromium', headless: true, env: { ...process.env, HOME: folder },
    args: ['--no-sandbox', '--disable-gpu', '--disable-3d-apis', '--disable-background-networking', '--use-fake-device-for-media-stream', '--use-fake-ui-for-media-stream'] });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true, maxRetries: 5 });
});

test('without TLS it is led to https:, and trusts it', { skip: !address && 'this machine has no other address' }, async () => {
  const page = await browser.newPage();
  const response = await page.goto(`http://${address}:${daemon.port}/room.html?room=hall`);
  assert.equal(response.status(), 200);
  assert.equal(new URL(page.url()).origin, origin);
  assert.equal(response.request().redirectedFrom().url().slice(0, 5), 'http:');
  await page.close();
});

test('microphone, wake lock, service worker and worklet are there, and she is heard', { skip: !address && 'this machine has no other address' }, async () => {
  const page = await browser.newPage({ reducedMotion: 'reduce' });
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(`${origin}/room.html?room=hall&token=${token}`);
  assert.equal(await page.evaluate(() => isSecureContext), true);
  await page.waitForFunction(() => navigator.serviceWorker.getRegistration().then((one) => one?.active?.state === 'activated'), null, { timeout: 60000 });
  assert.equal(await page.evaluate(async () => (await navigator.mediaDevices.getUserMedia({ audio: true })).getAudioTracks()[0].readyState), 'live');
  assert.equal(await page.evaluate(async () => (await navigator.wakeLock.request('screen')).released), false);
  assert.equal(await page.evaluate(() => typeof AudioWorkletNode), 'function');
  await page.goto(`${origin}/?token=${token}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open', null, { timeout: 60000 });
  await page.evaluate(() => {
    window.heard = [];
    for (const type of ['word', 'end', 'error', 'sound']) document.querySelector('talking-head').addEventListener(type, ({ detail }) => window.heard.push({ type, ...detail }));
  });
  await page.fill('#text', 'La mamma canta.');
  await page.click('#speak');
  await page.waitForFunction(() => window.heard.some(({ type }) => type === 'end'), null, { timeout: 60000 });
  const heard = await page.evaluate(() => window.heard);
  assert.equal(heard.filter(({ type }) => type === 'word').length, 3);
  assert.equal(heard.find(({ type }) => type === 'end').reason, 'done');
  assert.deepEqual(problems, []);
  await page.close();
});

test('a page that came from another machine without TLS says what it lacks, and what to do', { skip: !address && 'this machine has no other address' }, async (t) => {
  const plain = await Daemon.start(['--host', '*', '--remote', '--secret-file', path.join(folder, 'secret')], {}, { voices: false });
  t.after(() => plain.stop());
  for (const place of ['/', '/room.html?room=hall']) {
    const page = await browser.newPage({ locale: 'it-IT' });
    await page.goto(`http://${address}:${plain.port}${place}`);
    await page.waitForFunction(() => /HTTPS.*microfono.*https:/.test(document.querySelector('#news').textContent), null, { timeout: 30000 }).catch(async (error) => { throw new Error(`${place}: ${await page.evaluate(() => `${isSecureContext} ${location} ${document.querySelector('#news').textContent}`)}`, { cause: error }); });
    await page.close();
  }
});
