// SPDX-License-Identifier: GPL-3.0-or-later
// Two faces on one page, the same head twice or two heads: bytes transferred, data decoded, and the browser's CPU time until both are drawn, with empty
// caches and software rendering. --before also measures another folder (the build/web of an older commit), in turns.
// FACCIA_BUILD=build node tests/bench/run.mjs faces [--turns 3] [--before FOLDER]
import path from 'node:path';
import { parseArgs } from 'node:util';
import { launch } from '../lib/browser.mjs';
import { Daemon } from '../lib/daemon.mjs';
import { servePages } from '../lib/page-server.mjs';
import { descendantSeconds, median } from './figures.mjs';

const { values: options } = parseArgs({ options: { turns: { type: 'string', default: '3' }, before: { type: 'string' } } });
const daemons = { now: await Daemon.start(), ...(options.before ? { before: await Daemon.start([], { FACCIA_WEB: path.resolve(options.before) }) } : {}) };
const spent = () => descendantSeconds(Object.values(daemons).map(({ process: { pid } }) => pid));
const browser = await launch({ idling: true });

async function once({ url }, names) {
  const face = (name) => `<talking-head style="inline-size:320px;block-size:400px" src="${url.replace('http', 'ws')}/v1/stream" model="${name}" quality="low" captions="off" poster="off" still></talking-head>`;
  const pages = await servePages({ '/': `<!doctype html><link rel="icon" href="data:,"><script type="module" src="${url}/talking-head.js"></script>${names.map(face).join('')}` });
  const context = await browser.newContext({ viewport: { width: 700, height: 600 } });
  const page = await context.newPage();
  const network = await context.newCDPSession(page);
  await network.send('Network.enable');
  const [heads, found] = [new Set(), { requests: 0, kB: 0 }];
  network.on('Network.requestWillBeSent', ({ requestId, request }) => /\/v1\/models\/\w+(\?|$)/.test(request.url) && heads.add(requestId) && found.requests++);
  network.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => heads.has(requestId) && (found.kB += encodedDataLength / 1000));
  await page.addInitScript(() => {
    window.decoded = 0;
    const decode = window.createImageBitmap;
    window.createImageBitmap = (...args) => (window.decoded++, decode(...args));
  });
  const cpu = spent();
  await page.goto(pages.url);
  await page.waitForFunction(() => [...document.querySelectorAll('talking-head')].every((head) => head.debug?.().frames), null, { timeout: 180000 });
  found.drawn = spent() - cpu;
  found.decoded = await page.evaluate(() => window.decoded);
  await context.close();
  await pages.close();
  return found;
}

await once(daemons.now, ['mara']); // warms up the browser
const kinds = [['mara'], ['mara', 'mara'], ['mara', 'bruno']].flatMap((names) => Object.keys(daemons).map((which) => ({ names, which, runs: [] })));
for (let turn = 0; turn < Number(options.turns); turn++) for (const { names, which, runs } of kinds) runs.push(await once(daemons[which], names));
console.log('| heads | build | requests | kB | pictures decoded | processor, s, until drawn |\n|---|---|---|---|---|---|');
for (const { names, which, runs } of kinds) {
  const of = (key) => median(runs.map((run) => run[key]));
  console.log(`| ${names.join(', ')} | ${which} | ${of('requests')} | ${of('kB').toFixed(0)} | ${of('decoded')} | ${of('drawn').toFixed(1)} |`);
}
await browser.close();
for (const daemon of Object.values(daemons)) await daemon.stop();
