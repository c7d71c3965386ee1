// SPDX-License-Identifier: GPL-3.0-or-later
// Mouth shapes: the inner contour of the drawn mouth for each sound of each language beside people's, as a table and a sheet of pictures.
// Usage: node tests/bench/run.mjs mouth-shapes [--head mara] [--out FOLDER] [--width 300] [LANG]...; writes FOLDER/mouths-HEAD-LANG.png
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { launch } from '../lib/browser.mjs';
import { heads } from '../lib/built-heads.mjs';
import { headPage } from '../lib/head-page.mjs';
import { closeUp, LANGUAGES, soundPoses } from '../lib/mouth-poses.mjs';
import { paint } from '../lib/mouth-seen.mjs';
import { shapeHeading, shapeRow, shapesIn, told } from '../lib/mouth-shape.mjs';
import { captioned } from '../lib/picture-sheets.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { head: { type: 'string', default: 'mara' }, out: { type: 'string', default: process.env.FACCIA_ARTEFACTS ?? os.tmpdir() }, width: { type: 'string', default: '300' } },
});
const width = Number(values.width);
const langs = positionals.length ? positionals : Object.keys(LANGUAGES);
const unknown = langs.find((lang) => !LANGUAGES[lang]);
if (unknown || !(width >= 60 && width <= 900)) throw new Error(unknown ? `no language '${unknown}': ${Object.keys(LANGUAGES).join(' ')}` : '--width is 60 to 900 pixels');

const head = JSON.parse(fs.readFileSync(path.join(heads, `${values.head}.json`)));
const camera = closeUp(head, width);
const browser = await launch();
const page = await headPage(browser);
await page.load('flat', head, paint);
await page.load('drawn', head);

fs.mkdirSync(values.out, { recursive: true });
for (const lang of langs) {
  const poses = Object.entries(soundPoses(lang));
  const shapes = await shapesIn(page, 'flat', head, poses.map(([, faps]) => faps));
  console.log(`\n${head.title}, ${lang}\n\n${shapeHeading}`);
  const figures = [];
  for (const [i, [ipa, faps]] of poses.entries()) {
    const s = shapes[i];
    console.log(shapeRow(ipa, ipa, s));
    figures.push({ png: await page.shot('drawn', faps, camera), caption: `<b>/${ipa}/</b> ${s.area.toFixed(0)} mm², ${s.width.toFixed(0)} × ${s.height.toFixed(1)} mm${told(ipa) ? `<br>people: ${told(ipa)}` : ''}` });
  }
  fs.writeFileSync(path.join(values.out, `mouths-${values.head}-${lang}.png`), await captioned(browser, [{ title: `${head.title}, ${lang}`, figures }], { columns: 4, width, gap: 8 }));
}
await browser.close();
