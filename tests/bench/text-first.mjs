// SPDX-License-Identifier: GPL-3.0-or-later
// How long until a text of the library can be read on a slow phone: milliseconds from asking for the page until its first line is painted, in
// headless Chromium with empty caches, slowed by the DevTools protocol (150 ms there and back, 1.6 Mbit/s down, a quarter of the processor, as
// Lighthouse's mobile setting), the bytes that have come by then, and when the head's files were asked for first. The page without scripts
// stands beside it. FACCIA_BUILD=build FACCIA_MODELS=build/models FACCIA_WEB=build/web node tests/bench/text-first.mjs [TURNS]
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { Daemon, eventually, root } from '../lib/daemon.mjs';
import { launch } from '../lib/browser.mjs';

const turns = Number(process.argv[2] ?? 5);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-text-'));
const daemon = await Daemon.start(['--library', path.join(root, 'models/library'), '--library-index', path.join(folder, 'index')]);
await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library');
const browser = await launch({ webgl: false });
const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

/** Notes when the line stands there, after the picture with it. */
function watch() {
  const look = () => {
    if (document.getElementById('mare:1:l1')) requestAnimationFrame(() => setTimeout(() => (window.readable = performance.now())));
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

async function once(address, slow) {
  const context = await browser.newContext({ viewport: { width: 390, height: 800 }, deviceScaleFactor: 2, isMobile: true });
  const page = await context.newPage();
  const client = await context.newCDPSession(page);
  await client.send('Network.enable');
  if (slow) {
    await client.send('Network.emulateNetworkConditions', { offline: false, latency: 150, downloadThroughput: 1.6e6 / 8, uploadThroughput: 750e3 / 8 });
    await client.send('Emulation.setCPUThrottlingRate', { rate: 4 });
  }
  await page.addInitScript(watch);
  await page.goto(daemon.url + address, { waitUntil: 'commit' });
  await page.waitForFunction(() => window.readable, null, { timeout: 120000 });
  const found = await page.evaluate(() => {
    const files = performance.getEntriesByType('resource');
    const head = files.filter(({ name }) => /talking-head|\/models\//.test(name)).map(({ startTime }) => startTime);
    return { readable: window.readable, kB: files.filter(({ responseEnd }) => responseEnd && responseEnd <= window.readable).reduce((sum, { transferSize }) => sum + transferSize, 0) / 1000, head: Math.min(...head) };
  });
  await context.close();
  return found;
}

await once('/library.html?at=mare:1', false); // warms up the browser
console.log('| page | readable after ms | kB until then | head asked for after ms |\n|---|---|---|---|');
for (const [address, slow] of [['/library.html?at=mare:1', true], ['/library/mare/1', true], ['/library.html?at=mare:1', false]]) {
  const all = [];
  for (let i = 0; i < turns; i++) all.push(await once(address, slow));
  const of = (name) => median(all.map((one) => one[name])).toFixed(0);
  console.log(`| ${address}${slow ? '' : ', not slowed'} | ${of('readable')} | ${of('kB')} | ${of('head')} |`);
}
await browser.close();
await daemon.stop();
fs.rmSync(folder, { recursive: true });
