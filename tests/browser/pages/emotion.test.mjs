// SPDX-License-Identifier: GPL-3.0-or-later
// The emotion player in a real browser, and the element's idle face, mood, and captions of marked-up text.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { artefacts, Daemon, root } from '../../lib/daemon.mjs';
import fs from 'node:fs';
import { isDeepStrictEqual } from 'node:util';
import { difference, launch, openPage, record } from '../../lib/browser.mjs';
import { PNG } from 'pngjs';
import path from 'node:path';

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ idling: true });
  page = await openPage(browser, `${daemon.url}/emotion.html`);
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

const thumb = () => page.evaluate(() => {
  const { ariaValueNow, ariaValueText } = document.querySelector('#thumb');
  return { now: Number(ariaValueNow), text: ariaValueText };
});
/** Waits until FAP n of the drawn face is in the range. */
const drawn = (n, least, most) =>
  page.waitForFunction(
    ([fap, from, to]) => {
      const value = document.querySelector('talking-head').faps[fap] ?? 0;
      return value >= from && value <= to;
    },
    [n, least, most],
    { timeout: 60000 },
  );
/** Waits until `count` pictures are drawn. */
const frames = (count, on = page) =>
  on.evaluate(async (n) => {
    for (let i = 0; i < n; i++) await new Promise(requestAnimationFrame);
  }, count);
/**
 * Waits until mouth and brows are constant for fifteen drawn faces, so an expression has settled; the rest of the face keeps moving. With slow
 * drawing a face stays for many display refreshes; an unchanged face counts once per half second.
 */
const settled = (on = page) =>
  on.evaluate(async () => {
    const face = document.querySelector('talking-head');
    let before = [], whole = '', since = 0;
    for (let same = 0; same < 15; ) {
      const time = await new Promise(requestAnimationFrame);
      const all = JSON.stringify(face.faps);
      if (all === whole && time - since < 500) continue;
      const now = [4, 5, 12, 13, 31, 32].map((n) => face.faps[n] ?? 0);
      same = now.every((value, i) => Math.abs(value - before[i]) < 3) ? same + 1 : 0;
      [before, whole, since] = [now, all, time];
    }
  });
const shot = async (name) => {
  const png = await page.locator('talking-head canvas').screenshot();
  await page.screenshot({ path: path.join(artefacts, `emotion-${name}.png`), fullPage: true });
  return PNG.sync.read(png);
};

