// SPDX-License-Identifier: GPL-3.0-or-later
// The markup editor in a browser: marks words by keyboard, plays them, writes three markups that the daemon reads, saves and reopens; and turns
// a stretch of the Face Player into a gesture.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon, eventually, root } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-editor-'));
let daemon, browser;
before(async () => {
  for (const name of ['works', 'gestures']) fs.mkdirSync(path.join(folder, name));
  daemon = await Daemon.start(['--editing', '--library', path.join(folder, 'works'), '--library-index', path.join(folder, 'index'), '--gestures', path.join(folder, 'gestures')]);
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

async function open(name) {
  const page = await browser.newPage({ viewport: { width: 1300, height: 950 }, locale: 'it-IT', acceptDownloads: true });
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
  await page.goto(`${daemon.url}/${name}`);
  await page.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open');
  return { page, problems };
}

test('marks words, plays them, writes three markups, validates, saves and reopens', async () => {
  const { page, problems } = await open('editor.html');
  await page.waitForFunction(() => document.querySelectorAll('#value option').length > 20);
  assert.equal(await page.isVisible('#marks-title'), false, 'no heading over no marks');
  const text = await page.inputValue('#text');
  const select = (words) =>
    page.evaluate(([from, to]) => (document.querySelector('#text').focus(), document.querySelector('#text').setSelectionRange(from, to)), [text.indexOf(words), text.indexOf(words) + words.length]);
  const put = async (words, kind, value) => {
    await select(words);
    await page.selectOption('#kind', kind);
    if (value) await page.selectOption('#value', value);
    await page.focus('#mark button');
    await page.keyboard.press('Enter');
  };
  await page.evaluate(() => document.querySelector('#head').addEventListener('begin', () => (document.body.dataset.begun = Number(document.body.dataset.begun ?? 0) + 1)));
  await put('bella', 'affect', 'joy');
  await page.waitForFunction(() => Number(document.body.dataset.begun) >= 1); // plays at once
  await page.uncheck('#at-once');
  await put('sorpresa', 'emphasis', 'strong');
  await put('Che', 'gesture', 'wink');
  await put('aspettavo', 'gaze', 'left');
  await put('davvero', 'pause', '300');
  await page.waitForFunction(() => document.querySelectorAll('#marks li').length === 5);
  for (const [markup, pattern] of [['ssml', /<faccia:gesture name="wink"\/>/], ['apml', /<rheme affect="joy">bella/], ['jsml', /<HAPPY>bella<\/HAPPY>/]]) {
    await page.selectOption('#markup', markup);
    assert.match(await page.inputValue('#code'), pattern);
    await page.waitForFunction(() => document.querySelector('#verdict').textContent === 'Il server capisce tutto.');
  }
  // an answer that comes after a change says nothing
  let asked = 0, release;
  const held = new Promise((resolve) => (release = resolve));
  await page.route('**/v1/speech', async (route) => {
    if (++asked === 1) await held;
    await route.continue().catch(() => {}); // the page may have given it up
  });
  await page.selectOption('#markup', 'apml');
  await eventually(() => asked === 1, 'the first question');
  await page.selectOption('#markup', 'jsml');
  release();
  await eventually(() => asked === 2, 'the second question');
  await page.waitForFunction(() => document.querySelector('#verdict').textContent !== '');
  assert.equal(await page.textContent('#verdict'), 'Il server capisce tutto.');
  await page.unroute('**/v1/speech');
  assert.deepEqual(await violations(page), []);
  await page.screenshot({ path: path.join(artefacts, 'editor.png'), fullPage: true });

  // reports what a markup cannot express; a warning links to its place
  await put('Buongiorno', 'affect', 'shame');
  assert.match(await page.textContent('#verdict'), /JSML non può dire: Affetto vergogna/);
  await page.selectOption('#markup', 'ssml');
  await page.setInputFiles('#file', { name: 'mio.ssml', mimeType: 'text/plain', buffer: Buffer.from('<speak xml:lang="it">Ciao <faccia:gesture name="winc"/>mamma <sub alias="x">bella</sub>.</speak>') });
  await page.waitForSelector('#warnings button');
  assert.match(await page.textContent('#news'), /sub/);
  assert.match(await page.textContent('#warnings'), /winc.*near: wink/);
  await page.focus('#warnings button');
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate(() => document.querySelector('#code').value.slice(document.querySelector('#code').selectionStart, document.querySelector('#code').selectionEnd)), '<faccia:gesture name="winc"/>');

  // removes a mark by keyboard, edits the text, saves and reopens the result
  await page.focus('#marks button');
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('#marks li').count(), 0);
  await page.fill('#text', 'Ciao mamma bella.');
  await page.evaluate(() => (document.querySelector('#text').focus(), document.querySelector('#text').setSelectionRange(5, 10)));
  await page.selectOption('#kind', 'emphasis');
  await page.click('#mark button');
  const written = await page.inputValue('#code');
  assert.match(written, /Ciao <emphasis level="strong">mamma<\/emphasis> bella\./);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
  assert.equal(download.suggestedFilename(), 'mio.ssml');
  await page.setInputFiles('#file', { name: 'mio.ssml', mimeType: 'text/plain', buffer: fs.readFileSync(await download.path()) });
  await page.waitForFunction(() => document.querySelector('#marks').textContent.includes('mamma'));
  assert.equal(await page.inputValue('#code'), written);

  // saves to the library and loads from it; concurrent changes by others are not overwritten
  const file = path.join(folder, 'works/saluto.ssml');
  const said = (pattern, box = '#news') => page.waitForFunction(([source, at]) => new RegExp(source).test(document.querySelector(at).textContent), [pattern.source, box]);
  await page.fill('#work-name', 'saluto');
  await page.click('#works [type=submit]');
  await said(/saluto\.ssml è nella biblioteca/);
  assert.equal(fs.readFileSync(file, 'utf8'), written);
  fs.writeFileSync(file, '<speak xml:lang="it">Di un altro.</speak>');
  await page.click('#works [type=submit]');
  await said(/cambiato nel frattempo/, '#problem');
  assert.match(fs.readFileSync(file, 'utf8'), /Di un altro/);
  await page.click('#work-open');
  await page.waitForFunction(() => document.querySelector('#text').value === 'Di un altro.');
  await page.fill('#text', 'Di tutti e due.');
  await page.click('#works [type=submit]');
  await said(/nella biblioteca/);
  assert.match(fs.readFileSync(file, 'utf8'), /Di tutti e due/);
  await page.screenshot({ path: path.join(artefacts, 'editor-works.png') });
  assert.deepEqual(problems.splice(0).filter((problem) => !problem.includes('412')), []);

  const begun = await page.evaluate(() => Number(document.body.dataset.begun));
  await page.focus('#text');
  await page.keyboard.press('Control+Enter');
  await page.waitForFunction((n) => Number(document.body.dataset.begun) > n, begun);
  assert.deepEqual(problems, []);
  await page.close();
});

