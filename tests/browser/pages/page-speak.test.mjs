// SPDX-License-Identifier: GPL-3.0-or-later
// The first page: the reader's language, links, voices, pause and repeat, the transcript, and errors with advice.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a page, waits until it is ready, and records the head's events in window.heard. */
async function visit(address = '/', options = {}) {
  const page = await browser.newPage({ locale: 'it-IT', ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.addInitScript(() => {
    window.heard = [];
    addEventListener('DOMContentLoaded', () => {
      for (const type of ['begin', 'sentence', 'word', 'paused', 'resumed', 'end', 'error', 'warning'])
        document.querySelector('talking-head').addEventListener(type, ({ detail }) => window.heard.push({ ...detail, type }));
    });
  });
  await page.goto(daemon.url + address);
  await page.waitForFunction(() => !document.querySelector('#voice') || document.querySelector('#voice').options.length > 1);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  return page;
}
const heard = (page, type, count = 1) =>
  page.waitForFunction(([what, n]) => window.heard.filter((each) => each.type === what).length >= n, [type, count], { timeout: 40000 });
const of = (page, type) => page.evaluate((what) => window.heard.filter((each) => each.type === what), type);
const forget = (page) => page.evaluate(() => (window.heard = []));

test('uses the browser’s language for the page and for speech', async () => {
  for (const [locale, word, spoken, page] of [['tr-TR', 'Konuş', 'tr', 'tr'], ['pt-BR', 'Falar', 'pt-BR', 'pt'], ['de-AT', 'Speak', 'de', 'en'], ['en-GB', 'Speak', 'en-GB', 'en']]) {
    for (const name of ['/', '/emotion.html', '/voices.html']) {
      const tab = await visit(name, { locale });
      assert.equal(await tab.getAttribute('html', 'lang'), page, `${name} ${locale}`);
      assert.match(await tab.textContent('nav [aria-current]'), /\p{L}/u);
      if (name === '/') {
        assert.equal(await tab.textContent('#speak'), word);
        const tags = await tab.locator('#lang option').evaluateAll((all) => all.map((each) => each.value));
        assert.equal(await tab.inputValue('#lang'), tags.includes(spoken) ? spoken : page, locale);
        assert.equal(await tab.getAttribute('#text', 'lang'), await tab.inputValue('#lang'));
      }
      assert.equal(await tab.getAttribute('#text', 'dir'), 'auto');
      assert.deepEqual(tab.problems, []);
      await tab.close();
    }
  }
});

test('lists languages by their own names; the selected page language persists', async () => {
  const page = await visit();
  const names = await page.locator('#lang option').allTextContents();
  assert.deepEqual(names.slice(0, 4), ['Italiano', 'Português (Brasil)', 'Türkçe', 'English']);
  const others = await page.locator('#lang optgroup option').allTextContents();
  for (const name of ['Deutsch', 'Español', 'Français', 'Ελληνικά', '日本語']) assert.ok(others.some((each) => each.startsWith(name)), name);
  assert.deepEqual(others, [...others].sort(new Intl.Collator('it').compare));
  await page.selectOption('#page-lang', 'tr');
  assert.equal(await page.textContent('#speak'), 'Konuş');
  assert.equal(await page.inputValue('#lang'), 'it', 'what is spoken stays');
  await page.goto(`${daemon.url}/voices.html`);
  assert.equal(await page.getAttribute('html', 'lang'), 'tr');
  await page.close();
});

test('a link fills the fields, waits for the reader, and can be created from the current choices', async () => {
  const query = { text: 'Günaydın. Nasılsınız?', lang: 'tr', voice: 'espeak:tr+f2', rate: '180', markup: 'plain', room: 'sala-1', captions: 'off' };
  const page = await visit(`/?${new URLSearchParams(query)}`, { permissions: ['clipboard-read', 'clipboard-write'] });
  await page.waitForFunction(() => document.querySelector('#voice').value);
  for (const name of ['text', 'lang', 'voice', 'rate', 'markup', 'room']) assert.equal(await page.inputValue(`#${name}`), query[name], name);
  assert.equal(await page.getAttribute('talking-head', 'room'), 'sala-1');
  assert.equal(await page.getAttribute('talking-head', 'captions'), 'off');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'speak');
  await page.click('#link');
  await page.waitForFunction(() => document.querySelector('#news').textContent);
  assert.deepEqual(Object.fromEntries(new URL(await page.evaluate(() => navigator.clipboard.readText())).searchParams), query);
  assert.deepEqual(await of(page, 'begin'), [], 'nothing is spoken of itself');
  await page.focus('#speak');
  await page.keyboard.press('Enter');
  await heard(page, 'begin');
  assert.equal((await of(page, 'begin'))[0].voice, 'espeak:tr+f2');
  assert.deepEqual(page.problems, []);
  await page.close();
  const odd = await visit('/?text=Ciao.&voice=nobody:it');
  await odd.waitForSelector('#problem .what');
  assert.equal(await odd.textContent('#problem .what'), 'Il server non ha questa voce. Sceglierne un’altra.');
  await odd.close();
});

test('shows and selects the link when the clipboard is not accessible', async () => {
  const page = await visit();
  await page.evaluate(() => Object.defineProperty(navigator, 'clipboard', { value: undefined }));
  await page.fill('#text', 'Ciao.');
  await page.click('#link');
  assert.match(await page.inputValue('#link-field'), /\?text=Ciao\.&lang=it$/);
  assert.ok(await page.evaluate(() => document.activeElement.id === 'link-field' && getSelection().toString().includes('text=Ciao')));
  await page.close();
});

test('lists the voices of the language; the selected one speaks', async () => {
  const page = await visit();
  const { voices } = await (await daemon.get('/v1/voices')).json();
  const ids = () => page.locator('#voice option').evaluateAll((all) => all.map((each) => each.value));
  for (const lang of ['it', 'pt-BR', 'en']) {
    await page.selectOption('#lang', lang);
    const wanted = voices.filter((voice) => voice.lang.split('-')[0] === lang.split('-')[0]).map(({ id }) => id);
    assert.deepEqual((await ids()).slice(1).sort(), wanted.sort(), lang);
    assert.equal((await ids())[0], '', 'and the server’s own choice');
  }
  assert.match(await page.locator('#voice optgroup').first().getAttribute('label'), /^English/);
  await page.selectOption('#lang', 'it');
  await page.selectOption('#voice', 'espeak:it+f2');
  await page.fill('#text', 'Sì.');
  await page.click('#speak');
  await heard(page, 'end');
  assert.equal((await of(page, 'begin'))[0].voice, 'espeak:it+f2');
  await page.close();
});

test('pauses, resumes and repeats; spoken text can be read, replayed, copied and saved', async () => {
  const page = await visit('/', { permissions: ['clipboard-read', 'clipboard-write'], acceptDownloads: true });
  const button = (id) => page.locator(`#${id}`);
  assert.equal(await button('pause').getAttribute('aria-disabled'), 'true');
  // recorded and paused in the page, because a busy machine may be late by some words
  await page.evaluate(() => {
    window.marked = new Set();
    document.querySelector('talking-head').addEventListener('word', ({ detail }) => {
      for (const [i, item] of [...document.querySelectorAll('#said li')].entries())
        for (const { textContent } of item.querySelectorAll('mark:not(:empty)')) window.marked.add(`${i} ${textContent}`);
      if (detail.text === 'canta') document.querySelector('#pause').click();
    });
  });
  const marked = (what) => page.waitForFunction((each) => window.marked.delete(each), what, { timeout: 40000 });
  await page.fill('#text', '<speak>La mamma canta. <emphasis>Il papà</emphasis> ascolta la radio.</speak>');
  await page.click('#speak');
  await heard(page, 'paused');
  assert.equal(await button('pause').textContent(), 'Continua');
  await page.click('#pause');
  await heard(page, 'resumed');
  assert.equal(await button('pause').textContent(), 'Pausa');
  await marked('0 papà');
  await heard(page, 'end');
  const sentences = ['La mamma canta.', 'Il papà ascolta la radio.'];
  const said = () => page.locator('#said button').allTextContents();
  assert.deepEqual(await said(), sentences, 'without its markup');
  assert.equal(await page.locator('#said mark:not(:empty)').count(), 0);
  assert.equal(await page.locator('#said button').first().getAttribute('lang'), 'it');

  await forget(page);
  await page.evaluate(() => window.marked.clear());
  await page.locator('#said button').nth(1).click();
  await marked('0 radio');
  await heard(page, 'end');
  assert.deepEqual((await of(page, 'word')).map(({ text }) => text), ['Il', 'papà', 'ascolta', 'la', 'radio']);
  assert.deepEqual(await said(), sentences, 'it stands there once');

  await page.fill('#text', 'Uno & due.');
  await page.click('#speak');
  await heard(page, 'end', 2);
  await forget(page);
  await page.evaluate(() => window.marked.clear());
  await page.click('#repeat');
  await marked('1 due');
  await heard(page, 'end');
  assert.deepEqual((await of(page, 'word')).map(({ text }) => text).filter((text) => text !== '&'), ['Uno', 'due']);
  const text = `${sentences.join(' ')}\n\nUno & due.`;
  await page.click('#said-copy');
  await page.waitForFunction(() => document.querySelector('#news').textContent === 'Copiato.');
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), text);
  const [file] = await Promise.all([page.waitForEvent('download'), page.click('#said-save')]);
  assert.equal(file.suggestedFilename(), 'faccia.txt');
  assert.equal(fs.readFileSync(await file.path(), 'utf8'), `${text}\n`);
  await page.click('#said-clear');
  assert.deepEqual(await said(), []);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('shows errors in the reader’s language, with their position and a link to it', async () => {
  for (const [locale, what, place] of [
    ['it-IT', /^Nel testo marcato c’è un errore\. Correggerlo/, 'Riga 2, carattere 8.'],
    ['tr-TR', /^Metnin işaretlemesinde bir hata var\. Düzeltin/, 'Satır 2, karakter 8.'],
  ]) {
    const page = await visit('/', { locale });
    await page.fill('#text', '<speak>\n Ciao. </spaek>');
    await page.click('#speak');
    await page.waitForSelector('#problem .place');
    assert.match(await page.textContent('#problem .what'), what);
    const { line, column, message } = (await of(page, 'warning')).find((each) => each.code === 'bad-xml'); // the word is still spoken
    assert.equal(await page.textContent('#problem .place'), place.replace('2', line).replace('8', column));
    assert.equal(await page.textContent('#problem .detail'), message);
    assert.equal(await page.getAttribute('#problem .detail', 'lang'), 'en');
    await page.click('#problem button');
    const { start, focused } = await page.evaluate(() => ({ start: document.activeElement.selectionStart, focused: document.activeElement.id }));
    assert.deepEqual([focused, start], ['text', '<speak>\n'.length + column - 1]);
    assert.equal(line, 2);
    await page.fill('#text', '');
    await page.click('#speak');
    await page.waitForFunction(() => document.querySelector('#problem').textContent && !document.querySelector('#problem .place'));
    assert.deepEqual(page.problems, []);
    await page.close();
  }
  const page = await visit();
  await page.evaluate(() => document.querySelector('talking-head').dispatchEvent(new CustomEvent('error', { detail: { code: 'brand-new', message: 'Something new.', field: 'x' } })));
  assert.equal(await page.textContent('#problem .what'), 'Something new.', 'the server’s words where there are no others');
  assert.equal(await page.textContent('#problem .place'), 'Campo: x.');
  await page.close();
});

test('removes the message about a lost connection on reconnection', async () => {
  const page = await visit();
  await page.fill('#text', 'La mamma canta e il papà ascolta. '.repeat(10));
  await page.click('#speak');
  await heard(page, 'word', 2);
  const { port } = daemon;
  await daemon.stop();
  await page.waitForFunction(() => /connessione si è interrotta|server/.test(document.querySelector('#problem').textContent));
  await page.waitForFunction(() => document.querySelector('#connection').textContent === 'Non connesso, si riprova'); // between two attempts
  daemon = await Daemon.start(['--port', String(port)]);
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open', null, { timeout: 40000 });
  assert.equal(await page.textContent('#problem'), '');
  await page.fill('#text', '<speak></spaek>');
  await page.click('#speak');
  await page.waitForSelector('#problem .what');
  await page.evaluate(() => document.querySelector('talking-head').dispatchEvent(new CustomEvent('connection', { detail: { state: 'open' } })));
  assert.ok(await page.textContent('#problem .what'), 'other errors stay');
  await page.close();
});