test('the disc shows all affects, the six basic ones marked and labelled', async () => {
  await page.waitForSelector('#affects g');
  const dots = await page.locator('#affects g').count();
  assert.equal(dots, Object.keys(JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json'), 'utf8')).affect).length);
  assert.equal(await page.locator('#affects g.basic').count(), 6);
  const names = await page.locator('#spokes text').allTextContents();
  assert.deepEqual(names.sort(), ['disgusto', 'gioia', 'paura', 'rabbia', 'sorpresa', 'tristezza']);
  assert.equal(await page.locator('#affect option').count(), dots + 1);
});

test('the keyboard moves the point, and screen readers announce it', async () => {
  assert.equal(await page.locator('#thumb').getAttribute('role'), 'slider');
  await page.focus('#thumb');
  for (let i = 0; i < 5; i++) await page.keyboard.press('ArrowRight');
  for (let i = 0; i < 2; i++) await page.keyboard.press('ArrowUp');
  const { now, text } = await thumb();
  assert.equal(now, 54);
  assert.match(text, /^gioia 5\d %/);
  await page.keyboard.press('PageUp');
  assert.equal((await thumb()).now, 64);
  await page.keyboard.press('Shift+ArrowLeft');
  assert.ok((await thumb()).now < 64);
  await page.keyboard.press('End');
  assert.equal((await thumb()).now, 100);
  for (let i = 0; i < 3; i++) await page.keyboard.press('ArrowRight');
  assert.equal((await thumb()).now, 100, 'the rim is the rim');
  await page.keyboard.press('Home');
  assert.deepEqual(await thumb(), { now: 0, text: 'Neutra' });
});

test('shows the mood at once on the idle face', async () => {
  await page.selectOption('#affect', 'joy');
  await page.fill('#intensity', '0');
  await drawn(12, -60, 60);
  const neutral = await shot('neutral');
  await page.fill('#intensity', '100');
  await drawn(12, 150, 1200);
  await settled();
  // the region of the mouth
  const { width, height } = neutral;
  const mouth = { left: Math.round(width * 0.35), right: Math.round(width * 0.65), top: Math.round(height * 0.5), bottom: Math.round(height * 0.75) };
  let changed;
  for (const end = Date.now() + 20000; !(changed > 150) && Date.now() < end; ) changed = difference(neutral, await shot('joy'), mouth, 40).count;
  assert.ok(changed > 150, `${changed} pixels`);
  await page.selectOption('#affect', 'anger');
  await drawn(31, -1200, -60);
  await settled();
  await shot('anger');
});

test('the pointer moves the point, also to any affect by its dot', async () => {
  const box = await page.locator('#disc .rim').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2, box.y + 2, { steps: 4 });
  await page.mouse.up();
  assert.match((await thumb()).text, /^sorpresa \d+ %/);
  const dot = await page.locator('#affects g[data-name="shame"] circle').boundingBox();
  await page.mouse.click(dot.x + dot.width / 2, dot.y + dot.height / 2);
  assert.match((await thumb()).text, /^vergogna \d+ %$/);
  assert.equal(await page.inputValue('#affect'), 'shame');
});

test('shows the mixture as markup that the server accepts without a warning', async () => {
  await page.focus('#thumb');
  await page.keyboard.press('Home');
  for (let i = 0; i < 4; i++) await page.keyboard.press('ArrowUp');
  for (let i = 0; i < 3; i++) await page.keyboard.press('ArrowRight');
  const wanted = {
    apml: /<rheme affect="(joy|surprise)" intensity="0.\d+">Ciao &amp; addio\.<\/rheme>/,
    jsml: /<(HAPPY|SURPRISED) WEIGHT="0.\d+"><(HAPPY|SURPRISED) WEIGHT="0.\d+">Ciao/,
    ssml: /<emo:category name="(joy|surprise)" value="0.\d+"\/><emo:category/,
  };
  await page.fill('#text', 'Ciao & addio.');
  for (const [kind, pattern] of Object.entries(wanted)) {
    await page.check(`input[value="${kind}"]`);
    const markup = await page.inputValue('#markup');
    assert.match(markup, pattern);
    const response = await daemon.get('/v1/speech?format=json', { method: 'POST', body: markup, headers: { 'content-type': `application/${kind}+xml` } });
    const { warnings, words, lang } = await response.json();
    assert.deepEqual(warnings.filter((w) => w.code !== 'voice-warning'), [], kind);
    assert.equal(lang, 'it');
    assert.deepEqual(words.map((w) => w.text).filter((w) => w !== '&amp;'), ['Ciao', 'addio']);
  }
});

test('shows the FAP values while the head speaks in that mood', async () => {
  await page.selectOption('#affect', 'joy');
  await page.fill('#text', 'La mamma parla piano, e la nonna ascolta la radio in cucina.');
  // Recorded in the page, because polling from here can miss what is shown for a second.
  await page.evaluate(() => {
    const head = document.querySelector('talking-head');
    const body = document.querySelector('#faps tbody');
    window.most = {};
    head.addEventListener('end', () => (window.ended = true));
    new MutationObserver(() => {
      for (const { cells } of head.debug().running ? body.rows : [])
        window.most[cells[1].textContent] = Math.max(window.most[cells[1].textContent] ?? 0, Number(cells[2].textContent));
    }).observe(body, { childList: true });
    document.querySelector('#faps-box').open = true;
  });
  let jaw = 0, smile = 0;
  for (let go = 0; go < 4 && !(jaw > 100 && smile > 50); go++) { // repeats, because a slow machine draws few faces of a sentence
    await page.evaluate(() => (window.ended = false));
    await page.click('#speak');
    await page.waitForFunction(() => window.ended, null, { timeout: 60000 });
    ({ open_jaw: jaw, stretch_l_cornerlip: smile } = await page.evaluate(() => window.most));
  }
  assert.ok(jaw > 100 && smile > 50, `open_jaw ${jaw}, stretch_l_cornerlip ${smile}`);
});

test('the drawn face does not jump between idling and speech', async () => {
  await page.focus('#thumb');
  await page.keyboard.press('Home');
  await settled();
  // Steps between drawn faces are meaningful only if the machine draws in time: takes the best of several attempts.
  let edges, held = Infinity;
  for (let go = 0; go < 6 && held > 60; go++) {
    await record(page);
    await page.evaluate(() => document.querySelector('talking-head').speak('Mamma mia.', { lang: 'it' }));
    await page.waitForFunction(() => window.log.some((l) => l.running) && !window.log.at(-1).running, null, { timeout: 60000 });
    const log = await page.evaluate(() => ((window.logging = false), window.log));
    const faces = log.filter((l, i) => !i || l.running !== log[i - 1].running || `${l.fapValues}` !== `${log[i - 1].fapValues}`);
    const now = faces.slice(1).map((l, i) => [faces[i], l]).filter(([a, b]) => a.running !== b.running);
    const longest = Math.max(...now.map(([a, b]) => b.now - a.now));
    // more than two edges: sound was interrupted
    if (now.length === 2 && longest < held) [edges, held] = [now, longest];
  }
  assert.ok(edges, 'no utterance without a gap');
  const slack = Math.max(1, held / 60);
  // a jump would be 0.04 rad of the head, or a lip by half the height of an eye, in one step
  for (const [a, b] of edges) {
    for (const n of [48, 49, 50]) assert.ok(Math.abs(b.fapValues[n] - a.fapValues[n]) < 4000 * slack, `${held} ms, head ${a.fapValues[n]} to ${b.fapValues[n]}`);
    for (const n of [3, 4, 5, 12, 13]) assert.ok(Math.abs(b.fapValues[n] - a.fapValues[n]) < 160 * slack, `${held} ms, mouth ${n}: ${a.fapValues[n]} to ${b.fapValues[n]}`);
  }
});

test('idles only while visible and not set to still', async () => {
  const faps = () => page.evaluate(() => JSON.stringify(document.querySelector('talking-head').faps));
  const moves = async () => {
    const now = await faps();
    await page.waitForFunction((old) => JSON.stringify(document.querySelector('talking-head').faps) !== old, now, { timeout: 60000 });
  };
  const rests = () => page.evaluate(() => new Promise((resolve, reject) => {
    const from = performance.now();
    const step = (frames) => {
      const { faps } = document.querySelector('talking-head');
      if (frames === 20) resolve();
      else if (performance.now() - from > 120000) reject(new Error(`still moves: ${JSON.stringify(faps)}`));
      else requestAnimationFrame(() => step(Object.keys(faps).length ? 0 : frames + 1));
    };
    step(0);
  }));
  const change = (act) => page.evaluate(`{ const head = document.querySelector('talking-head'); ${act} }`);
  await moves();
  await change("head.setAttribute('still', '')");
  await rests();
  await change("head.removeAttribute('still')");
  await moves();
  await change("head.style.marginInlineStart = '-4000px'");
  await rests();
  await change("head.style.marginInlineStart = ''");
  await moves();
});

test('still mode shows and holds the mood', async () => {
  const change = (act) => page.evaluate(`{ const head = document.querySelector('talking-head'); ${act} }`);
  const shown = () => page.evaluate(() => document.querySelector('talking-head').faps);
  await change("head.setAttribute('still', ''); head.setAttribute('expression', 'joy 0.9')");
  await page.waitForFunction(() => document.querySelector('talking-head').faps[12] > 20, null, { timeout: 60000 }); // a mouth corner
  // a second, and then two frames: on a busy machine a second can pass without a frame
  const later = () => page.evaluate(() => new Promise((resolve) => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(resolve)), 1000)));
  let before; // waits until the mood has settled
  for (let now = await shown(); !isDeepStrictEqual(now, before); now = await shown()) {
    before = now;
    await later();
  }
  await later();
  assert.deepEqual(await shown(), before);
  await change("head.setAttribute('expression', '')");
  await page.waitForFunction(() => !Object.keys(document.querySelector('talking-head').faps).length, null, { timeout: 60000 });
  await change("head.removeAttribute('still'); head.removeAttribute('expression')");
});

