// SPDX-License-Identifier: GPL-3.0-or-later
// Pronunciations corrected in the editor and on the library's page: previewed, saved with the work or the library, downloaded; reports.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon, eventually } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-sayings-'));
const [works, reports] = ['works', 'reports'].map((name) => path.join(folder, name));
let daemon, browser;
before(async () => {
  for (const each of [works, reports]) fs.mkdirSync(each);
  fs.writeFileSync(path.join(works, 'mare.txt'), 'Ecco Bowie sul mare.\n\nPoi tace.\n');
  daemon = await Daemon.start(['--editing', '--library', works, '--library-index', path.join(folder, 'index'), '--reports', reports]);
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

async function open(address, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1300, height: 1000 }, locale: 'it-IT', acceptDownloads: true, serviceWorkers: 'block', reducedMotion: 'reduce', ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.goto(`${daemon.url}/${address}`);
  await page.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open');
  return page;
}
const read = (name) => fs.readFileSync(path.join(works, name), 'utf8');
const spoken = async (query) => (await (await daemon.get(`/v1/speech?${new URLSearchParams({ format: 'json', lang: 'it', ...query })}`)).json()).phones.map(({ ipa }) => ipa).join('');
const says = (page, pattern) => page.waitForFunction((source) => new RegExp(source).test(document.querySelector('#saying-news').textContent), pattern.source);

test('the library previews a selected word, saves it with its work, and reads it so afterwards', async () => {
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).works.length, 'the work');
  const page = await open('library.html#mare:1');
  await page.waitForSelector('[data-passage]');
  await page.click('#sayings > summary');
  await page.waitForFunction(() => document.querySelector('#saying-place').options.length === 3);
  assert.deepEqual(await page.locator('#saying-place option').allTextContents(), ['in quest’opera', 'in tutta la biblioteca', 'in un file da scaricare']);
  await page.evaluate(() => {
    document.activeElement.blur();
    const node = document.createTreeWalker(document.querySelector('[data-passage]'), NodeFilter.SHOW_TEXT).nextNode();
    const at = node.data.indexOf('Bowie');
    getSelection().setBaseAndExtent(node, at, node, at + 5);
  });
  await page.waitForFunction(() => document.querySelector('#saying-word').value === 'Bowie');
  const asked = await page.evaluate(() => {
    const { head } = { head: document.querySelector('#head') };
    window.asked = [];
    const { speak } = head;
    head.speak = (text, options) => (window.asked.push([text, options]), speak.call(head, text, options));
  });
  assert.equal(asked, undefined);
  await page.click('#saying button[type=submit]');
  await says(page, /Scrivi come si dice/);
  await page.fill('#saying-said', 'bobo & co');
  await page.click('#saying .row:nth-of-type(1) button');
  await page.waitForFunction(() => window.asked.length === 1);
  const [[text, { lexicon, lang }]] = await page.evaluate(() => window.asked);
  assert.deepEqual([text, lang], ['Bowie', 'it']);
  assert.match(lexicon, /<grapheme>Bowie<\/grapheme><alias>bobo &amp; co<\/alias>/);
  assert.deepEqual(await violations(page), []);
  await page.screenshot({ path: path.join(artefacts, 'sayings-library.png'), fullPage: true });
  await page.fill('#saying-said', 'bobo');
  await page.click('#saying button[type=submit]');
  await says(page, /«Bowie» si pronuncia così da adesso: mare\.pls/);
  assert.match(read('mare.pls'), /xml:lang="it">\s*<lexeme><grapheme>Bowie<\/grapheme><alias>bobo<\/alias><\/lexeme>/);
  await eventually(async () => (await spoken({ passage: 'mare:1:p1' })) === (await spoken({ text: 'Ecco bobo sul mare.' })), 'the corrected word');
  // the page itself reads the work with its lexicon
  await page.evaluate(() => (window.asked.length = 0, document.querySelector('#play').click()));
  await page.waitForFunction(() => document.querySelector('#head').debug().connection === 'open');
  // a second word joins the first, which can be corrected again
  for (const [word, said] of [['mare', 'oceano'], ['Bowie', 'bibi']]) {
    await page.fill('#saying-word', word);
    await page.fill('#saying-said', said);
    await page.click('#saying button[type=submit]');
    await says(page, new RegExp(`«${word}» si pronuncia`));
  }
  assert.deepEqual([...read('mare.pls').matchAll(/<grapheme>(.*?)<\/grapheme><alias>(.*?)<\/alias>/g)].map(([, ...pair]) => pair), [['mare', 'oceano'], ['Bowie', 'bibi']]);
  // phones, for the whole library; invalid phones are refused with a reason
  await page.selectOption('#saying-way', 'ipa');
  await page.selectOption('#saying-place', 'inLibrary');
  await page.fill('#saying-said', '5%');
  await page.click('#saying button[type=submit]');
  await says(page, /Così non si può dire: .*IPA/);
  await page.fill('#saying-said', 'ˈbobo');
  await page.click('#saying button[type=submit]');
  await says(page, /lexicon\.pls/);
  assert.match(read('lexicon.pls'), /<phoneme>ˈbobo<\/phoneme>/);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('a reader reports a misread word; the editor sees and corrects or dismisses it', async () => {
  const page = await open('library.html#mare:1', { locale: 'en-GB' });
  await page.waitForSelector('[data-passage]');
  await page.click('#sayings > summary');
  const report = async (word) => {
    await page.fill('#saying-word', word);
    await page.fill('#saying-said', '');
    await page.click('#saying .row:nth-of-type(2) button[type=button]');
    await says(page, /Thank you/);
  };
  await report('tace');
  await report('Ecco');
  await page.waitForFunction(() => document.querySelectorAll('#saying-reports li').length === 2);
  assert.deepEqual(await violations(page), []);
  await page.screenshot({ path: path.join(artefacts, 'sayings-reports.png'), fullPage: true });
  await page.click('#saying-reports button:text-is("Correct “tace”")');
  assert.equal(await page.inputValue('#saying-word'), 'tace');
  await page.fill('#saying-said', 'ride');
  await page.click('#saying button[type=submit]');
  await page.waitForFunction(() => document.querySelectorAll('#saying-reports li').length === 1);
  assert.match(read('mare.pls'), /<grapheme>tace<\/grapheme><alias>ride<\/alias>/);
  await page.click('#saying-reports button[aria-label="Dismiss the report of “Ecco”"]');
  await page.waitForFunction(() => document.querySelector('#saying-reports').textContent === 'Nothing has been reported.');
  assert.deepEqual(fs.readdirSync(reports).filter((name) => name.endsWith('.json')), []);
  for (const [lang, shown] of [['pt', 'Pronúncia de uma palavra'], ['tr', 'Bir sözcüğün söylenişi'], ['it', 'Pronuncia di una parola']]) {
    await page.selectOption('#page-lang', lang);
    assert.equal(await page.textContent('#sayings > summary'), shown);
  }
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('the editor takes the selected word, and offers a file to download without the right to save', async () => {
  const page = await open('editor.html');
  await page.fill('#text', 'Oggi canta Bowie, forse.');
  await page.evaluate(() => {
    const text = document.querySelector('#text');
    text.focus();
    text.setSelectionRange(11, 16);
  });
  await page.click('#sayings > summary');
  assert.equal(await page.inputValue('#saying-word'), 'Bowie');
  await page.waitForFunction(() => document.querySelector('#saying-place').options.length > 1);
  await page.screenshot({ path: path.join(artefacts, 'sayings-editor.png'), fullPage: true });
  assert.deepEqual(await violations(page), []);
  await page.fill('#saying-said', 'Bò-ui');
  await page.selectOption('#saying-place', 'inFile');
  const download = page.waitForEvent('download');
  await page.click('#saying button[type=submit]');
  const file = fs.readFileSync(await (await download).path(), 'utf8');
  assert.match(file, /xml:lang="it">\s*<lexeme><grapheme>Bowie<\/grapheme><alias>Bò-ui<\/alias>/);
  assert.deepEqual(page.problems, []);
  await page.close();
  const plain = await Daemon.start([]);
  const other = await browser.newPage({ locale: 'it-IT' });
  await other.goto(`${plain.url}/editor.html`);
  await other.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open');
  await other.click('#sayings > summary');
  await other.waitForFunction(() => document.querySelector('#saying-place').options.length === 1);
  assert.equal(await other.inputValue('#saying-place'), 'inFile');
  await other.fill('#saying-word', 'Bowie');
  await other.click('#saying .row:nth-of-type(2) button[type=button]');
  await says(other, /non si raccolgono/);
  await other.close();
  assert.equal((await plain.stop()).code, 0);
});
