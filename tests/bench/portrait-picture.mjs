// SPDX-License-Identifier: GPL-3.0-or-later
// Draws web/portrait.webp: NASA's portrait of Eileen Collins, in the public domain, from Debian's python3-skimage, and the head made of it: at rest,
// saying a, turned. FACCIA_BUILD=build node tests/bench/run.mjs portrait-picture [OUT.webp]
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { drawHead } from '../../models/tools/lib/portrait.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat, textures } from '../../models/tools/portrait/images.mjs';
import { offerOf, wornOf } from '../../web/portrait/offer.mjs';
import { makeHead } from '../../web/portrait/portrait.mjs';
import { heads } from '../lib/built-heads.mjs';
import { root } from '../lib/daemon.mjs';

const PHOTOGRAPH = '/usr/lib/python3/dist-packages/skimage/data/astronaut.png';
const PIECE = { left: 110, top: 0, width: 230, height: 276 }; // of the photograph
const [BASE, CHOICE] = ['mara', { hair: 'rosa', beard: 'none', glasses: 'none' }];
const [WIDTH, HEIGHT] = [275, 330];
const GROUND = '#dfe3e8';
const SEEN = [{}, { faps: { 3: 500, 4: -120, 5: -350 } }, { yaw: 30 }];

const [out = path.join(root, 'web/portrait.webp')] = process.argv.slice(2);
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');
const web = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'web');
const [table, styles] = ['face-points', 'face-wear'].map((name) => JSON.parse(fs.readFileSync(path.join(web, `${name}.json`), 'utf8')));
const head = (name) => JSON.parse(fs.readFileSync(path.join(heads, `${name}.json`), 'utf8'));

const picture = await flat(PHOTOGRAPH);
const front = { picture, landmarks: await (await openEye())(picture) };
const { colour, brows, eyes } = offerOf(front, { ...table, ...styles });
const worn = await wornOf(CHOICE, BASE, table, async (name) => head(name));
const made = unpack((await makeHead(head(BASE), table[BASE], [front], textures, { hair: colour, brows, eyes: head(eyes), ...worn })).head);
const tiles = [await sharp(PHOTOGRAPH).extract(PIECE).resize(WIDTH, HEIGHT).png().toBuffer()];
for (const seen of SEEN) {
  const { data } = await drawHead(made, { width: 2 * WIDTH, height: 2 * HEIGHT, faps: {}, yaw: 0, shadows: true, ...seen });
  tiles.push(await sharp(Buffer.from(data.buffer), { raw: { width: 2 * WIDTH, height: 2 * HEIGHT, channels: 4 } }).flatten({ background: GROUND }).resize(WIDTH, HEIGHT).png().toBuffer());
}
await sharp({ create: { width: tiles.length * WIDTH, height: HEIGHT, channels: 3, background: GROUND } })
  .composite(tiles.map((input, i) => ({ input, left: i * WIDTH, top: 0 }))).webp({ quality: 86 }).toFile(out);
