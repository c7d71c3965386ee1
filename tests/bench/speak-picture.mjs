// SPDX-License-Identifier: GPL-3.0-or-later
// Takes web/picture.png, the README's first picture: the page, in Italian, as Mara speaks the first lines of the Divine Comedy with captions.
// FACCIA_BUILD=build node tests/bench/run.mjs speak-picture [OUT]
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { launch } from '../lib/browser.mjs';
import { Daemon, root } from '../lib/daemon.mjs';

const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');
const [out = path.join(root, 'web/picture.png')] = process.argv.slice(2);
const LINES = 'Nel mezzo del cammin di nostra vita\nmi ritrovai per una selva oscura,\nché la diritta via era smarrita.';
const WORD = 'diritta'; // is marked in the caption
const OPEN = 120; // of FAP 3: the lips are apart

const daemon = await Daemon.start();
const browser = await launch({ idling: true });
const page = await browser.newPage({ locale: 'it-IT', viewport: { width: 1000, height: 660 } });
await page.goto(`${daemon.url}/`);
await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 180000 });
await page.evaluate(() => document.querySelector('talking-head').setAttribute('quality', 'high'));
await page.fill('#text', LINES);
await page.click('#speak');
const word = (name) => document.querySelector('talking-head').shadowRoot.querySelector('.word')?.textContent === name;
await page.waitForFunction(word, WORD, { polling: 10, timeout: 60000 });
await page.waitForFunction((open) => (document.querySelector('talking-head').faps[3] ?? 0) > open, OPEN, { polling: 10 });
fs.writeFileSync(out, await sharp(await page.screenshot()).png({ palette: true, effort: 10 }).toBuffer());
await browser.close();
await daemon.stop();
console.log(`${out}: ${fs.statSync(out).size} bytes`);