test('the attribute `expression` sets a mood', async () => {
  await page.evaluate(() => document.querySelector('talking-head').setAttribute('expression', 'joy 0.9'));
  await drawn(12, 130, 1200);
  await page.evaluate(() => document.querySelector('talking-head').removeAttribute('expression'));
  await drawn(12, -60, 60);
});

test('captions of marked-up text show its words, are readable, and can be switched off', async () => {
  await page.evaluate(() => {
    window.captions = new Set();
    const box = document.querySelector('talking-head').shadowRoot.querySelector('.captions');
    new MutationObserver(() => window.captions.add(box.textContent)).observe(box, { subtree: true, childList: true, characterData: true });
  });
  const end = await page.evaluate(() =>
    document.querySelector('talking-head').speak('<speak>\n  Uno &amp; <emphasis>due</emphasis>, tre.\n</speak>', { lang: 'it' }));
  assert.equal(end.reason, 'done');
  const captions = await page.evaluate(() => [...window.captions]);
  assert.ok(captions.includes('Uno & due, tre.'), JSON.stringify(captions));
  assert.ok(captions.every((caption) => !/[<>;]/.test(caption)));
  const contrasts = await page.evaluate(() => {
    const root = document.querySelector('talking-head').shadowRoot;
    root.querySelector('.word').textContent = 'x';
    root.querySelector('.captions').classList.remove('empty');
    const canvas = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    const numbers = (colour) => {
      canvas.clearRect(0, 0, 1, 1);
      canvas.fillStyle = colour;
      canvas.fillRect(0, 0, 1, 1);
      const [r, g, b, a] = canvas.getImageData(0, 0, 1, 1).data;
      return [r, g, b, a / 255];
    };
    const light = (rgb) => rgb.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4)).reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
    const contrast = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
    const over = (top, below, alpha) => below.map((c, i) => alpha * top[i] + (1 - alpha) * c);
    const style = (selector) => getComputedStyle(root.querySelector(selector));
    const ground = numbers(style('.captions').backgroundColor).slice(0, 3);
    const on = (selector, under) => {
      const [r, g, b, alpha] = numbers(style(selector).color);
      return contrast(over([r, g, b], under, alpha * Number(style(selector).opacity)), under);
    };
    const [white, button] = [[255, 255, 255], style('.switch')];
    const [alpha, face] = [Number(button.opacity), numbers(button.backgroundColor)];
    const shown = over(face.slice(0, 3), white, alpha * face[3]);
    return {
      said: on('.said', ground), rest: on('.rest', ground), word: on('.word', numbers(style('.word').backgroundColor).slice(0, 3)),
      button: contrast(over(numbers(button.color).slice(0, 3), white, alpha), shown),
    };
  });
  for (const [what, ratio] of Object.entries(contrasts)) assert.ok(ratio >= 4.5, `${what}: ${ratio}`);
  await page.evaluate(() => (document.querySelector('talking-head').captions = false));
  assert.equal(await page.locator('talking-head .captions').isVisible(), false);
});

test('reduced motion shows emotions on an otherwise still face', async () => {
  const other = await browser.newPage({ reducedMotion: 'reduce' });
  await other.goto(`${daemon.url}/emotion.html`);
  await other.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 60000 });
  await other.waitForSelector('#affects g');
  await other.selectOption('#affect', 'joy');
  await other.waitForFunction(() => document.querySelector('talking-head').faps[12] > 80, null, { timeout: 60000 });
  await settled(other);
  const { 48: pitch = 0, 49: yaw = 0 } = await other.evaluate(() => document.querySelector('talking-head').faps);
  await frames(30, other);
  const now = await other.evaluate(() => document.querySelector('talking-head').faps);
  // 1e-5 rad: idle motion turns the head by hundreds of units in half a second, the rest of a transition does not
  const turned = [(now[48] ?? 0) - pitch, (now[49] ?? 0) - yaw];
  assert.ok(turned.every((angle) => Math.abs(angle) < 20), `turned by ${turned}`);
  await other.close();
});

test('fits a phone', async () => {
  await page.setViewportSize({ width: 360, height: 740 });
  await frames(3);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await shot('phone');
  assert.deepEqual(page.problems, []);
});
