// SPDX-License-Identifier: GPL-3.0-or-later
// Takes web/kiosk.webp for the README: the face of a room, and the operator's desk that speaks through it.
// FACCIA_BUILD=build node tests/bench/run.mjs kitchen-picture [OUT]
import fs from 'node:fs';
import path from 'node:path';
import { launch } from '../lib/browser.mjs';
import { Daemon, root } from '../lib/daemon.mjs';
import { besideEachOther } from '../lib/picture-sheets.mjs';

const [out = path.join(root, 'web/kiosk.webp')] = process.argv.slice(2);
const [HEIGHT, KIOSK, DESK, GAP] = [860, 720, 1080, 20];
const QUESTION = ['Shall we eat together?', 'Yes', 'In a minute'];

const daemon = await Daemon.start();
const browser = await launch({ idling: true });
const open = async (address, width) => {
  const page = await browser.newPage({ locale: 'en-GB', timezoneId: 'Europe/Rome', colorScheme: 'dark', viewport: { width, height: HEIGHT } });
  await page.goto(`${daemon.url}/${address}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 180000 });
  return page;
};
const kiosk = await open('room.html?room=kitchen&clock', KIOSK);
const desk = await open('operator.html?room=kitchen&name=Anna', DESK);
const other = await open('operator.html?room=kitchen&name=Ben', 400);
await desk.waitForFunction(() => document.querySelector('#listeners').textContent.includes('Ben'));
await desk.fill('#text', 'Dinner is ready.');
await desk.click('#speak');
await desk.waitForFunction(() => document.querySelector('#said .sentence span')?.textContent.includes('ready'));
await kiosk.waitForFunction(() => document.body.dataset.state === 'idle');
await desk.fill('#choices', QUESTION.join(' | '));
await desk.click('#offer');
await desk.focus('#thumb');
for (const key of ['ArrowRight', 'ArrowRight', 'ArrowRight', 'ArrowRight', 'ArrowUp', 'ArrowUp']) await desk.keyboard.press(key); // joy
await kiosk.waitForSelector('.answers button');
await desk.fill('#text', 'It is vegetable soup today, with the bread that you like.');
await desk.click('#speak');
await kiosk.waitForFunction(() => document.body.dataset.state === 'speaking' && (document.querySelector('talking-head').faps[3] ?? 0) > 150, null, { polling: 10 });
const pictures = [await kiosk.screenshot(), await desk.evaluate(() => scrollTo(0, 0)).then(() => desk.screenshot())];
await other.close();
fs.writeFileSync(out, await besideEachOther(browser, pictures, GAP));
await browser.close();
await daemon.stop();
console.log(`${out}: ${fs.statSync(out).size} bytes`);
