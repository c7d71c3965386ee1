// SPDX-License-Identifier: GPL-3.0-or-later
// The operator's desk together with a room's face: speech, choices and answers, and reconnecting to a daemon.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon, eventually } from '../../lib/daemon.mjs';
import { liveIn } from '../../lib/hours.mjs';

let daemon, browser, desk, kiosk;
const problems = [];
const scenes = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-scenes-'));
const open = async (address, options) => {
  const page = await browser.newPage({ locale: 'it-IT', reducedMotion: 'no-preference', ...options });
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(`${daemon.url}/${address}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 120000 });
  return page;
};
/** Waits until the room's page is in that state, or was since the last call, because a busy machine may miss a short sentence. */
const state = async (name) => {
  await kiosk.waitForFunction((wanted) => document.body.dataset.state === wanted || (wanted === 'speaking' && window.states.includes(wanted)), name, { timeout: 120000 });
  await kiosk.evaluate(() => (window.states.length = 0));
};
before(async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  fs.mkdirSync(scenes, { recursive: true });
  daemon = await Daemon.start(['--scenes', scenes]);
  browser = await launch({ webgl: false, forced: true, whole: true });
  kiosk = await open('room.html?room=cucina&clock', { viewport: { width: 1024, height: 768 } });
  await kiosk.evaluate(() => {
    window.states = [];
    new MutationObserver(() => window.states.push(document.body.dataset.state)).observe(document.body, { attributeFilter: ['data-state'] });
  });
  desk = await open('operator.html?room=cucina&name=Anna', { viewport: { width: 1280, height: 1000 } });
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(scenes, { recursive: true });
});

/** Has the page save its log. */
async function saveLog(page) {
  await page.evaluate(() => (document.querySelector('details:has(#csv)').open = true));
  await page.click('#csv');
}

test('the face of the room speaks the operator’s text', async () => {
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
  // repeats, because a page on a busy machine may miss the whole sentence
  const again = () => daemon.get('/v1/say?room=cucina&lang=it&mode=quiet', { method: 'POST', body: 'La mamma parla, la mamma apre la bocca.' });
  await eventually(async () => (await kiosk.evaluate(() => window.opened)) > 100 || void (await again()), 'lips that move');
  await daemon.get('/v1/stop?room=cucina', { method: 'POST' });
  await state('idle');
  // word by word, and complete after the end event
  await desk.waitForFunction(() => document.querySelector('#said .sentence span').textContent === 'La cena è pronta, mamma.');
  const here = (page, text) => page.waitForFunction((wanted) => document.querySelector('#listeners').textContent === wanted, text);
  await here(desk, 'Nella stanza: 1');
  // a desk does not count as a listener, and lists other desks
  const other = await browser.newPage({ locale: 'it-IT' });
  await other.goto(`${daemon.url}/operator.html?room=cucina&name=Bruno`);
  await here(desk, 'Nella stanza: 1 · Altri che operano: Bruno');
  await here(other, 'Nella stanza: 1 · Altri che operano: Anna');
  await other.close();
  await here(desk, 'Nella stanza: 1');
});

test('a prepared line offers its answers, and the selected one leads to the next line', async () => {
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

test('answers free questions by key, shows states, and stops at a touch', async () => {
  await desk.fill('#choices', 'Tè o caffè? | Tè | Caffè');
  await desk.click('#offer');
  await kiosk.waitForFunction(() => document.querySelector('#question .what').textContent === 'Tè o caffè?');
  await kiosk.keyboard.press('2');
  await desk.waitForFunction(() => [...document.querySelectorAll('#said .chosen span')].at(-1).textContent === 'Caffè');
  await desk.click('#manner summary');
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

test('dims the screen without people, until someone arrives or something is spoken', async () => {
  const tell = (name) => daemon.get('/v1/rooms/cucina/commands', { method: 'POST', body: JSON.stringify({ type: 'state', state: name }) });
  const dark = (wanted) => kiosk.waitForFunction((is) => document.querySelector('#asleep').hidden !== is && document.querySelector('talking-head').hidden === is, wanted);
  await tell('asleep');
  await dark(true);
  await tell('idle');
  await dark(false);
  await tell('asleep');
  await dark(true);
  await daemon.get('/v1/say?room=cucina&lang=it', { method: 'POST', body: 'Buongiorno.' });
  await dark(false);
  await tell('idle');
  await state('idle');
});

test('edits queued lines, and speaks them in order', async () => {
  const head = (act) => desk.evaluate((name) => document.querySelector('talking-head')[name](), act);
  await desk.fill('#text', 'La prima frase, che dura un poco di più delle altre.');
  await desk.click('#speak');
  await head('pause'); // however slow the machine is
  for (const each of ['Uno.', 'Due.', 'Tre.']) {
    await desk.fill('#text', each);
    await desk.click('#later');
  }
  await desk.click('#queue li:nth-child(3) button:nth-of-type(1)'); // Tre before Due
  await desk.fill('#queue li:nth-child(1) input', 'Quattro.');
  await desk.click('#queue li:nth-child(3) button:nth-of-type(3)'); // removes Due
  await head('resume');
  await desk.waitForFunction(() => [...document.querySelectorAll('#said .sentence span')].at(-1).textContent === 'Tre.', null, { timeout: 60000 });
  const said = await desk.$$eval('#said .sentence span', (all) => all.map((each) => each.textContent));
  assert.deepEqual(said.slice(-2), ['Quattro.', 'Tre.']);
  assert.equal(await desk.$$eval('#queue li', (all) => all.length), 0);
});

test('rejects a scene with an error and shows its position; the log is a table', async () => {
  await desk.click('details:has(#source) summary');
  await desk.fill('#source', '{"lines":[{"id":"1","text":"Ciao","next":"9"}]}');
  await desk.click('#take');
  assert.match(await desk.textContent('#problem'), /lines\.0\.next/);
  await desk.fill('#source', 'id,text,mood\n1,"Ciao, cara",joy 0.6\n');
  await desk.click('#take');
  assert.deepEqual(await desk.$$eval('#lines button', (all) => all.map((each) => each.textContent)), ['1Ciao, cara']);
  const [download] = await Promise.all([desk.waitForEvent('download'), saveLog(desk)]);
  const table = fs.readFileSync(await download.path(), 'utf8');
  assert.match(table, /^time,what,text,by,id\r\n/);
  assert.match(table, /,sentence,[^\r\n]*,Anna,Anna-1\r\n/);
  assert.match(table, /,chosen,Non tanto,[\w-]+,line-1\r\n/);
});

test('two operator pages keep scenes on the server without overwriting each other’s', async () => {
  const news = (page, text) => page.waitForFunction((wanted) => document.querySelector('#news').textContent === wanted, text);
  const other = await open('operator.html?room=cucina');
  const lines = (page) => page.$$eval('#lines button', (all) => all.map((each) => each.textContent));
  const write = async (page, source) => {
    await page.evaluate((text) => {
      document.querySelector('details:has(#source)').open = true;
      document.querySelector('#source').value = text;
    }, source);
    await page.click('#take');
  };
  for (const page of [desk, other]) {
    await page.click('#store summary');
    await page.fill('#scene-name', 'pranzo');
  }
  await desk.click('#keep-scene');
  await news(desk, 'La scena è sul server.');
  await other.click('#fetch-scene');
  await news(other, 'La scena è in uso.');
  assert.deepEqual(await lines(other), ['1Ciao, cara']);
  await write(other, 'text\nBuon appetito.\n');
  await other.click('#keep-scene');
  await news(other, 'La scena è sul server.');
  await write(desk, 'text\nA tavola!\n');
  await desk.click('#keep-scene');
  await desk.waitForFunction(() => document.querySelector('#problem').textContent.startsWith('Qualcun altro l’ha cambiato'));
  assert.equal(JSON.parse(fs.readFileSync(path.join(scenes, 'pranzo.json'))).lines[0].text, 'Buon appetito.');
  await desk.click('#fetch-scene');
  await desk.waitForFunction(() => document.querySelector('#lines button').textContent === '1Buon appetito.');
  await desk.click('#drop-scene');
  await news(desk, 'La scena è stata cancellata.');
  assert.deepEqual(fs.readdirSync(scenes), []);
  await other.close();
});

test('a server without a folder for scenes: no request fails before they are asked for, and the page says what to do', async () => {
  const bare = await Daemon.start([], {}, { voices: false });
  const page = await browser.newPage({ locale: 'it-IT' });
  const failed = [];
  page.on('response', (answer) => answer.ok() || failed.push(new URL(answer.url()).pathname));
  await page.goto(`${bare.url}/operator.html?room=cucina`);
  await page.waitForFunction(() => document.querySelector('#kiosk').hidden === false && document.querySelector('talking-head').debug?.().connection === 'open');
  assert.deepEqual(failed, []);
  await page.waitForFunction(() => document.querySelector('#listeners').textContent.startsWith('Nella stanza non c’è ancora nessuno.'));
  await page.click('#store summary');
  await page.waitForSelector('#no-scenes');
  assert.equal(await page.isVisible('#stored'), false);
  assert.deepEqual(failed, ['/v1/scenes']);
  await page.close();
  assert.equal((await bare.stop()).code, 0);
});

test('two operators at once: everything is spoken once, and both see who sent it', async () => {
  const other = await open('operator.html?room=cucina&name=Bruno');
  const told = async (page) => (await page.$$eval('#said .sentence span', (all) => all.map((each) => each.textContent))).filter((text) => /^(Anna|Bruno) dice/.test(text)).sort();
  for (const [page, name] of [[desk, 'Anna'], [other, 'Bruno']]) await page.fill('#text', `${name} dice la prima.`);
  await Promise.all([desk, other].map((page) => page.click('#speak')));
  for (const [page, name] of [[desk, 'Anna'], [other, 'Bruno']]) await page.fill('#text', `${name} dice la seconda.`);
  await Promise.all([desk, other].map((page) => page.click('#speak')));
  const all = ['Anna dice la prima.', 'Anna dice la seconda.', 'Bruno dice la prima.', 'Bruno dice la seconda.'];
  for (const page of [desk, other]) await eventually(async () => JSON.stringify(await told(page)) === JSON.stringify(all), 'four sentences, each once');
  const [download] = await Promise.all([other.waitForEvent('download'), saveLog(other)]);
  const table = fs.readFileSync(await download.path(), 'utf8');
  for (const name of ['Anna', 'Bruno']) assert.equal([...table.matchAll(new RegExp(`,sentence,[^\\r\\n]*,${name},${name}-\\d+\\r\\n`, 'g'))].length, 2, table);
  await other.close();
});

test('a dragged mood appears on the face and on another operator page', async () => {
  const other = await open('operator.html?room=cucina&name=Bruno');
  await desk.waitForSelector('#affects g', { state: 'attached' });
  const mix = (page, text) => page.waitForFunction((wanted) => document.querySelector('#mix').textContent === wanted, text);
  for (const page of [desk, other]) await page.click('#mood-box summary');
  await desk.locator('#disc').scrollIntoViewIfNeeded();
  const { x, y, width, height } = await desk.locator('#disc .rim').boundingBox();
  const joy = await desk.evaluate(() => {
    const rim = document.querySelector('#disc .rim').getBoundingClientRect(), dot = document.querySelector('#affects [data-name="joy"] circle').getBoundingClientRect();
    return [dot.x + dot.width / 2 - rim.x - rim.width / 2, dot.y + dot.height / 2 - rim.y - rim.height / 2];
  });
  const to = (share) => desk.mouse.move(x + width / 2 + share * joy[0], y + height / 2 + share * joy[1]);
  await to(0.1);
  await desk.mouse.down();
  for (let share = 0.2; share < 0.85; share += 0.1) await to(share);
  await desk.mouse.up();
  await desk.waitForFunction(() => /^gioia [78]\d %/.test(document.querySelector('#mix').textContent));
  const dragged = await desk.textContent('#mix');
  await mix(other, dragged);
  await kiosk.waitForFunction(() => Object.entries(document.querySelector('talking-head').faps).some(([fap, value]) => [12, 13].includes(Number(fap)) && Math.abs(value) > 30));
  await other.focus('#thumb');
  await other.keyboard.press('Home');
  await mix(other, 'neutro');
  await mix(desk, 'neutro');
  const [download] = await Promise.all([desk.waitForEvent('download'), saveLog(desk)]);
  assert.match(fs.readFileSync(await download.path(), 'utf8'), /,mood,neutro,Bruno,\r\n/);
  await other.close();
});

test('a study asks for consent; after a refusal it stores nothing of the listener, and consent can be withdrawn', async () => {
  const log = async () => {
    const [download] = await Promise.all([desk.waitForEvent('download'), saveLog(desk)]);
    return fs.readFileSync(await download.path(), 'utf8');
  };
  const stands = (name) => desk.waitForFunction((wanted) => document.querySelector('#consent').dataset.consent === wanted, name);
  const answered = async (answer) => {
    await desk.fill('#choices', `Come va? | ${answer} | Altro`);
    await desk.click('#offer');
    await kiosk.waitForSelector('.answers button:text-is("Altro"):visible');
    await kiosk.click('#question .answers button:nth-child(1)');
    await desk.waitForFunction((wanted) => [...document.querySelectorAll('#said .chosen span')].at(-1).textContent === wanted, answer);
  };
  await desk.click('details:has(#ask-consent) summary');
  await desk.fill('#consent-text', 'Annotiamo le risposte, per una tesi.');
  await desk.click('#ask-consent');
  await kiosk.waitForSelector('#consent:focus');
  assert.equal(await kiosk.textContent('#consent-what'), 'Annotiamo le risposte, per una tesi.');
  for (const size of [{ width: 390, height: 760 }, { width: 1024, height: 600 }, { width: 1024, height: 768 }]) {
    await kiosk.setViewportSize(size);
    await kiosk.screenshot({ path: path.join(artefacts, `consent-${size.height}.png`) });
    for (const box of await Promise.all((await kiosk.$$('#consent button')).map((each) => each.boundingBox())))
      assert.ok(box.height >= 79 && box.width >= 200 && box.y + box.height <= size.height, `${JSON.stringify([box, size])}`);
  }
  assert.deepEqual(await violations(kiosk), []);
  await stands('asked');
  assert.doesNotMatch(await log(), /,chosen,/); // from earlier
  await kiosk.keyboard.press('2');
  await stands('declined');
  await answered('Malissimo');
  assert.doesNotMatch(await log(), /chosen|Malissimo,(?!.*,chose)/);
  await desk.click('#end-study');
  await stands('none');
  await desk.click('#ask-consent');
  await kiosk.click('#consent-yes');
  await stands('given');
  await answered('Benone');
  assert.match(await log(), /,consent,[^\r\n]*\r\n[^]*,chosen,Benone,/);
  await kiosk.screenshot({ path: path.join(artefacts, 'consent-given.png') });
  await desk.screenshot({ path: path.join(artefacts, 'operator-study.png'), fullPage: true });
  await kiosk.click('#consent-stop');
  await stands('declined');
  await kiosk.waitForFunction(() => document.querySelector('#news').textContent === 'Va bene: di lei non si annota nulla.');
  const left = await log();
  assert.doesNotMatch(left, /,chosen,/);
  assert.match(left, /,consent,Negato[^\r\n]*\r\n[^]*,consent,Dato[^\r\n]*\r\n[^]*,consent,Negato/);
});

test('axe finds no violation on either page, and neither scrolls sideways on a phone', async () => {
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

test('hours in a room leak nothing, the picture keeps moving, and the connection recovers', async () => {
  const { samples, places, links, answers, problems: wrong } = await liveIn(browser, daemon, { hours: 4, says: 2 });
  const [first, last] = [samples[0], samples.at(-1)];
  for (const name of ['nodes', 'listeners', 'audio', 'timers']) assert.ok(last[name] <= first[name] + 4, `${name}: ${samples.map((each) => each[name])}`);
  assert.ok(last.heap < 1.15 * first.heap, `bytes: ${samples.map(({ heap }) => heap)}`);
  assert.ok(places.length >= 5, places.join(', ')); // moves, to prevent burn-in
  assert.deepEqual([links, answers, wrong], [5, 4, []]);
});

test('when the daemon disconnects inside a word, the room page says so, reconnects and repeats nothing', async () => {
  const { port } = daemon;
  // long enough that a slow machine gets its begin before its end
  const lost = `Questa frase la sente solo a metà, ${'e continua piano piano ancora per un poco, '.repeat(5)}perché il demone se ne va prima che sia finita, e nessuno la dice di nuovo.`;
  await kiosk.evaluate(() => {
    window.begun = [];
    document.querySelector('talking-head').addEventListener('sentence', ({ detail }) => window.begun.push(detail.text));
  });
  await desk.fill('#text', lost);
  await desk.click('#speak');
  await kiosk.waitForFunction(() => window.begun.length);
  await daemon.stop();
  await state('offline');
  await desk.waitForFunction((text) => [...document.querySelectorAll('#said .refused span')].at(-1)?.textContent === text, lost);
  daemon = await Daemon.start(['--port', String(port)]);
  await state('idle');
  // the desk repeats its request, because the restarted daemon has lost it
  await kiosk.waitForSelector('#consent:focus');
  await desk.waitForFunction(() => document.querySelector('#consent').dataset.consent === 'asked');
  await fetch(`${daemon.url}/v1/say?room=cucina&lang=it`, { method: 'POST', body: 'Eccomi di nuovo.' });
  await state('speaking');
  await state('idle');
  assert.deepEqual(await kiosk.evaluate(() => window.begun), [lost, 'Eccomi di nuovo.']);
  assert.deepEqual(problems, []);
});
