// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the face under any page style; counts its pixels in a screenshot of each case.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

// HTML around the element, which replaces %s. style: the page's rule for it; size: expected size, if certain.
const cases = [
  { name: 'as it comes', style: '', size: [320, 416] },
  { name: 'block', style: 'display: block', size: [320, 416] },
  { name: 'block with a height', style: 'display: block; height: 180px', size: [320, 180] },
  { name: 'block with a width of 100%', style: 'display: block; width: 100%; height: 300px', around: '<div style="width: 240px">%s</div>', size: [240, 300] },
  { name: 'block of any size', style: 'display: block; width: auto; height: auto', around: '<div style="width: 240px">%s</div>', size: [240, 416] },
  { name: 'inline', style: 'display: inline', around: '<div style="width: 240px">%s</div>' },
  { name: 'inline-block', style: 'display: inline-block', size: [320, 416] },
  { name: 'inline-block of any size', style: 'display: inline-block; width: auto; height: auto', size: [320, 416] },
  { name: 'flow-root', style: 'display: flow-root', size: [320, 416] },
  { name: 'table-cell', style: 'display: table-cell', size: [320, 416] },
  { name: 'table-cell of any size', style: 'display: table-cell; width: auto; height: auto', size: [320, 416] },
  { name: 'grid', style: 'display: grid; height: 180px', size: [320, 180] },
  { name: 'flex', style: 'display: flex', size: [320, 416] },
  { name: 'contents', style: 'display: contents', around: '<div style="width: 240px; height: 300px">%s</div>' },
  { name: 'all: unset', style: 'all: unset', around: '<div style="width: 240px; height: 300px">%s</div>' },
  { name: 'all: unset in an automatic box', style: 'all: unset', around: '<div style="width: 240px">%s</div>' },
  { name: 'all: initial', style: 'all: initial', around: '<div style="width: 240px">%s</div>' },
  { name: 'height: 100% in an automatic box', style: 'display: block; height: 100%', around: '<div>%s</div>', size: [320, 416] },
  { name: 'height: 100% as it comes', style: 'height: 100%', around: '<div>%s</div>', size: [320, 416] },
  { name: 'height: 100% in a box of 200 pixels', style: 'display: block; height: 100%', around: '<div style="height: 200px">%s</div>', size: [320, 200] },
  { name: 'aspect ratio', style: 'display: block; width: 200px; height: auto; aspect-ratio: 1', size: [200, 200] },
  { name: 'aspect ratio as it comes', style: 'width: 200px; height: auto; aspect-ratio: 4 / 5', size: [200, 250] },
  { name: 'item of a grid', style: 'display: block; width: auto; height: auto', around: '<div style="display: grid; grid-template: 250px / 200px">%s</div>', size: [200, 250] },
  { name: 'item of an automatic grid', style: 'display: block; width: auto; height: auto', around: '<div style="display: grid; width: 200px">%s</div>', size: [200, 416] },
  { name: 'item of a column', style: 'display: block; flex: 1; min-height: 0; height: auto', around: '<div style="display: flex; flex-direction: column; height: 220px">%s<p>Text</p></div>' },
  { name: 'item of a row', style: 'display: block; flex: 1; width: auto', around: '<div style="display: flex; width: 300px; height: 250px">%s<p>Text</p></div>' },
  { name: 'taken out of the flow', style: 'display: block; position: absolute; inset: 10px 0 auto auto; width: auto; height: auto', size: [320, 416] },
  { name: 'a border in the box', style: 'display: block; box-sizing: border-box; height: 200px; padding: 10px; border: 5px solid blue', size: [320, 200] },
];
// page styles that do not name the element
const resets = { 'a reset': '*, ::before, ::after { margin: 0; padding: 0; box-sizing: border-box; min-width: 0 } img, video, canvas, svg { display: block; max-width: 100% }' };

let daemon, browser, server, page;
const problems = [];
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  server = await servePages({ '/': '<!doctype html><meta charset="utf-8"><title>Layout</title><link rel="icon" href="data:,"><style id="reset"></style><style id="style"></style><main id="here"></main>' });
  page = await browser.newPage({ viewport: { width: 500, height: 520 } });
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(server.url);
  await page.addScriptTag({ type: 'module', url: `${daemon.url}/talking-head.js` });
  await page.evaluate(async (src) => {
    // All cases use one element; each moves and restyles it, as frameworks do.
    window.head = Object.assign(document.createElement('talking-head'), { src, lang: 'it', quality: 'low', captions: false });
    window.head.setAttribute('poster', 'off');
    document.getElementById('here').append(window.head);
    await new Promise((resolve) => window.head.addEventListener('ready', resolve, { once: true }));
    window.put = (around, style) => {
      const here = document.getElementById('here');
      document.getElementById('style').textContent = `talking-head { ${style} }`;
      const box = document.createElement('div');
      box.innerHTML = around.replace('%s', '<i></i>');
      here.append(box);
      box.querySelector('i').replaceWith(window.head);
      for (const old of [...here.children]) if (old !== box) old.remove();
    };
    window.drawn = async () => {
      const { frames } = window.head.debug();
      const first = performance.now();
      window.head.pose({ 3: 0 });
      while (window.head.debug().frames === frames && performance.now() - first < 3000) await new Promise((resolve) => setTimeout(resolve, 20));
      await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    };
  }, `${daemon.url.replace('http', 'ws')}/v1/stream`);
});
after(async () => {
  await browser?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Counts pixels of skin in a screenshot. */
async function skin(name, on = page) {
  const picture = await on.screenshot();
  if (name) fs.writeFileSync(`${artefacts}/${name}.png`, picture);
  const { data } = PNG.sync.read(picture);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i] > 100 && data[i] > data[i + 1] + 15 && data[i + 1] > data[i + 2]) count++;
  return count;
}

