// SPDX-License-Identifier: GPL-3.0-or-later
// Time to first picture: for each head the bytes transferred, and the ms from requesting the page until its poster is shown and until the head is
// drawn, in headless Chromium with software rendering and empty caches, beside an empty page of the same server.
// FACCIA_BUILD=build node tests/bench/run.mjs first-picture [TURNS]; for another build set FACCIA_BUILD, FACCIA_MODELS and FACCIA_WEB.
import { Daemon } from '../lib/daemon.mjs';
import { launch } from '../lib/browser.mjs';
import { servePages } from '../lib/page-server.mjs';

const turns = Number(process.argv[2] ?? 3);
const daemon = await Daemon.start();
const browser = await launch({ idling: true });
const { models } = await (await daemon.get('/v1/models')).json();
const body = (name) => `<!doctype html><link rel="icon" href="data:,"><script type="module" src="${daemon.url}/talking-head.js"></script>
  <talking-head src="${daemon.url.replace('http', 'ws')}/v1/stream" model="${name}" quality="low" captions="off"></talking-head>`;
const pages = await servePages(Object.fromEntries(models.map(({ name }) => [`/${name}`, body(name)])));
const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

/** Records when the element first shows its poster, and when it first draws. */
function watch() {
  window.times = {};
  const look = () => {
    const head = document.querySelector('talking-head');
    const poster = head?.shadowRoot?.querySelector('.poster');
    if (poster && !poster.hidden) window.times.poster ??= performance.now();
    if (head?.debug?.().frames) window.times.drawn ??= performance.now();
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

async function once(name) {
  const context = await browser.newContext({ viewport: { width: 700, height: 600 } });
  const page = await context.newPage();
  await page.addInitScript(watch);
  await page.goto(`${pages.url}/${name}`);
  await page.waitForFunction(() => window.times.drawn, null, { timeout: 120000 });
  const times = await page.evaluate(() => window.times);
  await context.close();
  return times;
}

/** Transferred bytes of an answer. */
async function bytes(address) {
  const answer = await daemon.get(address, { headers: { 'accept-encoding': 'gzip' } });
  await answer.arrayBuffer();
  return answer.ok ? `${(Number(answer.headers.get('content-length')) / 1000).toFixed(0)}` : 'none';
}

async function empty() {
  const page = await browser.newPage();
  const begun = performance.now();
  await page.goto(`${daemon.url}/healthz`);
  const took = performance.now() - begun;
  await page.close();
  return took;
}

await once(models[0].name); // warms up the browser
const nothing = [];
console.log('| head | kB of the head | kB of the poster | poster after ms | drawn after ms |\n|---|---|---|---|---|');
for (const { name, title } of models) {
  const runs = [];
  for (let i = 0; i < turns; i++) {
    runs.push(await once(name));
    nothing.push(await empty());
  }
  const posters = runs.map(({ poster }) => poster).filter(Boolean);
  console.log(`| ${title} | ${await bytes(`/v1/models/${name}`)} | ${await bytes(`/v1/models/${name}.webp`)} | ${posters.length ? median(posters).toFixed(0) : 'none'} | ${median(runs.map(({ drawn }) => drawn)).toFixed(0)} |`);
}
console.log(`\nThe median of ${turns}; an answer of a few bytes of the same server: ${median(nothing).toFixed(0)} ms.`);
await browser.close();
await pages.close();
await daemon.stop();
