// SPDX-License-Identifier: GPL-3.0-or-later
// Takes web/coach.webp for the documentation: the pronunciation coach after a learner, a filmed head, has said "cosa" for "casa".
// FACCIA_BUILD=build node tests/bench/run.mjs coach-picture [OUT]
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { launch } from '../lib/browser.mjs';
import { Daemon, root } from '../lib/daemon.mjs';
import { learner } from '../lib/learner.mjs';
import { besideEachOther } from '../lib/picture-sheets.mjs';

const [out = path.join(root, 'web/coach.webp')] = process.argv.slice(2);
const TEXT = 'La mamma mangia il pane nella casa.', SIZE = { width: 1180, height: 1000 };

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-'));
const { flags, seconds } = learner(folder, { text: TEXT.replace('casa', 'cosa'), lang: 'it', voice: 'espeak:it', model: 'luca' });
const daemon = await Daemon.start();
const browser = await launch({ flags });
const page = await browser.newPage({ locale: 'en-GB', colorScheme: 'light', viewport: SIZE });
await page.goto(`${daemon.url}/coach.html?${new URLSearchParams({ text: TEXT, lang: 'it' })}`);
await page.waitForFunction(() => document.getElementById('head').debug?.().state === 'idle', null, { timeout: 180000 });
await page.check('#camera');
await page.click('#record');
await page.click('#consent-yes');
await page.waitForSelector('#recording:not([hidden])', { timeout: 60000 });
await page.waitForTimeout(1000 * (seconds + 1));
await page.click('#record');
await page.waitForSelector('#result:not([hidden])', { timeout: 120000 });
await page.evaluate(() => document.getElementById('result').scrollIntoView());
await page.waitForTimeout(2000);
fs.writeFileSync(out, await besideEachOther(browser, [await page.screenshot()], 0));
await browser.close();
await daemon.stop();
fs.rmSync(folder, { recursive: true });
console.log(`${out}: ${fs.statSync(out).size} bytes`);
