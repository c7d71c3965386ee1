#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/** Draws a set of pictures of a built head: build-pictures.mjs HEAD.json POSES.json OUTPUT.json. Writes OUTPUT.json and OUTPUT.json.gz. */
import fs from 'node:fs';
import path from 'node:path';
import zlib from 'node:zlib';
import { unpack } from './lib/deform.mjs';
import { makePictures } from './lib/pictures.mjs';

const MOST_BYTES = 765000; // in the transmitted size
const [headFile, posesFile, outFile, ...rest] = process.argv.slice(2);
if (!outFile || rest.length) {
  console.error('usage: build-pictures.mjs HEAD.json POSES.json OUTPUT.json');
  process.exit(2);
}
try {
  const read = (file) => JSON.parse(fs.readFileSync(file, 'utf8'));
  const set = await makePictures(unpack(read(headFile)), read(posesFile).poses);
  const text = Buffer.from(JSON.stringify(set));
  const packed = zlib.gzipSync(text, { level: 9, memLevel: 9 });
  packed.writeUInt32LE(0, 4); // the time stamp
  packed[9] = 255; // the operating system: unknown
  if (packed.length > MOST_BYTES) throw new Error(`${packed.length} bytes are more than ${MOST_BYTES}`);
  fs.writeFileSync(outFile, text);
  fs.writeFileSync(`${outFile}.gz`, packed);
  const count = set.regions.reduce((sum, { pictures }) => sum + pictures.length, 1);
  console.log(`${path.basename(outFile)}: ${count} pictures, ${text.length} bytes, ${packed.length} compressed`);
} catch (error) {
  console.error(`build-pictures: ${headFile}: ${error.message}`);
  process.exit(1);
}
