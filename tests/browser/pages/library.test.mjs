// SPDX-License-Identifier: GPL-3.0-or-later
// The library's page: search, reading, listening, accessibility. Library answers are fakes; speech is real.
import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { answerLibrary, answers, section } from '../../lib/library-answers.mjs';
import { serveModule } from '../../lib/module.mjs';
import { servePages } from '../../lib/page-server.mjs';

let daemon, browser, portal;
before(async () => {
  portal = await servePages({});
  daemon = await Daemon.start(['--embed', portal.url]);
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  await portal?.close();
  assert.equal((await daemon.stop()).code, 0);
});

async function open(place = '', options = {}) {
  const page = await browser.newPage({ viewport: { width: 1100, height: 800 }, locale: 'it-IT', serviceWorkers: 'block', reducedMotion: 'reduce', ...options });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  // a server that stores no files and takes no reports says so with 404 when the form for pronunciations is opened
  const stored = ({ url }) => /\/v1\/library\/(files|reports)$/.test(url);
  page.on('console', (message) => message.type() === 'error' && !stored(message.location()) && page.problems.push(message.text()));
  await answerLibrary(page);
  await page.goto(`${daemon.url}/library.html${place}`);
  return page;
}

async function flawless(page, state) {
  const looks = [['light', {}], ['dark', { colorScheme: 'dark' }, ['color-contrast']], ['forced', { forcedColors: 'active' }, ['color-contrast']]];
  for (const [name, media, rules] of looks) {
    await page.emulateMedia({ colorScheme: 'light', forcedColors: 'none', ...media });
    assert.deepEqual(await violations(page, rules), [], `${state}, ${name}`);
  }
  await page.emulateMedia({ colorScheme: 'light', forcedColors: 'none' });
}

