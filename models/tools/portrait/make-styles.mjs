#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Measures hairstyles for portraits: make-styles.mjs OUTPUT.json WEAR.json... (of make-wear.mjs). Reads the picture beside each. */
import fs from 'node:fs';
import path from 'node:path';
import { hairForm, measure } from '../../../web/portrait/traits.mjs';
import { openEye } from './eye.mjs';
import { flat } from './images.mjs';
import { litOf } from './points.mjs';

const [out, ...files] = process.argv.slice(2);
if (!files.length) {
  console.error('usage: make-styles.mjs OUTPUT.json WEAR.json...');
  process.exit(2);
}
const eye = await openEye();
const table = {};
for (const file of files) {
  const picture = await flat(file.replace(/\.json$/, '.webp'));
  const landmarks = await eye(picture);
  const lit = await litOf(JSON.parse(fs.readFileSync(file, 'utf8')), picture, landmarks);
  table[path.basename(file, '.json').replace(/^wear-/, '')] = { hair: hairForm(measure(picture, landmarks)), lit };
}
fs.writeFileSync(out, JSON.stringify(table));
