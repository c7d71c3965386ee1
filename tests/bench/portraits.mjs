// SPDX-License-Identifier: GPL-3.0-or-later
// Heads of photographs, measured: the skin's distance from the picture's (CIELAB; its hue alone; the light's share), the landmarks' from the picture's before
// and after (per cent of the face's height), and the hair that was recognised. Draws each photograph beside its head, without names. The photographs lie in a
// folder of one's own; BASE is the head whose hairstyle and clothes are chosen for it: 'biden.jpg=ettore'.
// FACCIA_BUILD=build node tests/bench/run.mjs portraits FOLDER OUT.png FILE=BASE[:STOPS]...
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { drawPoster } from '../../models/tools/lib/poster.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat, textures } from '../../models/tools/portrait/images.mjs';
import { align, upright } from '../../web/portrait/align.mjs';
import { hairOf, lab } from '../../web/portrait/hair.mjs';
import { STEADY } from '../../web/portrait/landmarks.mjs';
import { makeHead } from '../../web/portrait/portrait.mjs';
import { toneOf } from '../../web/portrait/skin.mjs';
import { heads } from '../lib/built-heads.mjs';
import { root } from '../lib/daemon.mjs';

const [folder, out, ...wishes] = process.argv.slice(2);
if (!wishes.length) throw new Error('usage: run.mjs portraits FOLDER OUT.png FILE=BASE[:STOPS]...');
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');
const table = JSON.parse(fs.readFileSync(path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'web/face-points.json'), 'utf8'));
const SIZE = [300, 360];
const eye = await openEye();

/** Mean distance of landmarks after alignment, in per cent of the face's height. */
function apart(some, others) {
  const [a, b] = [upright(some), upright(others)];
  const { apply } = align(b, a, STEADY);
  const sum = a.reduce((total, p, i) => total + Math.hypot(...apply(b[i]).slice(0, 2).map((x, k) => x - p[k])), 0);
  return (100 * sum) / a.length / Math.hypot(some[10][0] - some[152][0], some[10][1] - some[152][1]);
}

/** The head in a picture, as large as in a poster. */
async function cropped(file, landmarks, { width, height }) {
  const [top, chin] = [landmarks[10], landmarks[152]];
  const tall = Math.hypot(top[0] - chin[0], top[1] - chin[1]) * 2;
  const [x, y] = [(top[0] + chin[0]) / 2, (top[1] + chin[1]) / 2 - 0.05 * tall];
  const box = { left: Math.max(0, Math.round(x - (tall * SIZE[0]) / SIZE[1] / 2)), top: Math.max(0, Math.round(y - tall / 2)) };
  const [w, h] = [Math.min(width - box.left, Math.round((tall * SIZE[0]) / SIZE[1])), Math.min(height - box.top, Math.round(tall))];
  return sharp(file).rotate().extract({ ...box, width: w, height: h }).resize(...SIZE, { fit: 'contain', background: '#c8ccd0' }).png().toBuffer();
}

console.log('| photograph | base | light | skin, ΔE | hue and saturation alone | landmarks before, % | after, % | hair seen |\n|---|---|---|---|---|---|---|---|');
const tiles = [];
for (const wish of wishes) {
  const [, name, like, stops = '0'] = /^(.+)=(\w+)(?::(-?[\d.]+))?$/.exec(wish);
  const file = path.join(folder, name);
  const picture = await flat(file);
  const landmarks = await eye(picture);
  const base = JSON.parse(fs.readFileSync(path.join(heads, `${like}.json`), 'utf8'));
  const plain = await flat(path.join(heads, `${like}.webp`));
  const hair = hairOf(picture, landmarks);
  const { head } = await makeHead(base, table[like], [{ picture, landmarks }], textures, { hair: hair.kind === 'none' ? 'none' : hair.colour, light: Number(stops) });
  const poster = await drawPoster(head);
  const drawn = await flat(poster);
  const found = await eye(drawn);
  const [is, was] = [toneOf(drawn, found), toneOf(picture, landmarks)].map(lab);
  const off = is.map((x, k) => x - was[k]);
  const before = apart(landmarks, await eye(plain));
  const seen = hair.colour ? lab(hair.colour).map(Math.round).join(' ') : hair.kind;
  console.log(`| ${tiles.length / 2 + 1} | ${like} | ${stops} | ${Math.hypot(...off).toFixed(1)} | ${Math.hypot(off[1], off[2]).toFixed(1)} | ${before.toFixed(2)} | ${apart(landmarks, found).toFixed(2)} | ${seen} |`);
  const right = await sharp(poster).flatten({ background: '#c8ccd0' }).resize(...SIZE, { fit: 'contain', background: '#c8ccd0' }).png().toBuffer();
  tiles.push(await cropped(file, landmarks, picture), right);
}
const rows = Math.ceil(tiles.length / 6);
await sharp({ create: { width: 6 * SIZE[0], height: rows * SIZE[1], channels: 3, background: '#c8ccd0' } })
  .composite(tiles.map((input, i) => ({ input, left: (i % 6) * SIZE[0], top: Math.floor(i / 6) * SIZE[1] }))).png().toFile(out);
