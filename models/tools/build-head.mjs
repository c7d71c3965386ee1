#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Builds a head: build-head.mjs RECIPE.json OUTPUT.json [--modules DIR]. Writes OUTPUT.json and
 * OUTPUT.json.gz.
 */
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import { fileURLToPath } from 'node:url';
import { openAssets } from './lib/assets.mjs';
import { buildHead } from './lib/head.mjs';

const here = path.dirname(fileURLToPath(import.meta.url));
const [recipeFile, outFile, ...rest] = process.argv.slice(2);
if (!recipeFile || !outFile || (rest.length && rest[0] !== '--modules')) {
  console.error('usage: build-head.mjs RECIPE.json OUTPUT.json [--modules DIR]');
  process.exit(2);
}
const modules = rest[1] ?? path.join(here, '..');
try {
  await build();
} catch (error) {
  console.error(`build-head: ${recipeFile}: ${error.message}`);
  process.exit(1);
}

async function build() {
  const recipe = JSON.parse(fs.readFileSync(recipeFile, 'utf8'));
  const head = await buildHead(openAssets(modules), recipe);
  const text = Buffer.from(JSON.stringify(head));
  const packed = zlib.gzipSync(text, { level: 9, memLevel: 9 });
  packed.writeUInt32LE(0, 4); // the time stamp
  packed[9] = 255; // the operating system: unknown
  fs.mkdirSync(path.dirname(outFile), { recursive: true });
  fs.writeFileSync(outFile, text);
  fs.writeFileSync(`${outFile}.gz`, packed);
  console.log(`${path.basename(outFile)}: ${text.length} bytes, ${packed.length} compressed`);
}
