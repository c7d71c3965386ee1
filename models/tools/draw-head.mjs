#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Draws a built head: draw-head.mjs HEAD.json OUTPUT.(webp|png) [--size 480x560] [--yaw DEGREES] [--faps 3=400,5=-300]
 * [--background #dfe3e8] [--no-shadows].
 */
import fs from 'node:fs';
import sharp from 'sharp';
import { unpack } from './lib/deform.mjs';
import { drawHead } from './lib/portrait.mjs';

const [headFile, outFile, ...rest] = process.argv.slice(2);
const options = { size: '480x560', yaw: '0', faps: '' };
while (rest.length) {
  const name = rest.shift().replace(/^--/, '');
  options[name] = name === 'no-shadows' ? true : rest.shift();
}
if (!headFile || !outFile) {
  console.error('usage: draw-head.mjs HEAD.json OUTPUT.(webp|png) [--size WxH] [--yaw DEGREES] [--faps N=V,...] [--background COLOUR] [--no-shadows]');
  process.exit(2);
}
const [width, height] = options.size.split('x').map(Number);
const faps = Object.fromEntries(options.faps.split(',').filter(Boolean).map((pair) => pair.split('=').map(Number)));
const { data } = await drawHead(unpack(JSON.parse(fs.readFileSync(headFile, 'utf8'))), {
  width, height, faps, yaw: Number(options.yaw), shadows: !options['no-shadows'],
});
let image = sharp(Buffer.from(data.buffer), { raw: { width, height, channels: 4 } });
if (options.background) image = image.flatten({ background: options.background });
await image.toFile(outFile);
