// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a contact sheet of each head into a folder: at rest, the six emotions, a turn of 30°, closed lids, a smile with closed lips, and the Italian
// sounds /a m f u/. Look at them before and after a change of heads, expressions or shading.
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
import { expressionPose, soundPoses } from '../lib/mouth-poses.mjs';
import { BASIC } from '../lib/sweep-poses.mjs';

const { values: options, positionals: [out] } = parseArgs({
  allowPositionals: true,
  options: {
    heads: { type: 'string', default: 'mara,bruno,rosa,ettore,amina,samuel,mei,luca,celia,kemal' }, size: { type: 'string', default: '450' },
    level: { type: 'string', default: 'high' }, looks: { type: 'string' }, view: { type: 'string' },
  },
});
if (!out) throw new Error('usage: run.mjs looks-picture OUT');
const COLUMNS = 7;
const PAPER = '#e4dacd';
const CLOSED = { 19: 940, 20: 940, 21: 84, 22: 84 }; // as a blink closes lids
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');

const LOOKS = {
  rest: {},
  ...Object.fromEntries(BASIC.map((name) => [name, { faps: () => expressionPose(`${name}=1`) }])),
  turned: { yaw: Math.PI / 6 },
  closed: { faps: () => CLOSED },
  liking: { faps: () => expressionPose('liking=1') },
  ...Object.fromEntries(Object.entries({ a: 'a', m: 'p', f: 'f', u: 'u' }).map(([name, ipa]) => [name, { faps: () => (sounds ??= soundPoses('it'))[ipa] }])), // /m/ looks as /p/ does
};
let sounds;
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
