// SPDX-License-Identifier: GPL-3.0-or-later
// Draws web/mouth.png, the README's twelve mouths, from faccia's own speech: FACCIA_BUILD=build node tests/bench/run.mjs mouth-picture [MODEL] [OUT]
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { PNG } from 'pngjs';
import { launch } from '../lib/browser.mjs';
import { headPage } from '../lib/head-page.mjs';
import { closeUp, twelveMouths } from '../lib/mouth-poses.mjs';
import { label } from '../lib/sheet.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const [model = 'mara', out = path.join(root, 'web/mouth.png')] = process.argv.slice(2);
const mouths = twelveMouths();
const [WIDTH, COLUMNS] = [300, 4];

const browser = await launch();
const page = await headPage(browser);
const head = JSON.parse(fs.readFileSync(path.join(root, `build/models/heads/${model}.json`)));
await page.load('head', head);
const tiles = [];
for (const [name, faps] of mouths) {
  const tile = PNG.sync.read(await page.shot('head', faps, closeUp(head, WIDTH)));
  // Uses the page's background.
  for (let i = 0; i < tile.data.length; i += 4) {
    for (let k = 0; k < 3; k++) tile.data[i + k] = Math.min(255, tile.data[i + k] + ((255 - tile.data[i + 3]) * 200) / 255);
    tile.data[i + 3] = 255;
  }
  tiles.push(label(tile, name));
}
await browser.close();
const { width, height } = tiles[0];
const sheet = new PNG({ width: width * COLUMNS, height: height * Math.ceil(tiles.length / COLUMNS) });
tiles.forEach((tile, i) => PNG.bitblt(tile, sheet, 0, 0, width, height, (i % COLUMNS) * width, Math.floor(i / COLUMNS) * height));
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');
await sharp(PNG.sync.write(sheet)).png({ palette: true, quality: 85, effort: 10 }).toFile(out);
console.log(`${out}: ${fs.statSync(out).size} bytes`);
