#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Checks a built head: check-head.mjs HEAD.json. Prints errors, and exits with 1 if there are any. First reads the head with the client's reader, then checks it as a face.
 */
import fs from 'node:fs';
import { readModel } from '../../web/element/head/model/model.mjs';
import * as check from './lib/check.mjs';
import { unpack } from './lib/deform.mjs';

const [file] = process.argv.slice(2);
if (!file) {
  console.error('usage: check-head.mjs HEAD.json');
  process.exit(2);
}
const json = JSON.parse(fs.readFileSync(file, 'utf8'));
try {
  readModel(json);
} catch (error) {
  console.log(error.message);
  process.exit(1);
}
const head = unpack(json);
const problems = Object.entries(check)
  .filter(([name]) => name.startsWith('check'))
  .flatMap(([, run]) => run(head));
const packed = `${file}.gz`;
if (fs.existsSync(packed) && fs.statSync(packed).size > check.MOST_BYTES)
  problems.push(`${packed} has more than ${check.MOST_BYTES} bytes`);
for (const p of problems) console.log(p);
console.log(problems.length ? `${problems.length} problems` : `${head.name}: as it should be`);
process.exit(problems.length ? 1 : 0);
