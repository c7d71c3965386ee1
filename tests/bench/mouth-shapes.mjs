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
import { LANGUAGES, soundPoses } from '../lib/mouth-poses.mjs';
import { paint } from '../lib/mouth-seen.mjs';
import { shapeHeading, shapeRow, shapesIn, told } from '../lib/mouth-shape.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { head: { type: 'string', default: 'mara' }, out: { type: 'string', default: process.env.FACCIA_ARTEFACTS ?? os.tmpdir() }, width: { type: 'string', default: '300' } },
});
const width = Number(values.width);
const langs = positionals.length ? positionals : Object.keys(LANGUAGES);
const unknown = langs.find((lang) => !LANGUAGES[lang]);
if (unknown || !(width >= 60 && width <= 900)) throw new Error(unknown ? `no language '${unknown}': ${Object.keys(LANGUAGES).join(' ')}` : '--width is 60 to 900 pixels');

const head = JSON.parse(fs.readFileSync(path.join(heads, `${values.head}.json`)));
const camera = { target: [0, head.fdp['2.2'][1] - 4, head.fdp['2.2'][2] - 8], distance: 520, fov: 5.6, width, height: Math.round((width * 2) / 3), level: 'high' };
const browser = await launch();
const page = await headPage(browser);
await page.load('flat', head, paint);
await page.load('drawn', head);

/** Lays out pictures with captions as one PNG. */
async function sheet(file, title, tiles) {
  const view = await browser.newPage({ viewport: { width: 4 * (width + 8) + 8, height: 400 } });
  const figures = tiles.map(({ png, name, text }) => `<figure><img src="data:image/png;base64,${png.toString('base64')}"><figcaption><b>/${name}/</b> ${text}</figcaption></figure>`);
  await view.setContent(`<!doctype html><meta charset="utf-8"><style>body{margin:8px;font:13px sans-serif;background:#fff}h1{font-size:16px;margin:0 0 6px}
    main{display:grid;grid-template-columns:repeat(4,${width}px);gap:8px}figure{margin:0}img{display:block;background:#c8c8c8}</style><h1>${title}</h1><main>${figures.join('')}</main>`);
  await view.screenshot({ path: file, fullPage: true });
  await view.close();
}

fs.mkdirSync(values.out, { recursive: true });
for (const lang of langs) {
  const poses = Object.entries(soundPoses(lang));
  const shapes = await shapesIn(page, 'flat', head, poses.map(([, faps]) => faps));
  console.log(`\n${head.title}, ${lang}\n\n${shapeHeading}`);
  const tiles = [];
  for (const [i, [ipa, faps]] of poses.entries()) {
    const s = shapes[i];
    console.log(shapeRow(ipa, ipa, s));
    tiles.push({ name: ipa, png: await page.shot('drawn', faps, camera), text: `${s.area.toFixed(0)} mm², ${s.width.toFixed(0)} × ${s.height.toFixed(1)} mm${told(ipa) ? `<br>people: ${told(ipa)}` : ''}` });
  }
  await sheet(path.join(values.out, `mouths-${values.head}-${lang}.png`), `${head.title}, ${lang}`, tiles);
}
await browser.close();
