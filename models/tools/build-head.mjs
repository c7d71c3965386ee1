#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Builds a head: build-head.mjs RECIPE.json OUTPUT.json [--modules DIR] [--draft]. Writes OUTPUT.json, OUTPUT.json.gz and the
 * poster, OUTPUT.webp. --draft makes textures a quarter of the size, for experiments.
 */
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import { fileURLToPath } from 'node:url';
import { openAssets } from './head/assets.mjs';
import { buildHead } from './head/head.mjs';
import { drawPoster } from './lib/poster.mjs';
import { readRecipe } from './head/recipe.mjs';

const here = path.dirname(fileURLToPath(import.meta.url));
const [recipeFile, outFile, ...rest] = process.argv.slice(2);
const options = {};
while (rest.length) {
  const name = rest.shift();
  if (name === '--draft') options.draft = true;
  else if (name === '--modules' && rest.length) options.modules = rest.shift();
  else options.wrong = true;
}
if (!recipeFile || !outFile || options.wrong) {
  console.error('usage: build-head.mjs RECIPE.json OUTPUT.json [--modules DIR] [--draft]');
  process.exit(2);
}
const modules = options.modules ?? path.join(here, '..');
try {
  await build();
} catch (error) {
  console.error(`build-head: ${recipeFile}: ${error.message}`);
  process.exit(1);
}

async function build() {
  const recipe = readRecipe(recipeFile);
  if (options.draft) for (const texture of Object.values(recipe.textures)) if (texture.paint !== 'strands') texture.size /= 4;
  const head = await buildHead(openAssets(modules), recipe);
  const text = Buffer.from(JSON.stringify(head));
  const packed = zlib.gzipSync(text, { level: 9, memLevel: 9 });
  packed.writeUInt32LE(0, 4); // the time stamp
  packed[9] = 255; // the operating system: unknown
  fs.mkdirSync(path.dirname(outFile), { recursive: true });
  fs.writeFileSync(outFile, text);
  fs.writeFileSync(`${outFile}.gz`, packed);
  const poster = await drawPoster(head, !options.draft);
  fs.writeFileSync(outFile.replace(/(\.json)?$/, '.webp'), poster);
  console.log(`${path.basename(outFile)}: ${text.length} bytes, ${packed.length} compressed, poster ${poster.length}`);
}
