// SPDX-License-Identifier: GPL-3.0-or-later
// Takes web/listening.webp for the documentation: a study at home, on its screen and at the operator's desk. The microphone is a file.
// FACCIA_BUILD=build node tests/bench/run.mjs listening-picture [OUT]
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { launch } from '../lib/browser.mjs';
import { Daemon, root } from '../lib/daemon.mjs';
import { POCKETSPHINX } from '../lib/heard-speech.mjs';
import { microphoneFlags, sayInto } from '../lib/microphone.mjs';
import { besideEachOther } from '../lib/picture-sheets.mjs';

const [out = path.join(root, 'web/listening.webp')] = process.argv.slice(2);
const [HEIGHT, KIOSK, DESK, GAP] = [860, 720, 900, 20];
const QUESTIONNAIRE = { title: 'How it was', lang: 'en', items: [
  { id: 'liked', text: 'Did you like her voice?', scale: ['Not at all', 'A little', 'Much'] },
  { id: 'again', text: 'Would you do it again?', scale: ['No', 'Yes'] },
  { id: 'change', text: 'What shall we change?' },
] };
const before = (answers) => ({ ...QUESTIONNAIRE, answers: answers.map(([id, choice, text]) => ({ id, reason: text ? 'heard' : 'chosen', ...(text ? { text } : { choice }) })) });
const OTHERS = [before([['liked', 2], ['again', 1], ['change', 0, 'Nothing, really.']]), before([['liked', 1], ['again', 1]]), before([['liked', 2], ['again', 0], ['change', 0, 'Speak a little slower.']])];

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bench-')), file = path.join(folder, 'fake.wav');
sayInto(file, 'the second one');
const daemon = await Daemon.start(['--recogniser', POCKETSPHINX, '--sessions', folder]);
const browser = await launch({ idling: true, flags: microphoneFlags(file) });
const open = async (address, width) => {
  const page = await browser.newPage({ locale: 'en-GB', colorScheme: 'light', viewport: { width, height: HEIGHT } });
  await page.goto(`${daemon.url}/${address}`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle', null, { timeout: 180000 });
  return page;
};
const json = (name, what) => ({ name, mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(what)) });
const kiosk = await open('room.html?room=kitchen&lang=en', KIOSK), desk = await open('operator.html?room=kitchen&name=Anna', DESK);
await desk.check('#overhear');
await desk.click('summary[data-text="askFirst"]');
await desk.click('#ask-consent');
await kiosk.click('#consent-yes', { timeout: 60000 });
await desk.click('summary[data-text="askFirst"]');
await desk.click('#questions summary');
await desk.setInputFiles('#questions-file', [json('how.json', QUESTIONNAIRE), ...OTHERS.map((each, i) => json(`${i}.json`, each))]);
await desk.click('#ask-questions');
await kiosk.waitForSelector('#question .answers button', { timeout: 60000 });
await kiosk.click('#talk');
await kiosk.click('#ears-yes');
await kiosk.waitForFunction(() => document.getElementById('talk').getAttribute('aria-pressed') === 'true' && document.body.dataset.state !== 'speaking', null, { timeout: 60000 });
await kiosk.waitForTimeout(1000);
const pictures = [await kiosk.screenshot()];
await desk.waitForFunction(() => document.getElementById('said').textContent.includes('Heard'), null, { timeout: 60000 });
await desk.evaluate(() => document.getElementById('study-title').scrollIntoView());
pictures.push(await desk.screenshot());
fs.writeFileSync(out, await besideEachOther(browser, pictures, GAP));
await browser.close();
await daemon.stop();
fs.rmSync(folder, { recursive: true });
console.log(`${out}: ${fs.statSync(out).size} bytes`);
