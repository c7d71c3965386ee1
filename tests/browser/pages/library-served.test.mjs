// SPDX-License-Identifier: GPL-3.0-or-later
// The library as served by the daemon: its page, plain pages without scripts, oEmbed, and offline use.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { Daemon, eventually, ordinary } from '../../lib/daemon.mjs';

const tei = `<?xml version="1.0" encoding="UTF-8"?>
<TEI xmlns="http://www.tei-c.org/ns/1.0" xml:lang="it"><teiHeader><fileDesc><titleStmt><title>Il "mare" &amp; la luna</title><author>A. Rossi</author></titleStmt>
<publicationStmt><p>Esempio</p></publicationStmt><sourceDesc><p>Scritto per prova.</p></sourceDesc></fileDesc></teiHeader><text><body>
<div><head>Canto primo</head><lg><l>Il mare è calmo, la luna è piena,</l><l>la barca torna con la vela scura.</l></lg>
<p>Disse 😀 <foreign xml:lang="en">good morning</foreign><note>In inglese.</note>, e <emph>basta</emph>: 1 &lt; 2 &amp; 3.</p></div>
<div><head>Canto secondo</head><p>Fine.</p></div></body></text></TEI>`;
const recorded = 'Il gatto dorme vicino al fuoco. Il sole tramonta presto, e nessuno parla.';
let daemon, browser, folder;
before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-library-'));
  fs.mkdirSync(path.join(folder, 'texts'));
  fs.writeFileSync(path.join(folder, 'texts/mare.xml'), tei);
  fs.writeFileSync(path.join(folder, 'texts/zitto.md'), `---\ntitle: Zitto\nlang: it\n---\n${recorded}\n`);
  execFileSync(path.join(ordinary, 'server/cli/faccia'), ['say', '--lang', 'it', '--voice', 'espeak:it', '--wav', path.join(folder, 'texts/zitto.wav'), recorded]);
  daemon = await Daemon.start(['--library', path.join(folder, 'texts'), '--library-index', path.join(folder, 'index')]);
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library to be read');
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

test('without scripts: lists works, shows a section with its sound and links; escapes all markup in the text', async () => {
  const page = await browser.newPage({ javaScriptEnabled: false });
  await page.goto(`${daemon.url}/library`);
  await page.click('#works a');
  assert.deepEqual([await page.textContent('h1'), await page.textContent('h2')], ['Il "mare" & la luna', 'Canto primo']);
  assert.equal(await page.locator('.line').count(), 2);
  assert.match(await page.textContent('[id="mare:1:p1"]'), /^Disse 😀 good morning\*, e basta: 1 < 2 & 3\.$/);
  assert.equal(await page.textContent('i[lang="en"]'), 'good morning');
  assert.equal(await page.textContent('em'), 'basta');
  const sound = await page.getAttribute('audio', 'src');
  const heard = await daemon.get(sound);
  assert.equal(heard.status, 200);
  assert.equal(Buffer.from(await heard.arrayBuffer()).subarray(0, 4).toString(), 'OggS');
  await page.click('nav a');
  assert.equal(await page.textContent('h2'), 'Canto secondo');
  await page.close();
  const again = await browser.newPage();
  await again.goto(`${daemon.url}/library/mare/1`);
  assert.deepEqual(await violations(again), []);
  await again.close();
});

