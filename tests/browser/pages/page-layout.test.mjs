// SPDX-License-Identifier: GPL-3.0-or-later
// Pages on a phone and at 200 % zoom, and captions in the reader's style, also with forced colours.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch, openPage } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';

const PAGES = ['', 'emotion.html', 'voices.html', 'avatar.html'];
let daemon, browser;
before(async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a page without waiting for its head. */
async function visit(name, options) {
  const page = await browser.newPage({ locale: 'it-IT', ...options });
  await page.goto(`${daemon.url}/${name}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  return page;
}
const shot = (page, name) => page.screenshot({ path: path.join(artefacts, `layout-${name}.png`) });
const sideways = (page) => page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

test('on a phone the face, the text and the button Speak are seen without scrolling, in every language', async () => {
  for (const locale of ['it-IT', 'pt-BR', 'tr-TR', 'en-GB']) {
    const page = await visit('', { locale, viewport: { width: 360, height: 640 } });
    const boxes = {};
    for (const what of ['talking-head', '#text', '#speak', '#pause', '#stop', '#repeat']) boxes[what] = await page.locator(what).boundingBox();
    for (const [what, { x, y, width, height }] of Object.entries(boxes))
      assert.ok(x >= 0 && y >= 0 && x + width <= 360 && y + height <= 640, `${locale}: ${what} at ${x}, ${y}, ${width} x ${height}`);
    assert.ok(boxes['talking-head'].height >= 240, 'and the face is no stamp');
    assert.equal(boxes['#pause'].y, boxes['#repeat'].y, `${locale}: in one row`);
    await shot(page, `phone-${locale}`);
    await page.close();
  }
});

test('nothing scrolls sideways at 320 pixels, nor at 200 %, with all open and the greatest captions', async () => {
  for (const name of PAGES)
    for (const view of [{ viewport: { width: 320, height: 568 } }, { viewport: { width: 640, height: 400 }, deviceScaleFactor: 2 }]) {
      const page = await visit(name, { ...view, locale: 'pt-BR' });
      await page.evaluate(() => document.querySelectorAll('details').forEach((details) => (details.open = true)));
      await page.check('input[value="largest"]');
      await page.evaluate(() => (document.querySelector('#access').hidden = false));
      assert.ok((await sideways(page)) <= 0, `${name} at ${view.viewport.width}`);
      const out = await page.evaluate(() =>
        [...document.querySelectorAll('button, select, textarea, input, a, summary, p')]
          .filter((element) => element.checkVisibility() && !element.closest('.hidden, .skip'))
          .filter((element) => {
            const { left, right, width } = element.getBoundingClientRect();
            return width > 1 && (left < 0 || right > document.documentElement.clientWidth);
          })
          .map((element) => element.outerHTML.slice(0, 80)));
      assert.deepEqual(out, [], name);
      await page.close();
    }
});

test('whatever can be touched is 44 pixels high and wide', async () => {
  for (const name of PAGES) {
    const page = await visit(name, { viewport: { width: 360, height: 640 }, hasTouch: true });
    if (name === 'voices.html') await page.waitForSelector('#voices button');
    await page.evaluate(() => {
      document.querySelectorAll('details').forEach((details) => (details.open = true));
      document.querySelectorAll('#access, #said-buttons').forEach((element) => (element.hidden = false));
    });
    const small = await page.evaluate(() => {
      const found = [...document.querySelectorAll('a:not(.skip), button, select, textarea, input, summary, [tabindex]:not(svg *)')];
      found.push(document.querySelector('talking-head').shadowRoot.querySelector('.switch'));
      return found
        .filter((element) => element.checkVisibility())
        .map((element) => [element, (element.matches('[type=radio], [type=checkbox]') ? element.closest('label') : element).getBoundingClientRect()])
        .filter(([, { width, height }]) => width < 44 || height < 44)
        .map(([element, { width, height }]) => `${element.id || element.textContent} ${width} x ${height}`);
    });
    assert.deepEqual(small, [], name);
    await page.close();
  }
});

test('captions are as the reader chose them, on all pages and the next time', async () => {
  const page = await openPage(browser, daemon.url);
  const look = () => page.evaluate(() => {
    const root = document.querySelector('talking-head').shadowRoot;
    const style = getComputedStyle(root.querySelector('.captions'));
    return { size: parseFloat(style.fontSize), ground: style.backgroundColor, colour: style.color, shown: root.querySelector('.captions').checkVisibility() };
  });
  const usual = await look();
  await page.click('#caption-box summary');
  const sizes = [usual.size];
  for (const size of ['large', 'larger', 'largest']) {
    await page.check(`input[value="${size}"]`);
    sizes.push((await look()).size);
  }
  assert.deepEqual([...sizes].sort((a, b) => a - b), sizes);
  assert.ok(sizes[3] >= 2 * sizes[0], `${sizes}`);
  const looks = { contrast: ['rgb(0, 0, 0)', 'rgb(255, 255, 255)'], light: ['rgb(255, 255, 255)', 'rgb(20, 17, 15)'], yellow: ['rgb(0, 0, 0)', 'rgb(255, 230, 0)'] };
  for (const [name, [ground, colour]] of Object.entries(looks)) {
    await page.check(`input[value="${name}"]`);
    const now = await look();
    assert.deepEqual([now.ground, now.colour], [ground, colour], name);
  }
  // so large that only part of the sentence fits
  await page.evaluate(() => {
    window.captions = new Set();
    const box = document.querySelector('talking-head').shadowRoot.querySelector('.captions');
    window.heights = new Set();
    new MutationObserver(() => {
      window.captions.add(box.textContent);
      window.heights.add(box.offsetHeight);
    }).observe(box, { subtree: true, childList: true, characterData: true });
  });
  const text = 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura.';
  await page.evaluate((what) => document.querySelector('talking-head').speak(what, { lang: 'it', rate: 240 }), text);
  const shown = (await page.evaluate(() => [...window.captions])).filter(Boolean);
  assert.ok(shown.length >= 2 && shown.every((each) => each.length < text.length && text.includes(each)), JSON.stringify(shown));
  assert.equal(await page.evaluate(() => window.heights.size), 1, 'two lines always do: the picture above does not jump');
  await page.evaluate(() => document.querySelector('talking-head').shadowRoot.querySelector('.switch').click());
  assert.equal(await page.isChecked('#captions'), false, 'the button on the picture and the switch say the same');
  assert.equal((await look()).shown, false);
  await page.reload();
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  assert.equal((await look()).shown, false);
  await page.goto(`${daemon.url}/emotion.html`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  await page.click('#caption-box summary');
  await page.check('#captions');
  assert.deepEqual(await look(), { size: sizes[3], ground: 'rgb(0, 0, 0)', colour: 'rgb(255, 230, 0)', shown: true });
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('the present word stands out by more than its colour, and in the colours of the system', async () => {
  const page = await openPage(browser, daemon.url);
  await page.fill('#text', 'La mamma e il papà parlano, e Beppe beve.');
  await page.click('#speak');
  await page.waitForSelector('#said mark:not(:empty)');
  await page.click('#pause'); // the word stays
  const styles = () => page.evaluate(() => {
    const probe = document.body.appendChild(document.createElement('i'));
    probe.style.forcedColorAdjust = 'none';
    const system = (name) => {
      probe.style.color = name;
      return getComputedStyle(probe).color;
    };
    const colours = Object.fromEntries(['Canvas', 'CanvasText', 'Highlight', 'HighlightText'].map((name) => [name, system(name)]));
    probe.remove();
    const of = (element) => {
      const { backgroundColor, color, textDecorationLine, outlineStyle, outlineWidth } = getComputedStyle(element);
      return { text: element.textContent, backgroundColor, color, textDecorationLine, outline: `${outlineStyle} ${outlineWidth}` };
    };
    const root = document.querySelector('talking-head').shadowRoot;
    return { colours, caption: of(root.querySelector('.word')), transcript: of(document.querySelector('#said mark')), box: of(root.querySelector('.captions')) };
  });
  const usual = await styles();
  assert.equal(usual.caption.text, usual.transcript.text);
  for (const { text, textDecorationLine } of [usual.caption, usual.transcript]) {
    assert.match(text, /\p{L}/u);
    assert.equal(textDecorationLine, 'underline');
  }
  await page.emulateMedia({ forcedColors: 'active' });
  const { colours, caption, transcript, box } = await styles();
  assert.notEqual(colours.Highlight, colours.Canvas);
  for (const word of [caption, transcript]) {
    assert.equal(word.backgroundColor, colours.Highlight);
    assert.equal(word.color, colours.HighlightText);
    assert.equal(word.outline, 'solid 2px');
    assert.equal(word.textDecorationLine, 'underline');
  }
  assert.equal(box.backgroundColor, colours.Canvas);
  assert.equal(box.color, colours.CanvasText);
  await shot(page, 'forced');
  await page.close();
});

test('the keyboard reaches everything, and its place is seen', async () => {
  const page = await visit('', { viewport: { width: 1100, height: 900 } });
  await page.waitForFunction(() => document.querySelector('#voice').options.length > 2);
  await page.evaluate(() => document.querySelector('#more').setAttribute('open', ''));
  const reached = [];
  for (let i = 0; i < 30; i++) {
    await page.keyboard.press('Tab');
    const { name, ring } = await page.evaluate(() => {
      const active = document.activeElement;
      const inner = active.shadowRoot?.activeElement ?? active;
      const { outlineStyle, outlineWidth } = getComputedStyle(inner);
      return { name: active.id || (inner.href ? `${inner.className} ${inner.getAttribute('href')}` : active.tagName), ring: outlineStyle !== 'none' && parseFloat(outlineWidth) >= 2 };
    });
    if (name === 'BODY') break;
    assert.ok(ring, `${name} is marked`);
    reached.push(name);
  }
  const wanted = ['skip #text', 'head', 'text', 'speak', 'pause', 'stop', 'repeat', 'lang', 'voice', 'rate', 'link', 'markup', 'room', 'page-lang'];
  assert.deepEqual(wanted.filter((name) => !reached.includes(name)), []);
  assert.deepEqual(reached.filter((name) => wanted.includes(name)), wanted, 'in the order in which they are seen');
  await page.close();
});
