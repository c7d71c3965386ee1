// SPDX-License-Identifier: GPL-3.0-or-later
// The operator's desk and the face of a room, together: what is said, offered and chosen, and a daemon that comes back.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../lib/axe.mjs';
import { launch } from '../lib/browser.mjs';
import { artefacts, Daemon, eventually } from '../lib/daemon.mjs';

let daemon, browser, desk, kiosk;
const problems = [];
const open = async (address, options) => {
  const page = await browser.newPage({ locale: 'it-IT', ...options });
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(`${daemon.url}/${address}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 120000 });
  return page;
};
const state = (name) => kiosk.waitForFunction((wanted) => document.body.dataset.state === wanted, name);
before(async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
  kiosk = await open('room.html?room=cucina&clock', { viewport: { width: 1024, height: 768 } });
  desk = await open('operator.html?room=cucina', { viewport: { width: 1280, height: 1000 } });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('the operator types, and the face of the room says it', async () => {
  await state('idle');
  await kiosk.evaluate(() => {
    window.opened = 0;
    const head = document.querySelector('talking-head');
    setInterval(() => (window.opened = Math.max(window.opened, ...[4, 5].map((fap) => Math.abs(head.faps[fap] ?? 0)))), 20);
  });
  await desk.fill('#text', 'La cena è pronta, mamma.');
  await desk.click('#speak');
  await state('speaking');
  await desk.waitForFunction(() => document.querySelector('#said .sentence span')?.textContent.includes('cena'));
  await state('idle');
  // a page of a busy machine may have missed the whole sentence
  const again = () => daemon.get('/v1/say?room=cucina&lang=it&mode=quiet', { method: 'POST', body: 'La mamma parla, la mamma apre la bocca.' });
  await eventually(async () => (await kiosk.evaluate(() => window.opened)) > 100 || void (await again()), 'lips that move');
  await daemon.get('/v1/stop?room=cucina', { method: 'POST' });
  await state('idle');
  assert.equal(await desk.textContent('#said .sentence span'), 'La cena è pronta, mamma.');
  const here = (page, text) => page.waitForFunction((wanted) => document.querySelector('#listeners').textContent === wanted, text);
  await here(desk, 'Nella stanza: 1');
  // a desk is no listener, and sees others
  const other = await browser.newPage({ locale: 'it-IT' });
  await other.goto(`${daemon.url}/operator.html?room=cucina`);
  await here(desk, 'Nella stanza: 1 · Altri che operano: 1');
  await other.close();
  await here(desk, 'Nella stanza: 1');
});

test('a prepared line offers its answers; what is chosen leads on', async () => {
  await desk.click('#lines button'); // "Come va?": Bene, Non tanto
  await kiosk.waitForSelector('.answers button');
  assert.deepEqual(await kiosk.$$eval('.answers button', (all) => all.map((each) => each.textContent)), ['Bene', 'Non tanto']);
  for (const box of await Promise.all((await kiosk.$$('.answers button')).map((each) => each.boundingBox()))) assert.ok(box.height >= 79 && box.width >= 200);
  await kiosk.screenshot({ path: path.join(artefacts, 'kiosk.png') });
  await kiosk.click('.answers button:nth-child(2)');
  await desk.waitForSelector('#said .chosen');
  assert.equal(await desk.textContent('#said .chosen span'), 'Non tanto');
  assert.equal(await desk.getAttribute('#lines [aria-current="step"]', 'data-id'), '3');
  await kiosk.waitForFunction(() => document.querySelector('#question').hidden && document.querySelector('#news').textContent === 'Risposta: Non tanto');
  await desk.screenshot({ path: path.join(artefacts, 'operator.png'), fullPage: true });
  await state('idle');
});

test('free questions, by key; states are shown; a touch stops her', async () => {
  await desk.fill('#choices', 'Tè o caffè? | Tè | Caffè');
  await desk.click('#offer');
  await kiosk.waitForFunction(() => document.querySelector('#question .what').textContent === 'Tè o caffè?');
  await kiosk.keyboard.press('2');
  await desk.waitForFunction(() => [...document.querySelectorAll('#said .chosen span')].at(-1).textContent === 'Caffè');
  await desk.selectOption('#state', 'listening');
  await state('listening');
  await desk.selectOption('#state', 'idle');
  await desk.fill('#text', 'Questa frase è molto lunga, e qualcuno la ferma con un dito prima che sia finita, perché ha altro da fare.');
  await desk.click('#speak');
  await state('speaking');
  await kiosk.click('#sign');
  await desk.waitForSelector('#said .stopped');
  await state('idle');
});

test('what waits can be changed, and is said in its order', async () => {
  const head = (act) => desk.evaluate((name) => document.querySelector('talking-head')[name](), act);
  await desk.fill('#text', 'La prima frase, che dura un poco di più delle altre.');
  await desk.click('#speak');
  await head('pause'); // however slow this machine is
  for (const each of ['Uno.', 'Due.', 'Tre.']) {
    await desk.fill('#text', each);
    await desk.click('#later');
  }
  await desk.click('#queue li:nth-child(3) button:nth-of-type(1)'); // Tre before Due
  await desk.fill('#queue li:nth-child(1) input', 'Quattro.');
  await desk.click('#queue li:nth-child(3) button:nth-of-type(3)'); // Due is taken away
  await head('resume');
  await desk.waitForFunction(() => [...document.querySelectorAll('#said .sentence span')].at(-1).textContent === 'Tre.', null, { timeout: 60000 });
  const said = await desk.$$eval('#said .sentence span', (all) => all.map((each) => each.textContent));
  assert.deepEqual(said.slice(-2), ['Quattro.', 'Tre.']);
  assert.equal(await desk.$$eval('#queue li', (all) => all.length), 0);
});

test('a scene with an error is refused with its place; the log is a table', async () => {
  await desk.click('details:has(#source) summary');
  await desk.fill('#source', '{"lines":[{"id":"1","text":"Ciao","next":"9"}]}');
  await desk.click('#take');
  assert.match(await desk.textContent('#problem'), /lines\.0\.next/);
  await desk.fill('#source', 'id,text,mood\n1,"Ciao, cara",joy 0.6\n');
  await desk.click('#take');
  assert.deepEqual(await desk.$$eval('#lines button', (all) => all.map((each) => each.textContent)), ['1Ciao, cara']);
  const [download] = await Promise.all([desk.waitForEvent('download'), desk.click('#csv')]);
  const table = fs.readFileSync(await download.path(), 'utf8');
  assert.match(table, /^time,what,text,by,id\r\n/);
  assert.match(table, /,chosen,Non tanto,[\w-]+,line-1\r\n/);
});

test('both pages can be read by all', async () => {
  for (const [page, name] of [[desk, 'operator'], [kiosk, 'kiosk']])
    for (const scheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme: scheme });
      assert.deepEqual(await violations(page), [], `${name}, ${scheme}`);
    }
  await kiosk.setViewportSize({ width: 390, height: 760 });
  await desk.setViewportSize({ width: 390, height: 760 });
  for (const page of [desk, kiosk]) {
    const wide = await page.evaluate(() => {
      const width = document.documentElement.clientWidth;
      return document.documentElement.scrollWidth <= width ? [] : [...document.querySelectorAll('body *')].filter((each) => each.getBoundingClientRect().right > width).map((each) => each.outerHTML.slice(0, 80));
    });
    assert.deepEqual(wide, []);
  }
  await desk.screenshot({ path: path.join(artefacts, 'operator-phone.png'), fullPage: true });
});

test('when the daemon is gone the room’s page says so, and comes back with it', async () => {
  const { port } = daemon;
  await daemon.stop();
  await state('offline');
  daemon = await Daemon.start(['--port', String(port)]);
  await state('idle');
  await fetch(`${daemon.url}/v1/say?room=cucina&lang=it`, { method: 'POST', body: 'Eccomi di nuovo.' });
  await state('speaking');
  await state('idle');
  assert.deepEqual(problems, []);
});
