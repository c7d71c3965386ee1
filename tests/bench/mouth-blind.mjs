// SPDX-License-Identifier: GPL-3.0-or-later
// A blind test of the twelve mouths: numbered pictures in random order, with the answers in a file of their own, for readers who do not know them.
// Usage: node tests/bench/run.mjs mouth-blind [--out FOLDER] [--seed N] [--width 300] [--answers FILE.json] [HEAD]...; writes FOLDER/sheet.png and FOLDER/key.json.
// --answers compares a reader's {"1": "p b m", ...} with FOLDER/key.json instead.
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { launch } from '../lib/browser.mjs';
import { heads } from '../lib/built-heads.mjs';
import { headPage } from '../lib/head-page.mjs';
import { closeUp, twelveMouths } from '../lib/mouth-poses.mjs';
import { random } from '../lib/people-statistics.mjs';
import { captioned } from '../lib/picture-sheets.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    out: { type: 'string', default: process.env.FACCIA_ARTEFACTS ?? os.tmpdir() }, seed: { type: 'string', default: String(Date.now()) }, width: { type: 'string', default: '300' },
    answers: { type: 'string' },
  },
});
const names = positionals.length ? positionals : ['mara', 'samuel'];
const [seed, width] = [Number(values.seed), Number(values.width)];
if (!Number.isInteger(seed)) throw new Error('--seed is an integer');
if (!(width >= 60 && width <= 900)) throw new Error('--width is 60 to 900 pixels');
const key = path.join(values.out, 'key.json');
if (values.answers) judge(JSON.parse(fs.readFileSync(key)), JSON.parse(fs.readFileSync(values.answers)));
else await draw();

async function draw() {
  const browser = await launch();
  const page = await headPage(browser);
  const mouths = twelveMouths();
  const next = random(seed);
  const order = names.flatMap((name) => mouths.map(([sounds, faps]) => ({ name, sounds, faps, at: next() }))).sort((a, b) => a.at - b.at);
  const figures = [];
  for (const name of names) {
    const head = JSON.parse(fs.readFileSync(path.join(heads, `${name}.json`)));
    await page.load(name, head);
    for (const [i, one] of order.entries()) if (one.name === name) figures[i] = { png: await page.shot(name, one.faps, closeUp(head, width)), caption: `<b>${i + 1}</b>` };
  }
  const sheet = await captioned(browser, [{ title: '', figures }], { columns: 4, width, gap: 8 });
  await browser.close();
  fs.mkdirSync(values.out, { recursive: true });
  fs.writeFileSync(path.join(values.out, 'sheet.png'), sheet);
  const answers = Object.fromEntries(order.map(({ sounds }, i) => [i + 1, sounds]));
  fs.writeFileSync(key, `${JSON.stringify({ seed, heads: order.map(({ name }) => name), choices: mouths.map(([sounds]) => sounds), answers }, null, 1)}\n`);
  console.log(`${path.join(values.out, 'sheet.png')}: ${order.length} mouths; choices: ${mouths.map(([sounds]) => sounds).join(', ')}`);
}

function judge({ choices, answers }, given) {
  console.log('| shown | right | read as |\n|---|---|---|');
  const shown = Object.entries(answers);
  for (const sounds of choices) {
    const read = shown.filter(([, is]) => is === sounds).map(([number]) => given[number] ?? '-');
    console.log(`| ${sounds} | ${read.filter((one) => one === sounds).length} of ${read.length} | ${read.join('; ')} |`);
  }
  const right = shown.filter(([number, is]) => given[number] === is).length;
  console.log(`\n${right} of ${shown.length} right; by chance ${(shown.length / choices.length).toFixed(1)}`);
}
