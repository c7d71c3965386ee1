// SPDX-License-Identifier: GPL-3.0-or-later
// How long until one sees somebody: for each head its bytes on the way, and the milliseconds from asking for the page until its poster is
// there and until the head itself is drawn, in headless Chromium with software rendering, empty caches. An empty page of the same server stands
// beside it. FACCIA_BUILD=build node tests/bench/first-picture.mjs [TURNS]; another build: with its FACCIA_BUILD, FACCIA_MODELS, FACCIA_WEB.
import { Daemon } from '../lib/daemon.mjs';
import { launch } from '../lib/browser.mjs';

const turns = Number(process.argv[2] ?? 3);
const daemon = await Daemon.start();
const browser = await launch();
const { models } = await (await daemon.get('/v1/models')).json();
const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

/** Notes when the element first shows a picture, and when it first draws. */
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
  await page.route('**/probe.html', (route) =>
    route.fulfill({
      contentType: 'text/html',
      body: `<!doctype html><link rel="icon" href="data:,"><script type="module" src="/talking-head.js"></script><talking-head model="${name}" quality="low" captions="off"></talking-head>`,
    }),
  );
  await page.goto(`${daemon.url}/probe.html`);
  await page.waitForFunction(() => window.times.drawn, null, { timeout: 120000 });
  const result = await page.evaluate(() => ({
    ...window.times,
    bytes: performance.getEntriesByType('resource').filter(({ name }) => name.includes('/v1/models/')).map(({ name, encodedBodySize }) => [name.split('/').pop(), encodedBodySize]),
  }));
  await context.close();
  return { ...result, bytes: Object.fromEntries(result.bytes) };
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
  const kB = (bytes) => (bytes ? (bytes / 1000).toFixed(0) : 'none');
  const posters = runs.map(({ poster }) => poster).filter(Boolean);
  console.log(`| ${title} | ${kB(runs[0].bytes[name])} | ${kB(runs[0].bytes[`${name}.webp`])} | ${posters.length ? median(posters).toFixed(0) : 'none'} | ${median(runs.map(({ drawn }) => drawn)).toFixed(0)} |`);
}
console.log(`\nThe median of ${turns}; an answer of a few bytes of the same server: ${median(nothing).toFixed(0)} ms.`);
await browser.close();
await daemon.stop();
