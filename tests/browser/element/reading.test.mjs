// SPDX-License-Identifier: GPL-3.0-or-later
// <talking-head for>: reads an element of the page aloud and highlights words, under a strict policy, from another origin.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

const text = `<h1>Canto primo</h1>
<p id="first">Nel mezzo del <em>cammin</em> di nostra vita<br>mi ritrovai per una <a href="#there">selva</a> oscura.<sup><a href="#n1">1</a></sup> E poi basta.</p>
<p aria-hidden="true">Questo no.</p><p data-unread>Neanche questo.</p><p style="display:none">Né questo.</p><script type="application/json">"no"</script>
<p>Si dice <span lang="en">good morning</span> &amp; <b>buon</b>giorno.</p>
<p id="n1" role="doc-footnote">Una nota.</p>
<div id="long">${'<p>Una riga che riempie la pagina, e dopo di lei un’altra.</p>'.repeat(40)}</div><p id="last">Fine.</p>`;
let daemon, browser, server;
before(async () => {
  daemon = await Daemon.start();
  const policy = `default-src 'none'; script-src ${daemon.url}; connect-src ${daemon.url} ${daemon.url.replace('http', 'ws')}; img-src ${daemon.url};
    style-src 'self'; require-trusted-types-for 'script'; trusted-types 'none'`;
  const body = `<!doctype html><html lang="it"><head><meta charset="utf-8"><title>Testo</title><link rel="stylesheet" href="/own.css">
<script type="module" src="${daemon.url}/talking-head.js"></script></head>
<body><main id="text">${text.replace(' style="display:none"', ' class="away"')}</main><talking-head for="#text" rate="240" src="${daemon.url.replace('http', 'ws')}/v1/stream"></talking-head></body></html>`;
  const css = 'body { margin: 0 } main { font: 28px/1.5 serif; max-width: 30em } talking-head { position: fixed; right: 0; bottom: 0; width: 200px; height: 200px } .away { display: none }';
  server = await servePages({
    '/': { body, headers: { 'content-security-policy': policy.replace(/\s+/g, ' ') } },
    '/own.css': { body: css, type: 'text/css' },
  });
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a page that records words heard, words read, and highlights. */
async function open(script = () => {}) {
  const page = await browser.newPage({ viewport: { width: 900, height: 600 }, reducedMotion: 'reduce' });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.addInitScript(script);
  await page.goto(server.url);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  await page.mouse.click(880, 5);
  await page.evaluate(() => {
    const head = document.querySelector('talking-head');
    Object.assign(window, { head, words: [], read: [], marked: [], before: document.querySelector('#text').outerHTML });
    head.addEventListener('word', ({ detail }) => window.words.push(detail.text));
    head.addEventListener('reading', ({ detail }) => {
      window.read.push(detail.text);
      const [range] = CSS.highlights?.get('talking-head-word') ?? [];
      const boxes = document.querySelector('[data-talking-head-marks]')?.shadowRoot.querySelectorAll('[data-kind="word"] > div');
      window.marked.push(range ? range.toString() : (boxes?.length ?? 0));
    });
  });
  return page;
}

const heard = (page, word) => page.waitForFunction((text) => window.read.includes(text), word, { timeout: 60000 });

test('marks each word as it is heard; skips notes, hidden text and scripts', async () => {
  const page = await open();
  await page.evaluate(() => void (window.result = window.head.read()));
  await heard(page, 'cammin');
  await heard(page, 'Una');
  await page.evaluate(() => window.head.stop());
  assert.deepEqual(await page.evaluate(() => window.result), { reason: 'stopped' });
  const { words, read, marked, same, left } = await page.evaluate(() => ({
    words: window.words, read: window.read, marked: window.marked, same: document.querySelector('#text').outerHTML === window.before,
    left: CSS.highlights.get('talking-head-word').size + CSS.highlights.get('talking-head-sentence').size,
  }));
  assert.equal(read.slice(0, 17).join(' '), 'Canto primo Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura E poi');
  const said = read.join(' ');
  assert.match(said, /poi basta Si dice good morning .*buongiorno Una/);
  assert.doesNotMatch(said, /Questo|questo|nota|no'|1/);
  assert.deepEqual(read, marked, 'what is told is what is marked');
  assert.equal(words.length, read.length);
  assert.equal(left, 0);
  assert.ok(same, 'the text is as it was');
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('continues reading at a clicked word: in the sentence, elsewhere, in a pause; links stay links', async () => {
  const page = await open();
  const click = (selector, word) => page.evaluate(([where, what]) => {
    const walker = document.createTreeWalker(document.querySelector(where), NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const at = walker.currentNode.data.indexOf(what);
      if (at < 0) continue;
      const range = document.createRange();
      range.setStart(walker.currentNode, at);
      range.setEnd(walker.currentNode, at + what.length);
      range.startContainer.parentElement.scrollIntoView({ block: 'center' });
      const { left, top, width, height } = range.getBoundingClientRect();
      return { x: left + width / 2, y: top + height / 2 };
    }
    throw new Error(what);
  }, [selector, word]).then(({ x, y }) => page.mouse.click(x, y));
  await page.evaluate(() => {
    window.jumped = 0;
    window.head.rate = 100; // slow, so that the click comes in time
    window.head.addEventListener('jumped', () => window.jumped++);
    window.result = window.head.read(document.querySelector('#first'));
  });
  await heard(page, 'mezzo');
  await page.evaluate(() => window.read.splice(0));
  await click('#first', 'ritrovai');
  await heard(page, 'ritrovai');
  await page.waitForFunction(() => window.jumped === 1); // plays synthesised speech from there
  assert.ok(!(await page.evaluate(() => window.read)).includes('vita'));
  await page.evaluate(() => window.head.pause());
  await page.evaluate(() => window.read.splice(0));
  await click('#first', 'Nel'); // jumps backwards during a pause
  await heard(page, 'mezzo');
  await page.evaluate(() => (document.querySelector('#there') ?? document.body).id);
  await click('#first', 'selva');
  assert.equal(await page.evaluate(() => location.hash), '#there');
  await page.evaluate(() => window.read.splice(0));
  await click('#last', 'Fine');
  await heard(page, 'Fine');
  assert.deepEqual(await page.evaluate(() => window.result), { reason: 'done' });
  assert.equal(await page.evaluate(() => window.read.filter((word) => word !== 'Fine').length < 12), true);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('scrolls the page along, but not against the reader; draws boxes without the highlight API', async () => {
  const page = await open(() => delete CSS.highlights);
  await page.evaluate(() => void window.head.read(document.querySelector('#long p:nth-child(6)')));
  await heard(page, 'riempie');
  const follows = await page.evaluate(() => scrollY);
  assert.ok(follows > 100, `${follows}`);
  assert.ok((await page.evaluate(() => window.marked)).every((count) => count >= 1));
  await page.mouse.move(300, 300);
  await page.mouse.wheel(0, -3000);
  await page.waitForFunction(() => scrollY === 0);
  const many = await page.evaluate(() => window.read.length);
  await page.waitForFunction((count) => window.read.length > count + 3, many);
  assert.equal(await page.evaluate(() => scrollY), 0, 'the reader is elsewhere');
  await page.evaluate(() => window.head.remove());
  await page.waitForFunction(() => !document.querySelector('[data-talking-head-marks]'));
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('reports a missing target', async () => {
  const page = await open();
  const result = await page.evaluate(() => {
    window.head.addEventListener('error', ({ detail }) => (window.error = detail));
    window.head.for = '#nowhere';
    return window.head.read();
  });
  assert.deepEqual(result, { reason: 'failed', code: 'no-text' });
  assert.match((await page.evaluate(() => window.error)).message, /#nowhere/);
  await page.close();
});
