// SPDX-License-Identifier: GPL-3.0-or-later
// What the Face Player draws over the head (mesh, feature points, the zone of a FAP), and a film of a speaker on the same time line.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-views-'));
const FLAGS = Array(68).fill(1).map((_, i) => Number(i === 2)).join(' '); // open_jaw
const FRAMES = 50;
let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 1300, height: 950 }, locale: 'it-IT' });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.goto(`${daemon.url}/player.html`);
  await page.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open' && document.querySelector('#head').debugParts().stage.view?.head, null, { timeout: 120000 });
  const fap = `2.1 mio 25 ${FRAMES}\n${Array.from({ length: FRAMES }, (_, k) => `${FLAGS}\n${k} ${k < 20 ? 0 : 1500}\n`).join('')}`;
  await page.setInputFiles('#files', { name: 'mio.fap', mimeType: 'text/plain', buffer: Buffer.from(fap) });
  await page.waitForFunction((n) => document.querySelector('#scrub').max === String(n - 1), FRAMES);
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true });
  assert.equal((await daemon.stop()).code, 0);
});

const go = (frame) => page.evaluate(async (k) => {
  const scrub = document.querySelector('#scrub');
  scrub.value = k;
  scrub.dispatchEvent(new Event('input'));
  for (let i = 0; i < 10; i++) await new Promise(requestAnimationFrame);
}, frame);
/** Pixels of the drawing: their number, and the middle and lower end of each colour's, as shares of the picture. */
const painted = () => page.evaluate(() => {
  const canvas = document.querySelector('#anatomy');
  if (canvas.hidden || !canvas.width) return null;
  const { data, width, height } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let count = 0, x = 0, low = 0, high = height;
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] < 60) continue;
    const row = Math.floor(i / 4 / width);
    count++;
    x += (i / 4) % width;
    low = Math.max(low, row);
    high = Math.min(high, row);
  }
  return { count, x: x / count / width, low: low / height, high: high / height };
});
const choose = async (...ids) => {
  for (const id of ['mesh', 'points', 'zone']) await page.setChecked(`#${id}`, ids.includes(id));
  await go(await page.evaluate(() => Number(document.querySelector('#scrub').value)));
};
const shoot = (name) => page.locator('.faces > .over').screenshot({ path: path.join(artefacts, `player-${name}.png`) });

test('draws the mesh over the face, and it follows the jaw', async () => {
  fs.mkdirSync(artefacts, { recursive: true });
  assert.equal(await painted(), null, 'nothing unless it is asked for');
  await choose('mesh');
  await go(0);
  const still = await painted();
  assert.ok(still.count > 2000 && Math.abs(still.x - 0.5) < 0.1, JSON.stringify(still));
  await shoot('mesh');
  const before = await page.evaluate(() => document.querySelector('#anatomy').toDataURL());
  await go(30);
  assert.notEqual(await page.evaluate(() => document.querySelector('#anatomy').toDataURL()), before, 'it moves');
  await go(0);
  assert.equal(await page.evaluate(() => document.querySelector('#anatomy').toDataURL()), before, 'and back');
});

test('marks the feature points', async () => {
  await choose('points');
  await go(0);
  const marks = await painted();
  assert.ok(marks.count > 500 && Math.abs(marks.x - 0.5) < 0.1, JSON.stringify(marks));
  await shoot('points');
});

test('shows the zone of the chosen curve', async () => {
  await choose('zone');
  await go(0);
  const jaw = await painted();
  assert.ok(jaw.count > 300, JSON.stringify(jaw));
  await shoot('zone');
  await page.selectOption('#group', '4');
  await go(0);
  const brow = await painted();
  assert.ok(brow.count > 30 && brow.low < jaw.low, `brows ${JSON.stringify(brow)}, jaw ${JSON.stringify(jaw)}`);
  assert.ok(brow.high < jaw.high, 'the zone of a brow reaches higher than that of the jaw');
  await page.selectOption('#group', '2');
  await choose();
  assert.equal(await painted(), null);
});

test('plays a film of a speaker on the same time line', { skip: spawnSync('ffmpeg', ['-version']).status !== 0 && 'ffmpeg is not installed' }, async () => {
  const film = path.join(folder, 'parla.webm');
  const made = spawnSync('ffmpeg', ['-v', 'error', '-f', 'lavfi', '-i', 'testsrc=duration=2:size=160x120:rate=25', '-c:v', 'libvpx', '-g', '5', film], { encoding: 'utf8' });
  assert.equal(made.status, 0, made.stderr);
  await page.setInputFiles('#files', film);
  await page.waitForSelector('#film:not([hidden])');
  const moment = () => page.evaluate(() => document.querySelector('#film').currentTime);
  await go(25);
  await page.waitForFunction(() => Math.abs(document.querySelector('#film').currentTime - 1) < 0.02);
  await page.fill('#film-start', '0.4');
  await page.waitForFunction(() => Math.abs(document.querySelector('#film').currentTime - 0.6) < 0.02);
  await page.locator('.faces').screenshot({ path: path.join(artefacts, 'player-film.png') });
  await go(0);
  assert.equal(await moment(), 0, 'before its beginning it waits');
  await page.click('#play');
  const gaps = await page.evaluate(async () => {
    const [film, where] = [document.querySelector('#film'), document.querySelector('#where')];
    const list = [];
    while (list.length < 20 && document.querySelector('#play').textContent !== 'Avvia') {
      await new Promise(requestAnimationFrame);
      const seconds = Number(where.textContent.match(/\(([\d.]+)/)[1]);
      if (!film.paused && seconds > 0.6 && seconds < 1.8) list.push(Math.abs(film.currentTime - (seconds - 0.4)));
    }
    return list;
  });
  assert.ok(gaps.length >= 3 && gaps.sort((a, b) => a - b)[gaps.length >> 1] < 0.15, `${gaps}`);
  await page.waitForFunction(() => document.querySelector('#play').textContent === 'Avvia', null, { timeout: 60000 });
  await page.waitForFunction(() => document.querySelector('#film').paused);
  assert.deepEqual(await violations(page), []);
  assert.deepEqual(page.problems, []);
});
