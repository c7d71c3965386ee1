// SPDX-License-Identifier: GPL-3.0-or-later
// The page for streams: a face on nothing, as a program such as OBS sees it.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

const [WIDTH, HEIGHT] = [640, 480];
let daemon, browser;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

async function open(query, { drawn = true } = {}) {
  const page = await browser.newPage({ viewport: { width: WIDTH, height: HEIGHT } });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.goto(`${daemon.url}/stage.html?quality=low&${query}`);
  if (drawn) await page.waitForFunction(() => document.querySelector('talking-head').debug?.().frames > 0, null, { timeout: 180000 });
  if (drawn) await page.waitForFunction(() => document.body.classList.contains('live'));
  return page;
}

/** What a program that puts the page over something sees. @returns {(x: number, y: number) => number[]} pixels by shares of the picture */
async function seen(page) {
  const { data, width, height } = PNG.sync.read(await page.screenshot({ omitBackground: true }));
  assert.deepEqual([width, height], [WIDTH, HEIGHT]);
  return Object.assign((x, y) => {
    const at = 4 * (Math.floor(y * (height - 1)) * width + Math.floor(x * (width - 1)));
    return [...data.subarray(at, at + 4)];
  }, { share: data.filter((value, i) => i % 4 === 3 && value === 0).length / (width * height) });
}
const sides = [[0, 0], [1, 0], [0.05, 0.3], [0.95, 0.3], [0.02, 0.02], [0.98, 0.02], [0.5, 0.005]];

/** Speaks in the room until a word is heard there. */
async function speak(page, room) {
  const heard = page.evaluate(() => new Promise((resolve) => document.querySelector('talking-head').addEventListener('word', resolve, { once: true })));
  const answer = await fetch(`${daemon.url}/v1/say?room=${room}&lang=it`, { method: 'POST', body: 'Buongiorno a tutti, questa è la mia voce, e si vede soltanto il volto.' });
  assert.equal(answer.status, 202);
  await heard;
}

test('shows the face of a room and nothing else: the rest is transparent, also while it speaks', async () => {
  const page = await open('room=studio');
  for (const speaks of [false, true]) {
    if (speaks) await speak(page, 'studio');
    const pixel = await seen(page);
    for (const [x, y] of sides) assert.deepEqual(pixel(x, y), [0, 0, 0, 0], `${x}, ${y}, speaking ${speaks}`);
    assert.equal(pixel(0.5, 0.45)[3], 255, 'the face is not');
    assert.ok(pixel.share > 0.3 && pixel.share < 0.9, `${pixel.share} of it is transparent`);
    const alone = await page.evaluate(() => [...document.querySelector('talking-head').shadowRoot.querySelectorAll('button, .message, .captions')].filter((one) => one.checkVisibility()).map((one) => one.className));
    assert.deepEqual(alone, []);
  }
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('captions, a colour and a head as the address says', async () => {
  const page = await open('room=studio2&captions=on&background=lime&model=bruno&view=bust');
  const before = await seen(page);
  assert.deepEqual(before(0.01, 0.01), [0, 255, 0, 255]);
  assert.equal(before.share, 0);
  await speak(page, 'studio2');
  await page.waitForFunction(() => document.querySelector('talking-head').shadowRoot.querySelector('.captions').checkVisibility());
  assert.deepEqual(await page.evaluate(() => {
    const { model, view, room, captions } = document.querySelector('talking-head');
    return [model, view, room, captions];
  }), ['bruno', 'bust', 'studio2', true]);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('tells what is wrong while it is set up, and not on air', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-stage-'));
  fs.writeFileSync(path.join(folder, 'secret'), 'a secret that is long enough for this', { mode: 0o600 });
  const closed = await Daemon.start(['--secret-file', path.join(folder, 'secret')]);
  const page = await browser.newPage({ viewport: { width: WIDTH, height: HEIGHT } });
  /** Waits for a message, and until it is seen or not. */
  const message = (seen, text) => page.waitForFunction(([visible, words]) => {
    const { hidden, textContent } = document.querySelector('talking-head').shadowRoot.querySelector('.message');
    return !hidden && textContent.includes(words) && document.querySelector('talking-head').shadowRoot.querySelector('.message').checkVisibility() === visible;
  }, [seen, text], { timeout: 60000 });
  await page.goto(`${closed.url}/stage.html?room=a&quality=low`);
  await message(true, 'token');
  assert.equal((await closed.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
  const own = await Daemon.start();
  await page.goto(`${own.url}/stage.html?room=a&quality=low`);
  await page.waitForFunction(() => document.body.classList.contains('live'), null, { timeout: 60000 });
  assert.equal((await own.stop()).code, 0);
  await message(false, ''); // of the lost connection
  await page.close();
});
