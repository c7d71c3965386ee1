#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Measures the faces of built heads for portraits: make-points.mjs OUTPUT.json HEAD.json... Reads the poster beside each head. */
import fs from 'node:fs';
import path from 'node:path';
import { unpack } from '../lib/deform.mjs';
import { openEye } from './eye.mjs';
import { flat } from './images.mjs';
import { pointsOf } from './points.mjs';

const [out, ...files] = process.argv.slice(2);
if (!files.length) {
  console.error('usage: make-points.mjs OUTPUT.json HEAD.json...');
  process.exit(2);
}
const eye = await openEye();
const short = (p, steps = 100) => p && p.map((x) => Math.round(x * steps) / steps);
const table = {};
for (const file of files) {
  const head = unpack(JSON.parse(fs.readFileSync(file, 'utf8')));
  const { at, seen, cheeks, face, iris, worn, hair, lit } = await pointsOf(head, await flat(file.replace(/\.json$/, '.webp')), eye);
  table[path.basename(file, '.json')] = { at: at.map((p) => short(p)), seen: seen.map((p) => short(p)), cheeks: short(cheeks, 1e4), face: short(face, 1e4), iris: short(iris, 10), worn, hair, lit };
}
fs.writeFileSync(out, JSON.stringify(table));
