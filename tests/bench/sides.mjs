// SPDX-License-Identifier: GPL-3.0-or-later
// Benefit of side pictures for a portrait: node tests/bench/run.mjs sides. Makes a head of Bruno from pictures of the front and both half-profiles, based on Mara. Reports the
// distance of its feature points from the original after alignment, and the colour difference of the face seen from the side.
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { drawHead } from '../../models/tools/lib/portrait.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { textures } from '../../models/tools/portrait/images.mjs';
import { align } from '../../web/portrait/align.mjs';
import { makeHead } from '../../web/portrait/portrait.mjs';
import sharp from '../../models/node_modules/sharp/lib/index.js';

const built = fileURLToPath(new URL('../../build/', import.meta.url));
const TURN = 45; // degrees; the detector estimates 27
const SIZE = { width: 480, height: 624, shadows: false };
const read = (name) => JSON.parse(fs.readFileSync(path.join(built, 'models/heads', `${name}.json`), 'utf8'));
const points = JSON.parse(fs.readFileSync(path.join(built, 'web/face-points.json'), 'utf8'));
const bruno = unpack(read('bruno'));
const eye = await openEye();

async function draw(head, yaw) {
  const picture = await drawHead(head, { ...SIZE, yaw });
  for (let i = 0; i < picture.data.length; i += 4) {
    const clear = 1 - picture.data[i + 3] / 255;
    for (let k = 0; k < 3; k++) picture.data[i + k] += clear * (200 - picture.data[i + k]);
    picture.data[i + 3] = 255;
  }
  return picture;
}

const views = [];
for (const yaw of [0, TURN, -TURN]) {
  const picture = await draw(bruno, yaw);
  views.push({ picture, landmarks: await eye(picture) });
}
const names = Object.keys(bruno.fdp).filter((name) => /^(2|3|4|5|8|9|10|11)\./.test(name));

/** RMS error of feature points, mm: total, and along x, y and z. */
function missed(head) {
  const [from, to] = [head, bruno].map(({ fdp }) => names.map((name) => fdp[name]));
  const { apply } = align(from, to, [...names.keys()]);
  const miss = from.map((p, i) => apply(p).map((x, k) => x - to[i][k]));
  const rms = (f) => Math.sqrt(miss.reduce((sum, one) => sum + f(one), 0) / miss.length).toFixed(2);
  return `${rms(([x, y, z]) => x * x + y * y + z * z)} (x ${rms(([x]) => x * x)}, y ${rms(([, y]) => y * y)}, z ${rms(([, , z]) => z * z)})`;
}

/** RMS difference of blurred colours at the landmarks of the side, of 255. */
async function unlike(head, yaw, { picture, landmarks }) {
  const soft = async ({ data, width, height }) => sharp(Buffer.from(data.buffer), { raw: { width, height, channels: 4 } }).blur(3).raw().toBuffer();
  const [own, his] = await Promise.all([draw(head, yaw), picture].map(async (one) => soft(await one)));
  let sum = 0;
  for (const [x, y] of landmarks) {
    const at = 4 * (Math.round(y) * picture.width + Math.round(x));
    for (let k = 0; k < 3; k++) sum += (own[at + k] - his[at + k]) ** 2;
  }
  return { rms: Math.sqrt(sum / landmarks.length / 3).toFixed(1), own };
}

for (const count of [1, 3]) {
  const before = process.cpuUsage();
  const { head } = await makeHead(read('mara'), points.mara, views.slice(0, count), textures, {});
  const { user, system } = process.cpuUsage(before);
  const sides = [];
  for (const [i, yaw] of [[1, TURN], [2, -TURN]]) {
    const { rms, own } = await unlike(unpack(head), yaw, views[i]);
    sides.push(rms);
    if (process.env.FACCIA_ARTEFACTS) await sharp(own, { raw: { width: SIZE.width, height: SIZE.height, channels: 4 } }).png().toFile(path.join(process.env.FACCIA_ARTEFACTS, `sides-${count}-${yaw}.png`));
  }
  console.log(`${count} of his pictures: feature points ${missed(head)} mm, colours from the sides ${sides.join(', ')} of 255; ${((user + system) / 1e6).toFixed(1)} s of processor time`);
}
