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

test('a phone shows face, text and the button Speak without scrolling, in every language', async () => {
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

test('nothing scrolls sideways at 320 pixels, nor at 200 % zoom, fully expanded with the largest captions', async () => {
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

test('nothing moves while a page is loading, on a desk and on a phone', async (t) => {
  const MOST = 0.02; // cumulative layout shift; Lighthouse calls 0.1 good
  const pages = [...PAGES, 'player.html', 'editor.html', 'examples.html', 'library.html', 'operator.html?room=atrio&name=Anna', 'room.html?room=atrio&clock'];
  for (const name of pages)
    for (const viewport of [{ width: 1350, height: 940 }, { width: 412, height: 823 }]) {
      const page = await browser.newPage({ viewport, locale: 'it-IT' });
      await page.addInitScript(() => {
        window.moved = [];
        const rectangle = ({ x, y, width, height }) => [x, y, width, height].map(Math.round);
        const watch = ({ value, sources }) => window.moved.push({ value, what: sources.map(({ node, previousRect, currentRect }) => `${node?.nodeName}#${node?.id} ${rectangle(previousRect)} to ${rectangle(currentRect)}`) });
        new PerformanceObserver((list) => list.getEntries().forEach(watch)).observe({ type: 'layout-shift', buffered: true });
      });
      await page.goto(`${daemon.url}/${name}`);
      await page.waitForFunction(() => document.querySelector('talking-head')?.debug?.().connection === 'open');
      await page.waitForLoadState('networkidle');
      const moved = await page.evaluate(() => window.moved);
      const sum = moved.reduce((all, { value }) => all + value, 0);
      t.diagnostic(`${name} at ${viewport.width}: ${sum.toFixed(4)}`);
      assert.ok(sum < MOST, `${name} at ${viewport.width}: ${JSON.stringify(moved, null, 1)}`);
      await page.close();
    }
});

test('every control is at least 44 pixels high and wide', async () => {
  for (const name of PAGES) {
    const page = await visit(name, { viewport: { width: 360, height: 640 }, hasTouch: true });
    if (name === 'voices.html') await page.waitForSelector('#voices button');
    await page.evaluate(() => {
      document.querySelectorAll('details').forEach((details) => (details.open = true));
      document.querySelectorAll('#access, #said-buttons').forEach((element) => (element.hidden = false));
    });
    const small = await page.evaluate(() => {
      const found = [...document.querySelectorAll('a:not(.skip), button, select, textarea, input, summary, [tabindex]:not(svg *)')];
      found.push(...document.querySelector('talking-head').shadowRoot.querySelectorAll('.switch, .mouth'));
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

test('caption settings apply to all pages and persist', async () => {
  const page = await openPage(browser, daemon.url);
  const look = () => page.evaluate(() => {
    const root = document.querySelector('talking-head').shadowRoot;
    root.querySelector('.captions').classList.remove('empty'); // without words they have no ground
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

test('highlights the current word by more than colour, also in forced colours', async () => {
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

test('the keyboard reaches everything, with a visible focus', async () => {
  const page = await visit('', { viewport: { width: 1100, height: 900 } });
  await page.waitForFunction(() => document.querySelector('#voice').options.length > 2);
  await page.waitForFunction(() => [...document.querySelector('talking-head').shadowRoot.querySelectorAll('button')].filter((button) => button.offsetParent).length > 1);
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
  // the head has two buttons: captions, and the mouth alone
  const wanted = ['skip #text', 'head', 'head', 'text', 'speak', 'pause', 'stop', 'repeat', 'lang', 'voice', 'rate', 'link', 'markup', 'room', 'page-lang'];
  assert.deepEqual(wanted.filter((name) => !reached.includes(name)), []);
  assert.deepEqual(reached.filter((name) => wanted.includes(name)), wanted, 'in the order in which they are seen');
  await page.close();
});

test('captions take no room while idle; large ones get room below the picture', async () => {
  const page = await visit('', { viewport: { width: 1280, height: 800 } });
  const boxes = (words) => page.evaluate((shown) => {
    const root = document.querySelector('talking-head').shadowRoot;
    const of = (name) => root.querySelector(name).getBoundingClientRect();
    root.querySelector('.captions').classList.toggle('empty', !shown);
    const [layout, stage, captions] = ['.layout', '.stage', '.captions'].map(of);
    return { free: layout.bottom - stage.bottom, height: captions.height / layout.height, low: captions.height && layout.bottom - captions.bottom };
  }, words);
  await page.waitForFunction(() => document.querySelector('talking-head').shadowRoot.querySelector('.over'));
  assert.deepEqual(await boxes(false), { free: 0, height: 0, low: 0 });
  const usual = await boxes(true);
  assert.deepEqual([usual.free, usual.low], [0, 0], 'over the picture');
  assert.ok(usual.height > 0.05 && usual.height < 0.17, `${usual.height}: below the chin`);
  await page.evaluate(() => document.querySelector('talking-head').setAttribute('caption-size', 'largest'));
  await page.waitForFunction(() => !document.querySelector('talking-head').shadowRoot.querySelector('.over'));
  assert.deepEqual(await boxes(false), { free: 0, height: 0, low: 0 });
  const great = await boxes(true);
  assert.ok(great.free > 100 && great.low === 0, JSON.stringify(great));
  await page.close();
});

test('the menu: one group open at a time, closed by Escape or a click elsewhere; on a phone a button opens it', async () => {
  const page = await visit('editor.html', { viewport: { width: 1280, height: 800 } });
  const open = () => page.locator('#site details[open] summary').allTextContents();
  assert.equal(await page.locator('#menu').isVisible(), false);
  assert.deepEqual(await page.locator('#site [aria-current]').allTextContents(), ['Editor']);
  await page.click('#site summary >> nth=0');
  await page.click('#site summary >> nth=1');
  assert.deepEqual(await open(), ['In casa']);
  await page.keyboard.press('Escape');
  assert.deepEqual(await open(), []);
  assert.equal(await page.evaluate(() => document.activeElement.textContent), 'In casa');
  await page.keyboard.press('Enter');
  assert.deepEqual(await open(), ['In casa']);
  await page.mouse.click(640, 700);
  assert.deepEqual(await open(), []);
  await page.click('#site summary >> nth=0');
  await page.click('#site a[href="voices.html"]');
  await page.waitForURL(/voices\.html$/);
  await page.close();

  const phone = await visit('voices.html', { viewport: { width: 360, height: 640 } });
  assert.equal(await phone.locator('#site').isVisible(), false);
  await phone.click('#menu');
  assert.equal(await phone.getAttribute('#menu', 'aria-expanded'), 'true');
  assert.equal(await phone.locator('#site [aria-current]').isVisible(), true, 'its own group is open');
  await phone.click('#site a[href="library.html"]');
  await phone.waitForURL(/library\.html$/);
  await phone.close();
});

test('every page in the menu loads, and is marked as current there', async () => {
  const first = await visit('', {});
  const links = await first.locator('#site a').evaluateAll((all) => all.map((each) => each.getAttribute('href')));
  await first.close();
  for (const link of links) {
    const answer = await daemon.get(`/${link}`);
    assert.equal(answer.status, 200, link);
    const html = await answer.text();
    const current = [...html.matchAll(/<a href="([^"]+)" aria-current="page"/g)].map(([, to]) => to);
    if (link !== 'docs/' && link !== 'room.html') assert.deepEqual(current, [link]);
  }
});