test('searches while typing, opens a passage, marks its words as it plays, and jumps to a clicked word', async () => {
  const page = await open();
  await page.waitForSelector('#works a');
  await flawless(page, 'works');
  await page.locator('#q').pressSequentially('luna');
  await page.waitForSelector('#results mark');
  assert.equal(await page.textContent('#results mark'), 'luna');
  await flawless(page, 'results');
  await page.click('#results li:nth-child(2) a');
  await page.waitForSelector('[id="mare:1:l6"].linked');
  assert.equal(new URL(page.url()).hash, '#mare:1:l6');
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('.verse')].map((verse) => verse.querySelectorAll('.line').length)), [5, 5, 5]);
  assert.equal(await page.textContent('[id="mare:1:p1"] i[lang="en"]'), 'good morning');
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
  await page.evaluate(() => {
    window.read = [];
    document.querySelector('#head').addEventListener('reading', ({ detail }) => window.read.push([detail.text, detail.range.startContainer.parentElement.closest('.line')?.id]));
  });
  await page.click('#play'); // from the linked line
  await page.waitForFunction(() => window.read.length > 2);
  assert.deepEqual((await page.evaluate(() => window.read)).slice(0, 3), [['Il', 'mare:1:l6'], ['mare', 'mare:1:l6'], ['è', 'mare:1:l6']]);
  await page.evaluate(() => document.querySelectorAll('details').forEach((box) => (box.open = true)));
  await page.click('#play');
  await page.waitForFunction(() => document.querySelector('#play').textContent === 'Continua');
  await flawless(page, 'reading');
  const line = page.locator('[id="mare:1:l13"]');
  await line.click({ position: { x: 60, y: 15 } });
  await page.waitForFunction(() => window.read.some(([, id]) => id === 'mare:1:l13'));
  await page.keyboard.press('Escape');
  await page.waitForFunction(() => document.querySelector('#play').textContent === 'Leggi');
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('on a phone the text fills most of the screen and the head is a strip that opens', async () => {
  const page = await open('#mare:1');
  await page.waitForSelector('.verse');
  for (const [width, height] of [[390, 844], [320, 480]]) {
    await page.setViewportSize({ width, height });
    await page.reload();
    await page.waitForSelector('.verse');
    await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
    const seen = () => page.evaluate(() => {
      const [her, face] = ['.her', '#head'].map((name) => document.querySelector(name).getBoundingClientRect());
      return { strip: her.height, face: face.width, across: document.documentElement.scrollWidth, small: [...document.querySelectorAll('.buttons button')].filter((button) => button.getBoundingClientRect().right > innerWidth).length };
    });
    const { strip, face, across, small } = await seen();
    assert.ok(strip <= 145 && face >= 60, `${strip} pixels high, she ${face} wide`);
    assert.deepEqual([across, small], [width, 0], 'nothing is wider than the display');
    await page.click('#face');
    assert.ok((await seen()).face > 0.9 * width, 'she is opened');
  }
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('keyboard shortcuts cover everything and can be switched off; a line repeats; appearance settings persist', async () => {
  const page = await open('#mare:1');
  await page.waitForSelector('.verse');
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
  await page.evaluate(() => {
    window.read = [];
    document.querySelector('#head').addEventListener('reading', ({ detail }) => window.read.push(detail.text));
  });
  await page.mouse.click(500, 5);
  for (let i = 0; i < 2; i++) await page.keyboard.press('l'); // to the heading, then to the first line
  await page.keyboard.press('r');
  await page.evaluate(() => (document.querySelector('#speed').value = 2, document.querySelector('#speed').dispatchEvent(new Event('input'))));
  await page.keyboard.press(' ');
  await page.waitForFunction(() => window.read.filter((word) => word === 'calmo').length === 2, null, { timeout: 60000 });
  assert.equal(await page.evaluate(() => window.read.filter((word) => word === 'scura').length), 0, 'no line further');
  assert.equal(await page.getAttribute('#head', 'rate'), '300');
  await page.keyboard.press('Escape');
  await page.keyboard.press('m');
  assert.equal(await page.getAttribute('#head', 'view'), 'mouth');
  await page.keyboard.press('f');
  assert.ok(await page.evaluate(() => document.body.classList.contains('faceless')));
  await page.evaluate(() => document.querySelectorAll('details').forEach((box) => (box.open = true)));
  await page.check('#spacing');
  await page.check('#contrast');
  await flawless(page, 'contrast');
  await page.uncheck('#keys');
  await page.keyboard.press('m');
  assert.equal(await page.getAttribute('#head', 'view'), 'mouth', 'the key does nothing now');
  await page.reload();
  await page.waitForSelector('#passage.wide');
  assert.ok(await page.evaluate(() => document.documentElement.classList.contains('contrast')));
  await page.close();
});

test('shows alignment in progress and differences between recording and text, and offers another voice', async () => {
  const page = await open();
  await page.waitForSelector('#works a');
  const verses = section.blocks.find(({ id }) => id === 'mare:1:g1'); // a sentence over two lines, including its newlines
  const states = [
    { state: 'waiting' }, { state: 'aligning', share: 0.41 },
    { state: 'aligned', unread: [{ passage: 'mare:1:g1', start: verses.lines[2].start - 1, end: verses.lines[3].end + 1, confidence: 0, time: 6 }, { passage: 'mare:1:p1', start: 0, end: 28, confidence: 0.1, time: 9 }], unwritten: [{ passage: 'mare:1:g2', at: 0, time: 12, seconds: 4.1 }] },
  ];
  let now = 0;
  await page.route('**/v1/library/works/mare/sections/1', (route) => route.fulfill({ json: { ...answers['/v1/library/works/mare/sections/1'](), recording: { voice: 'recording:mare', file: 'mare.wav', ...states[now] } } }));
  await page.clock.install(); // the test controls polling
  await page.evaluate(() => (location.hash = 'mare:1:l9'));
  await page.waitForFunction(() => /attende/.test(document.querySelector('#recording-state').textContent));
  assert.deepEqual(await page.evaluate(() => [...document.querySelector('#voice').options].slice(0, 2).map(({ value }) => value)), ['', 'recording']);
  const place = () => page.evaluate(() => document.getElementById('mare:1:l15').offsetTop);
  const before = await place();
  now = 1;
  await page.clock.runFor(4100);
  await page.waitForFunction(() => document.querySelector('#recording-share').value === 0.41);
  await flawless(page, 'aligning');
  now = 2;
  await page.clock.runFor(4100);
  await page.waitForSelector('.unheard');
  assert.equal(await place(), before, 'the text stays where it is');
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('.unheard:not(.doubtful)')].map((part) => [part.textContent, part.closest('.line').id])), [['[manca nella registrazione] e chi la guarda dalla riva attende', 'mare:1:l3'], ['una parola, e ancora non la sente.', 'mare:1:l4']]);
  assert.equal(await page.textContent('.doubtful'), '[forse manca nella registrazione] Disse ');
  assert.equal(await page.textContent('[id="mare:1:l6"] .unwritten'), '[4 s della registrazione non sono nel testo] ');
  assert.equal(await page.locator('#recording-lacks li').count(), 3);
  assert.equal(await page.locator('#recording-state').textContent(), '');
  await flawless(page, 'differs');
  assert.equal(await page.textContent('#recording-lacks li a'), 'e chi la guarda dalla riva attende una parola, e ancora non …');
  await page.locator('[id="mare:1:l5"]').scrollIntoViewIfNeeded();
  await page.screenshot({ path: path.join(artefacts, 'library-differs.png') });
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
  await page.evaluate(() => (document.querySelector('#more-controls').open = true));
  await page.selectOption('#voice', 'recording');
  await page.evaluate(() => {
    window.said = [];
    const head = document.querySelector('#head');
    for (const type of ['begin', 'sentence']) head.addEventListener(type, ({ detail }) => window.said.push(detail));
  });
  await page.locator('#recording-lacks button').first().click();
  await page.waitForFunction(() => window.said.length > 1);
  assert.match(await page.evaluate(() => window.said.find(({ voice }) => voice).voice), /^(espeak|festival|kokoro):/, 'not the recording');
  await page.waitForFunction(() => document.querySelector('.unheard.now'));
  // the whole passage, with the marks in it
  await page.evaluate(() => document.querySelector('#head').stop());
  await page.waitForFunction(() => !document.querySelector('.unheard.now'));
  await page.selectOption('#voice', '');
  await page.evaluate(() => {
    window.read = [];
    document.querySelector('#head').addEventListener('reading', ({ detail }) => window.read.push(detail.text));
  });
  await page.locator('[id="mare:1:l3"]').click({ position: { x: 60, y: 15 } });
  await page.waitForFunction(() => window.read.length > 3);
  assert.equal((await page.evaluate(() => window.read)).includes('manca'), false);
  await page.keyboard.press('Escape');
  states[2] = { state: 'failed', why: 'nothing of the text is heard' };
  await page.reload();
  await page.waitForFunction(() => /non si può.*nothing of the text is heard/.test(document.querySelector('#recording-state').textContent));
  assert.equal(await page.locator('#voice option[value="recording"]').count(), 0);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('in a frame of another site shows text and head only; a phone shows both', async () => {
  portal.files['/'] = `<!doctype html><html lang="it"><title>Portale</title><body style="margin:0"><iframe allow="autoplay" style="border:0;width:390px;height:700px" src="${daemon.url}/library.html?embed&amp;at=mare:1:l6"></iframe>`;
  const page = await browser.newPage({ viewport: { width: 390, height: 700 }, locale: 'it-IT', serviceWorkers: 'block' });
  await answerLibrary(page);
  await page.goto(portal.url);
  const frame = page.frameLocator('iframe');
  await frame.locator('.linked').waitFor();
  assert.equal(await frame.locator('header').isVisible(), false);
  await frame.locator('#play').click();
  await page.frames()[1].waitForFunction(() => {
    const [range] = CSS.highlights.get('talking-head-word') ?? [];
    const her = document.querySelector('.her').getBoundingClientRect();
    const word = range?.getBoundingClientRect();
    const speaks = document.querySelector('talking-head').debug?.().state === 'speaking'; // the element may not be defined yet
    if (window.spoke && !speaks) document.querySelector('#play').click(); // the speech had ended before this check
    window.spoke = speaks;
    return word && word.top >= 0 && word.bottom <= her.top + 1 && her.bottom <= innerHeight + 1;
  }, null, { timeout: 120000 });
  await page.close();
});

test('a line can be practised: its words and its language go to the coach', async () => {
  const page = await open('#mare:1:l6');
  await page.waitForSelector('[id="mare:1:l6"].linked');
  const line = (await page.textContent('[id="mare:1:l6"]')).trim().replace(/\s+/g, ' ');
  await page.click('#more-controls summary');
  await page.click('#practise');
  await page.waitForURL(/coach\.html/);
  await page.waitForFunction((text) => document.getElementById('text')?.value === text, line);
  assert.equal(await page.inputValue('#lang'), 'it');
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('says that there is no library', async () => {
  const page = await browser.newPage({ locale: 'it-IT', serviceWorkers: 'block' });
  await page.goto(`${daemon.url}/library.html`);
  await page.waitForFunction(() => /--library/.test(document.querySelector('#news').textContent));
  await page.close();
});

test('counts a stage direction as text; draws nested marks up to a limit', async () => {
  const page = await open();
  await serveModule(page, 'pages/library/text.js', '/library-text.js');
  const [words, drawn] = await page.evaluate(async () => {
    const { rangeIn, showText } = await import('/library-text.js');
    const text = 'Vieni (lo chiama) qui.';
    const deep = Array.from({ length: 20000 }, (_, i) => ({ kind: 'emphasis', start: i, end: 40000 - i }));
    const blocks = [{ kind: 'paragraph', id: 'w:1:p1', text, marks: [{ kind: 'stage', start: 6, end: 17 }] }, { kind: 'paragraph', id: 'w:1:p2', text: 'a'.repeat(40000), marks: deep }];
    const passage = document.querySelector('#passage');
    showText(passage, { id: 'w:1', work: { lang: 'it' }, blocks });
    const [first, second] = passage.children;
    return [[[0, 5], [18, 21]].map(([start, end]) => rangeIn(first, start, end).toString()).concat(first.querySelector('span.stage').textContent),
      [second.textContent.length, second.querySelectorAll('em').length]];
  });
  assert.deepEqual(words, ['Vieni', 'qui', '(lo chiama)']);
  assert.deepEqual(drawn, [40000, 16]);
  assert.deepEqual(page.problems, []);
  await page.close();
});
