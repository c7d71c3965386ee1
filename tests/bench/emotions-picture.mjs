// SPDX-License-Identifier: GPL-3.0-or-later
// Draws web/emotions.webp, the README's picture of the six emotions at full intensity, silent: FACCIA_BUILD=build node tests/bench/run.mjs emotions-picture [MODEL] [OUT]
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch } from '../lib/browser.mjs';
import { headPage } from '../lib/head-page.mjs';
import { expressionPose } from '../lib/mouth-poses.mjs';
import { BASIC } from '../lib/sweep-poses.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const [model = 'mara', out = path.join(root, 'web/emotions.webp')] = process.argv.slice(2);
const [WIDTH, HEIGHT, NAME, COLUMNS] = [300, 330, 30, 3];
const [PAPER, INK] = ['#e4dacd', '#26201c'];
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');

const browser = await launch({ forced: false });
const page = await headPage(browser);
await page.load('head', JSON.parse(fs.readFileSync(path.join(root, `build/models/heads/${model}.json`))));
const camera = { target: [0, -8, 0], distance: 620, fov: 23, width: 2 * WIDTH, height: 2 * HEIGHT, level: 'high' };
const tiles = [];
for (const [i, name] of BASIC.entries()) {
  const [left, top] = [(i % COLUMNS) * WIDTH, Math.floor(i / COLUMNS) * (HEIGHT + NAME)];
  tiles.push({ input: await sharp(await page.shot('head', expressionPose(`${name}=1`), camera)).resize(WIDTH, HEIGHT).toBuffer(), left, top });
  const text = `<svg width="${WIDTH}" height="${NAME}"><text x="50%" y="20" text-anchor="middle" fill="${INK}" font-family="sans-serif" font-size="17">${name}</text></svg>`;
  tiles.push({ input: Buffer.from(text), left, top: top + HEIGHT });
}
await browser.close();
const height = Math.ceil(BASIC.length / COLUMNS) * (HEIGHT + NAME);
await sharp({ create: { width: WIDTH * COLUMNS, height, channels: 3, background: PAPER } }).composite(tiles).webp({ quality: 86 }).toFile(out);
console.log(`${out}: ${fs.statSync(out).size} bytes`);
