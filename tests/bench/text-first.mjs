// SPDX-License-Identifier: GPL-3.0-or-later
// Time to readable text of the library on a slow phone: ms from requesting the page until its first line is painted, in headless Chromium with empty
// caches, throttled by DevTools (150 ms round trip, 1.6 Mbit/s down, a quarter of the CPU, as Lighthouse's mobile setting), bytes transferred by then,
// and the time of the first request for the head. Compared with the page without scripts and with another build (a folder like build/web), in turns.
// FACCIA_BUILD=build FACCIA_MODELS=build/models FACCIA_WEB=build/web node tests/bench/run.mjs text-first [TURNS] [WEB]
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { Daemon, eventually, root } from '../lib/daemon.mjs';
import { launch } from '../lib/browser.mjs';

const turns = Number(process.argv[2] ?? 5);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-text-'));
const other = process.argv[3];
async function serve(name, env = {}) {
  const daemon = await Daemon.start(['--library', path.join(root, 'models/library'), '--library-index', path.join(folder, name)], env);
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library');
  return daemon;
}
const daemon = await serve('index'), before = other ? await serve('other', { FACCIA_WEB: other }) : null;
const browser = await launch({ webgl: false, idling: true, forced: true, whole: true });
const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

/** Records when the line is painted. */
function watch() {
  const look = () => {
    if (document.getElementById('mare:1:l1')) requestAnimationFrame(() => setTimeout(() => (window.readable = performance.now())));
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

async function once(url, slow) {
  const context = await browser.newContext({ viewport: { width: 390, height: 800 }, deviceScaleFactor: 2, isMobile: true });
  const page = await context.newPage();
  const client = await context.newCDPSession(page);
  await client.send('Network.enable');
  if (slow) {
    await client.send('Network.emulateNetworkConditions', { offline: false, latency: 150, downloadThroughput: 1.6e6 / 8, uploadThroughput: 750e3 / 8 });
    await client.send('Emulation.setCPUThrottlingRate', { rate: 4 });
  }
  await page.addInitScript(watch);
  await page.goto(url, { waitUntil: 'commit' });
  await page.waitForFunction(() => window.readable, null, { timeout: 120000 });
  const found = await page.evaluate(() => {
    const files = performance.getEntriesByType('resource');
    const head = files.filter(({ name }) => /talking-head|\/models\//.test(name)).map(({ startTime }) => startTime);
    const come = files.filter(({ responseEnd }) => responseEnd && responseEnd <= window.readable);
    const text = files.find(({ name }) => /sections\/1$/.test(name));
    return {
      readable: window.readable, kB: come.reduce((sum, { transferSize }) => sum + transferSize, 0) / 1000, files: come.length, head: Math.min(...head),
      asked: text?.requestStart ?? 0, came: text?.responseEnd ?? 0,
    };
  });
  await context.close();
  return found;
}

await once(`${daemon.url}/library.html?at=mare:1`, false); // warms up the browser
const pages = [
  [`${daemon.url}/library.html?at=mare:1`, true, 'library.html'], [`${before?.url}/library.html?at=mare:1`, true, 'library.html of the other build'],
  [`${daemon.url}/library/mare/1`, true, 'without scripts'], [`${daemon.url}/library.html?at=mare:1`, false, 'library.html, not slowed'],
].filter(([url]) => !url.startsWith('undefined')).map(([url, slow, name]) => ({ url, slow, name, all: [] }));
for (let i = 0; i < turns; i++) for (const { url, slow, all } of pages) all.push(await once(url, slow));
console.log('| page | readable after ms | kB, files until then | text asked for, there after ms | head asked for after ms |\n|---|---|---|---|---|');
for (const { name, all } of pages) {
  const of = (key) => median(all.map((one) => one[key])).toFixed(0);
  console.log(`| ${name} | ${of('readable')} | ${of('kB')}, ${of('files')} | ${of('asked')}, ${of('came')} | ${of('head')} |`);
}
await browser.close();
await daemon.stop();
await before?.stop();
fs.rmSync(folder, { recursive: true });