test('turns a selection of the Face Player into a gesture that matches the schema', async () => {
  const { page, problems } = await open('player.html');
  await page.click('#open button');
  await page.waitForSelector('[data-plot="curves"]');
  const at = (frame) => page.evaluate((k) => ((document.querySelector('#scrub').value = k), document.querySelector('#scrub').dispatchEvent(new Event('input'))), frame);
  await at(5);
  await page.click('#gesture-box summary');
  await page.click('#stretch-from');
  await at(20);
  await page.click('#stretch-to');
  await page.fill('#gesture-name', 'il-mio');
  await page.check('#gesture-groups input[value="2"]');
  assert.deepEqual(await violations(page), []);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#gesture-save')]);
  assert.equal(download.suggestedFilename(), 'il-mio.json');
  const made = JSON.parse(fs.readFileSync(await download.path()));
  await page.click('#gesture-keep');
  await page.waitForFunction(() => /sul server/.test(document.querySelector('#news').textContent));
  assert.deepEqual(JSON.parse(fs.readFileSync(path.join(folder, 'gestures/il-mio.json'))), made);
  const validate = new Ajv({ strict: false }).compile(JSON.parse(fs.readFileSync(path.join(root, 'models/gestures.schema.json'))));
  assert.ok(validate(made), JSON.stringify(validate.errors));
  assert.equal(made.name, 'il-mio');
  assert.ok(Object.values(made.curves).every((curve) => curve.length === 16) && made.curves.open_jaw.some(Boolean));
  await page.fill('#gesture-name', 'Non Va/bene');
  assert.equal(await page.evaluate(() => document.querySelector('#gesture-name').checkValidity()), false);
  assert.deepEqual(problems, []);
  await page.close();
});
