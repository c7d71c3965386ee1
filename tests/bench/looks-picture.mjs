// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a contact sheet of each head into a folder: at rest, the six emotions, a turn of 30°, closed lids and a smile with closed lips. Look at them
// before and after a change of heads, expressions or shading.
// FACCIA_BUILD=build node tests/bench/run.mjs looks-picture OUT [--heads mara,bruno] [--size 450] [--level high] [--looks rest,joy] [--view face]
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { framed } from '../../web/element/head/framing.mjs';
import { launch } from '../lib/browser.mjs';
import { heads as models } from '../lib/built-heads.mjs';
import { root } from '../lib/daemon.mjs';
import { headPage } from '../lib/head-page.mjs';
import { expressionPose } from '../lib/mouth-poses.mjs';
import { BASIC } from '../lib/sweep-poses.mjs';

const { values: options, positionals: [out] } = parseArgs({
  allowPositionals: true,
  options: {
    heads: { type: 'string', default: 'mara,bruno,rosa,ettore,amina,samuel,mei,luca' }, size: { type: 'string', default: '450' },
    level: { type: 'string', default: 'high' }, looks: { type: 'string' }, view: { type: 'string' },
  },
});
if (!out) throw new Error('usage: run.mjs looks-picture OUT');
const COLUMNS = 5;
const PAPER = '#e4dacd';
const CLOSED = 1100; // FAPs 19 to 22: beyond what closes lids, as blinks are
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');

const LOOKS = {
  rest: {},
  ...Object.fromEntries(BASIC.map((name) => [name, { faps: () => expressionPose(`${name}=1`) }])),
  turned: { yaw: Math.PI / 6 },
  closed: { faps: () => ({ 19: CLOSED, 20: CLOSED }) },
  liking: { faps: () => expressionPose('liking=1') },
};
const looks = options.looks?.split(',') ?? Object.keys(LOOKS);
const size = Number(options.size);
const browser = await launch({ forced: false });
const page = await headPage(browser);
fs.mkdirSync(out, { recursive: true });
for (const name of options.heads.split(',')) {
  const head = JSON.parse(fs.readFileSync(path.join(models, `${name}.json`)));
  await page.load(name, head);
  const tiles = [];
  for (const [i, look] of looks.entries()) {
    const { faps, yaw = 0 } = LOOKS[look] ?? { faps: () => expressionPose(look) };
    const camera = { ...framed(head, options.view ?? null, 1), width: size, height: size, level: options.level, yaw };
    const input = await page.shot(name, faps?.() ?? {}, camera);
    tiles.push({ input: await sharp(input).resize(size, size).toBuffer(), left: (i % COLUMNS) * size, top: Math.floor(i / COLUMNS) * size });
  }
  const [width, height] = [size * Math.min(COLUMNS, looks.length), size * Math.ceil(looks.length / COLUMNS)];
  await sharp({ create: { width, height, channels: 3, background: PAPER } }).composite(tiles).png().toFile(path.join(out, `${name}.png`));
}
await browser.close();