test('narrows a search by author and form, shows matching titles, and offers all occurrences as a table', async () => {
  fs.writeFileSync(path.join(folder, 'texts/barca.md'), '---\ntitle: La vela e la barca\nauthor: B. Verdi\nlang: it\ndate: 1899\n---\nLa vela si vede, la vela si perde.\n');
  await eventually(async () => (await (await daemon.get('/v1/library/search?q=vela')).json()).total === 2, 'the new work');
  const page = await browser.newPage({ viewport: { width: 1100, height: 800 }, locale: 'it-IT', serviceWorkers: 'block' });
  await page.goto(`${daemon.url}/library.html`);
  await page.fill('#q', 'vela');
  await page.waitForSelector('#results li:nth-child(2)');
  assert.deepEqual(await page.locator('#titles a span').allTextContents(), ['La vela e la barca']);
  assert.deepEqual(await page.locator('#facets label:visible select').evaluateAll((all) => all.map(({ name }) => name)), ['author', 'form'], 'one century is no choice');
  assert.deepEqual(await page.locator('#facets select[name=form] option').allTextContents(), ['Tutte', 'Prosa (1)', 'Versi (1)']);
  await page.selectOption('#facets select[name=author]', 'B. Verdi');
  await page.waitForFunction(() => document.querySelectorAll('#results li').length === 1);
  assert.match(await page.textContent('#results li'), /La vela si vede/);
  assert.deepEqual(await violations(page), []);
  const csv = await daemon.get(`/${await page.getAttribute('#table', 'href')}`);
  assert.equal((await csv.text()).match(/^".*","vela",".*","barca:1:p1"/gm).length, 2);
  await page.fill('#q', 'barca');
  await page.waitForFunction(() => document.querySelectorAll('#results li').length === 1);
  assert.equal(await page.inputValue('#facets select[name=author]'), '', 'a new search is not narrowed');
  await page.fill('#q', '');
  await page.waitForSelector('#facets', { state: 'hidden' });
  fs.rmSync(path.join(folder, 'texts/barca.md'));
  await eventually(async () => (await (await daemon.get('/v1/library/search?q=vela')).json()).total === 1, 'the work to be gone');
  await page.close();
});

test('oEmbed: the page links to it, and it returns a frame with the text', async () => {
  const html = await (await daemon.get('/library/mare/1')).text();
  const [, address] = html.match(/type="application\/json\+oembed" href="([^"]+)"/);
  const answer = await fetch(address.replaceAll('&amp;', '&'));
  assert.equal(answer.status, 200);
  const oembed = await answer.json();
  assert.deepEqual([oembed.version, oembed.type, oembed.title], ['1.0', 'rich', 'Il "mare" & la luna']);
  const [, source] = oembed.html.match(/^<iframe src="([^"]+)"/);
  assert.equal(source.replaceAll('&amp;', '&'), `${daemon.url}/library.html?embed&at=mare:1`);
  for (const url of ['library.html?at=mare:2', '/library/mare']) assert.equal((await daemon.get(`/oembed?url=${encodeURIComponent(url)}`)).status, 200, url);
  for (const url of ['', 'https://elsewhere.example/', '/library/nothing/1']) assert.equal((await daemon.get(`/oembed?url=${encodeURIComponent(url)}`)).status, 404, url);
  for (const place of ['/library/nothing', '/library/mare/9']) assert.equal((await daemon.get(place)).status, 404, place);
});

test('requests the text named in the address once, with the page, before its other scripts load', async () => {
  const linked = async (at) => (await daemon.get(`/library.html?at=${at}`)).headers.get('link');
  assert.equal(await linked('mare:1:l2'), '<v1/library/works/mare/sections/1>; rel=preload; as=fetch; crossorigin');
  for (const at of ['', 'mare', 'mare:', 'mare:x', 'mare:1x', 'mare:1%0d%0ax', '<mare>:1', '..%2f:1', `${'a'.repeat(64)}:1`]) assert.equal(await linked(at), null, at);
  const context = await browser.newContext({ viewport: { width: 390, height: 700 }, locale: 'it-IT' }), page = await context.newPage();
  let free;
  await page.route('**/library.js', async (route) => {
    await new Promise((resolve) => (free = resolve));
    await route.continue();
  });
  await page.addInitScript(() => localStorage.setItem('faccia.reading', JSON.stringify({ size: '2', wide: true, contrast: false })));
  await page.goto(`${daemon.url}/library.html?embed&at=mare:1:l2`, { waitUntil: 'commit' });
  await page.waitForSelector('[id="mare:1:l2"]'); // rendered by the server; library.js is delayed
  assert.deepEqual(await page.evaluate(() => [document.body.className, document.querySelector('#passage').className, document.querySelector('#passage').lang, getComputedStyle(document.querySelector('#passage')).fontSize]), ['embed open', 'wide', 'it', '32px']);
  await eventually(() => free, 'library.js to be asked for');
  free();
  await page.waitForSelector('.linked');
  assert.equal(await page.evaluate(() => performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('/sections/1')).length), 1);
  await context.close();
});