const LEAST = 2000; // pixels of skin of a face 60 pixels high

for (const { name, style, around = '%s', size } of cases)
  test(`draws the face: ${name}`, async () => {
    await page.evaluate(([html, css]) => window.put(html, css), [around, style]);
    await page.evaluate(() => window.drawn());
    const found = await page.evaluate(() => {
      const { width, height } = window.head.shadowRoot.querySelector('canvas').getBoundingClientRect();
      const host = window.head.getBoundingClientRect();
      return { canvas: [width, height], host: [host.width, host.height].map(Math.round) };
    });
    if (size) assert.deepEqual(found.host, size);
    assert.ok(found.canvas[0] >= 60 && found.canvas[1] >= 100, `the canvas measures ${found.canvas}`);
    if (size) assert.ok(found.canvas[0] <= size[0] && found.canvas[1] <= size[1], `the canvas, ${found.canvas}, is larger than the element`);
    const pixels = await skin(`layout-${name.replace(/\W+/g, '-')}`);
    assert.ok(pixels > LEAST, `${pixels} pixels of skin`);
    assert.deepEqual(problems, []);
  });

for (const [name, rules] of Object.entries(resets))
  test(`draws the face under ${name}`, async () => {
    await page.evaluate((css) => {
      document.getElementById('reset').textContent = css;
      window.put('%s', 'display: block');
    }, rules);
    await page.evaluate(() => window.drawn());
    assert.ok((await skin()) > LEAST);
    await page.evaluate(() => (document.getElementById('reset').textContent = ''));
  });

test('draws the face after being hidden in any way, or of zero size, at first', async () => {
  for (const hide of ['display: none', 'visibility: hidden', 'display: block; width: 0; height: 0', 'display: block; height: 0']) {
    await page.evaluate((css) => {
      window.head.remove();
      window.put('%s', css);
      window.head.quality = window.head.quality === 'low' ? 'high' : 'low'; // switches the quality, which must not be visible
    }, hide);
    await page.evaluate(() => window.drawn());
    await page.evaluate(() => window.put('%s', 'display: block'));
    await page.evaluate(() => window.drawn());
    assert.ok((await skin()) > LEAST, hide);
  }
  await page.evaluate(() => {
    window.head.quality = 'low';
    window.head.hidden = true;
  });
  assert.ok((await skin()) < 100, 'hidden');
  await page.evaluate(() => (window.head.hidden = false));
  await page.evaluate(() => window.drawn());
  assert.ok((await skin()) > LEAST);
  assert.deepEqual(problems, []);
});

test('the button toggles the mouth view, by keyboard too, labelled in the language of the element', async () => {
  await page.evaluate(() => {
    window.put('%s', 'display: block');
    window.head.view = 'face';
    window.mouth = window.head.shadowRoot.querySelector('[part=mouth-button]');
  });
  const now = () => page.evaluate(() => [window.head.view, window.mouth.getAttribute('aria-pressed'), window.mouth.hidden]);
  assert.deepEqual(await now(), ['face', 'false', false]);
  const whole = await page.evaluate(() => window.drawn()).then(skin);
  await page.evaluate(() => window.mouth.focus());
  await page.keyboard.press('Enter');
  assert.deepEqual(await now(), ['mouth', 'true', false]);
  assert.ok((await page.evaluate(() => window.drawn()).then(skin)) > 1.2 * whole, 'skin fills the picture');
  await page.keyboard.press('Space');
  assert.deepEqual(await now(), ['face', 'false', false]);
  const named = await page.evaluate(() => ['en', 'it', 'pt-BR', 'tr'].map((lang) => ((window.head.lang = lang), window.mouth.ariaLabel)));
  assert.deepEqual(named, ['Mouth alone', 'Solo la bocca', 'Só a boca', 'Yalnız ağız']);
  await page.evaluate(() => Object.assign(window.head, { view: null, lang: 'it' }));
  assert.deepEqual(problems, []);
});

test('fits the face and its captions into the element', async () => {
  await page.evaluate(() => {
    window.head.captions = true;
    window.put('%s', 'display: block; height: 240px');
    window.head.shadowRoot.querySelector('.captions').classList.remove('empty'); // as while somebody speaks
  });
  await page.evaluate(() => window.drawn());
  const { bottom, box } = await page.evaluate(() => ({
    bottom: window.head.shadowRoot.querySelector('.captions').getBoundingClientRect().bottom, box: window.head.getBoundingClientRect().bottom,
  }));
  assert.ok(Math.abs(bottom - box) < 1, `the captions end at ${bottom}, the element at ${box}`);
  assert.ok((await skin()) > LEAST);
});
