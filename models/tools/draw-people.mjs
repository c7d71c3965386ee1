#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** A sheet of all people, from the posters of built heads: draw-people.mjs FOLDER OUTPUT.(webp|png) */
import fs from 'node:fs';
import path from 'node:path';
import sharp from 'sharp';

const TILE = { width: 216, height: 281 };
const NAME = 34; // height of the line below
const COLUMNS = 5;
const PAPER = '#e4dacd',
  INK = '#26201c';

const [folder, out] = process.argv.slice(2);
if (!folder || !out) {
  console.error('usage: draw-people.mjs FOLDER OUTPUT.(webp|png)');
  process.exit(2);
}
const people = fs
  .readdirSync(folder)
  .filter((file) => file.endsWith('.json'))
  .map((file) => ({ ...JSON.parse(fs.readFileSync(path.join(folder, file), 'utf8')), file }))
  .sort((a, b) => a.rank - b.rank);
const tiles = [];
for (const [i, { title, file }] of people.entries()) {
  const left = (i % COLUMNS) * TILE.width,
    top = Math.floor(i / COLUMNS) * (TILE.height + NAME);
  const poster = path.join(folder, file.replace(/json$/, 'webp'));
  tiles.push({ input: await sharp(poster).resize(TILE.width, TILE.height).toBuffer(), left, top });
  const name = `<svg width="${TILE.width}" height="${NAME}"><text x="50%" y="21" text-anchor="middle" fill="${INK}"
    font-family="sans-serif" font-size="18">${title}</text></svg>`;
  tiles.push({ input: Buffer.from(name), left, top: top + TILE.height });
}
const rows = Math.ceil(people.length / COLUMNS);
await sharp({
  create: { width: TILE.width * COLUMNS, height: rows * (TILE.height + NAME), channels: 3, background: PAPER },
})
  .composite(tiles)
  .webp({ quality: 86 })
  .toFile(out);