test('finds, opens and reads a work; does so again offline, with sound, until it is removed', async () => {
  const context = await browser.newContext({ locale: 'it-IT' });
  const page = await context.newPage();
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(`${daemon.url}/library.html`);
  await page.locator('#q').fill('LUNA');
  await page.click('#results a');
  await page.waitForSelector('[id="mare:1:l1"]');
  await page.waitForFunction(() => !document.querySelector('#keep').hidden); // the service worker is active
  await page.evaluate(() => navigator.serviceWorker.ready);
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
  await page.evaluate(() => void (window.words = []) || document.querySelector('#head').addEventListener('reading', ({ detail }) => window.words.push(detail.text)));
  await page.click('#play');
  await page.waitForFunction(() => window.words.includes('calmo'));
  await page.keyboard.press('Escape');
  await page.reload(); // now the service worker handles requests
  await page.waitForSelector('[id="mare:1:l1"]');
  await page.evaluate(() => document.querySelectorAll('details').forEach((box) => (box.open = true)));
  await page.click('#keep');
  await page.waitForFunction(() => /conservata/.test(document.querySelector('#news').textContent), null, { timeout: 60000 });
  assert.match(await page.textContent('#kept button'), /mare.*MB/);
  await context.setOffline(true);
  await page.reload();
  await page.waitForSelector('[id="mare:1:l1"]');
  await page.waitForFunction(() => document.querySelector('#play').textContent === 'Leggi' && document.querySelector('#kept button'));
  await page.click('#play');
  await page.waitForFunction(() => [...(CSS.highlights.get('library-word') ?? [])].some((range) => range.toString() === 'luna'));
  await page.keyboard.press('Escape');
  await page.evaluate(() => document.querySelectorAll('details').forEach((box) => (box.open = true)));
  await page.click('#kept button');
  await page.waitForFunction(() => document.querySelector('#offline').hidden);
  assert.deepEqual(problems, []);
  await context.close();
});

test('plays a recording at the selected speed: 1 and 1.5', async () => {
  const page = await browser.newPage({ locale: 'it-IT', serviceWorkers: 'block', reducedMotion: 'reduce' });
  await page.goto(`${daemon.url}/library.html?at=zitto:1`);
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
  await page.waitForFunction(() => document.querySelector('#voice option[value^="recording"]') && document.querySelector('#voice').options.length > 3);
  await page.evaluate(() => {
    window.ends = [];
    document.querySelector('#head').addEventListener('end', ({ detail }) => window.ends.push(detail));
    document.querySelectorAll('details').forEach((box) => (box.open = true));
  });
  await page.selectOption('#voice', 'recording');
  const { voices } = await (await daemon.get('/v1/voices')).json(), own = voices.find(({ id }) => id === 'recording:zitto').words_per_minute;
  const heard = async (speed) => {
    await page.fill('#speed', String(speed));
    const ends = await page.evaluate(() => window.ends.length);
    await page.click('#play');
    await page.waitForFunction((n) => window.ends.length > n, ends, { timeout: 60000 });
    const { reason, duration } = await page.evaluate(() => window.ends.at(-1));
    assert.equal(reason, 'done');
    return { duration, rate: await page.getAttribute('#head', 'rate') };
  };
  const usual = await heard(1), faster = await heard(1.5);
  assert.deepEqual([usual.rate, faster.rate], [null, String(Math.round(own * 1.5))]);
  assert.ok(Math.abs(usual.duration / faster.duration / 1.5 - 1) < 0.05, `${usual.duration}, ${faster.duration} s`); // the final pause is not scaled
  await page.close();
});
