// SPDX-License-Identifier: GPL-3.0-or-later
// A tablet in a home: two machines connected by a cable (network namespaces), the daemon on one and a browser on the other, which reaches it by a
// non-local address, with a self-made certificate whose authority the tablet has installed. All features that browsers reserve for secure pages
// work: microphone, wake lock, service worker, worklet. Without TLS none of them does.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import { build, Daemon } from '../../lib/daemon.mjs';

const address = '10.78.0.1';
const [home, away] = [`faccia-${process.pid}-home`, `faccia-${process.pid}-tablet`];
const ip = (line) => spawnSync('ip', line.split(' '), { encoding: 'utf8', timeout: 30000 });
const made = ip(`netns add ${home}`);
const skip = made.status !== 0 && `no network of its own can be made here: ${made.stderr?.trim() || made.error?.message}`;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-tablet-'));
const own = path.join(folder, 'tls');
let daemon, browser, token, origin;

/** A program that runs on that machine, under the name of a file. */
function on(machine, program) {
  const file = path.join(folder, `${path.basename(program)}-${machine}`);
  fs.writeFileSync(file, `#!/bin/sh\nexec ip netns exec ${machine} ${program} "$@"\n`, { mode: 0o755 });
  return file;
}

before(async () => {
  if (skip) return;
  for (const line of [
    `netns add ${away}`, `link add tablet0 netns ${home} type veth peer name tablet1 netns ${away}`,
    `-n ${home} addr add ${address}/24 dev tablet0`, `-n ${away} addr add 10.78.0.2/24 dev tablet1`,
    `-n ${home} link set lo up`, `-n ${home} link set tablet0 up`, `-n ${away} link set lo up`, `-n ${away} link set tablet1 up`,
  ]) assert.equal(ip(line).status, 0, line);
  const secret = path.join(folder, 'secret');
  fs.writeFileSync(secret, 'a secret that is long enough for tokens\n', { mode: 0o600 });
  daemon = await Daemon.start(['--host', '*', '--remote', '--secret-file', secret, '--tls-self-signed', own], {}, { program: on(home, path.join(build, 'server/daemon/facciad')) });
  token = execFileSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secret, '--subject', 'tablet', '--rights', 'listen,speak', '--expires', '1h'], { encoding: 'utf8' }).trim();
  origin = `https://${address}:${daemon.port}`;
  // the tablet's trust store
  const store = path.join(folder, '.pki/nssdb');
  fs.mkdirSync(store, { recursive: true });
  execFileSync('certutil', ['-d', `sql:${store}`, '-N', '--empty-password']);
  execFileSync('certutil', ['-d', `sql:${store}`, '-A', '-t', 'C,,', '-n', 'faccia', '-i', path.join(own, 'ca.pem')]);
  browser = await chromium.launch({ executablePath: on(away, '/usr/bin/chromium'), headless: true, env: { ...process.env, HOME: folder },
    args: ['--no-sandbox', '--disable-gpu', '--disable-3d-apis', '--disable-background-networking', '--use-fake-device-for-media-stream', '--use-fake-ui-for-media-stream'] });
});
after(async () => {
  await browser?.close();
  if (!skip) {
    assert.equal((await daemon.stop()).code, 0);
    for (const machine of [home, away]) ip(`netns del ${machine}`);
  }
  fs.rmSync(folder, { recursive: true, maxRetries: 5 });
});

test('redirects to https: without TLS, and trusts the page', { skip }, async () => {
  const page = await browser.newPage();
  const response = await page.goto(`http://${address}:${daemon.port}/room.html?room=hall`);
  assert.equal(response.status(), 200);
  assert.equal(new URL(page.url()).origin, origin);
  assert.equal(response.request().redirectedFrom().url().slice(0, 5), 'http:');
  await page.close();
});

test('offers microphone, wake lock, service worker and worklet, and plays speech', { skip }, async () => {
  const page = await browser.newPage({ reducedMotion: 'reduce' });
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(`${origin}/room.html?room=hall&token=${token}`);
  assert.equal(await page.evaluate(() => isSecureContext), true);
  await page.waitForFunction(() => navigator.serviceWorker.getRegistration().then((one) => one?.active?.state === 'activated'), null, { timeout: 60000 });
  assert.equal(await page.evaluate(async () => (await navigator.mediaDevices.getUserMedia({ audio: true })).getAudioTracks()[0].readyState), 'live');
  assert.equal(await page.evaluate(async () => (await navigator.wakeLock.request('screen')).released), false);
  assert.ok(await page.evaluate(async () => {
    const context = new OfflineAudioContext(1, 1, 48000);
    await context.audioWorklet.addModule('talking-head-worklet.js');
    return new AudioWorkletNode(context, 'faccia-playout') instanceof AudioWorkletNode;
  }));
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
  // her lips follow the tablet's microphone
  assert.equal(await page.evaluate(async () => {
    const head = document.querySelector('talking-head'), stream = await navigator.mediaDevices.getUserMedia({ audio: true });
    const begun = new Promise((resolve) => head.addEventListener('begin', ({ detail }) => resolve(detail.captions), { once: true }));
    const listening = head.listen(stream, { sound: false });
    const captions = await begun;
    listening.stop();
    await listening.done;
    return captions;
  }), false);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a page from another machine without TLS names what is missing and how to fix it', { skip }, async (t) => {
  const plain = await Daemon.start(['--host', '*', '--remote', '--secret-file', path.join(folder, 'secret')], {}, { voices: false, program: on(home, path.join(build, 'server/daemon/facciad')) });
  t.after(() => plain.stop());
  for (const place of ['/', '/room.html?room=hall']) {
    const page = await browser.newPage({ locale: 'it-IT' });
    await page.goto(`http://${address}:${plain.port}${place}`);
    assert.deepEqual(await page.evaluate(() => [isSecureContext, ...[navigator.mediaDevices, navigator.wakeLock, navigator.serviceWorker, new OfflineAudioContext(1, 1, 48000).audioWorklet].map((one) => one === undefined)]), [false, true, true, true, true], place);
    await page.waitForFunction(() => /HTTPS.*microfono.*https:/.test(document.querySelector('#news').textContent), null, { timeout: 30000 }).catch(async (error) => { throw new Error(`${place}: ${await page.evaluate(() => `${isSecureContext} ${location} ${document.querySelector('#news').textContent}`)}`, { cause: error }); });
    await page.close();
  }
});
