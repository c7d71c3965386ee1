// SPDX-License-Identifier: GPL-3.0-or-later
// A beard in a picture, dark or grey, on light or dark skin, must not end in the middle of the face when the base head has none; a dark
// face without a beard is unchanged.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { textures } from '../../models/tools/portrait/images.mjs';
import { makeHead } from '../../web/portrait/portrait.mjs';
import { heads } from '../lib/built-heads.mjs';
import { photograph } from '../lib/drawn-photographs.mjs';
import { cases } from '../lib/long.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const table = JSON.parse(fs.readFileSync(path.join(process.env.FACCIA_WEB ?? path.join(build, 'web'), 'face-points.json'), 'utf8'));
const luca = JSON.parse(fs.readFileSync(path.join(heads, 'luca.json'), 'utf8'));
const CHEEKS = [50, 280, 205, 425]; // landmarks
const ABOUT = [43, 273, 106, 335, 18, 200, 199, 57, 287]; // about the mouth, where a beard grows

/** Brightness of the darkest and the palest skin about the mouth, relative to the cheeks. */
async function shades(head) {
  const skin = unpack(head).parts.find(({ name }) => name === 'skin');
  const image = await textures.read(head.textures[head.materials[skin.material].texture]);
  const before = unpack(luca).parts.find(({ name }) => name === 'skin').position;
  const bright = (place, reach) => {
    const found = [];
    for (let v = 0; v < before.length / 3; v++) {
      if (Math.hypot(...place.map((x, k) => before[3 * v + k] - x)) > reach) continue;
      const at = 4 * (Math.floor((1 - skin.uv[2 * v + 1]) * image.height) * image.width + Math.floor(skin.uv[2 * v] * image.width));
      found.push(0.3 * image.data[at] + 0.6 * image.data[at + 1] + 0.1 * image.data[at + 2]);
    }
    return found.reduce((sum, x) => sum + x, 0) / found.length;
  };
  const cheeks = CHEEKS.reduce((sum, i) => sum + bright(table.luca.at[i], 5) / CHEEKS.length, 0);
  const about = ABOUT.map((i) => bright(table.luca.at[i], 4) / cheeks);
  return { darkest: Math.min(...about), palest: Math.max(...about) };
}

/** The same with grey hair where the beard is. */
function greyed(picture, bare) {
  const data = Uint8ClampedArray.from(picture.data);
  for (let i = 0; i < data.length; i += 4) {
    const share = Math.min(1, Math.max(...[0, 1, 2].map((k) => Math.abs(data[i + k] - bare.data[i + k]))) / 30);
    const grey = 60 + 1.2 * (0.3 * data[i] + 0.6 * data[i + 1] + 0.1 * data[i + 2]);
    for (let k = 0; k < 3; k++) data[i + k] += share * (grey - data[i + k]);
  }
  return { ...picture, data };
}

/** Somebody with Bruno's beard, as a folder of heads. */
async function bearded(name, eye) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-beard-'));
  after(() => fs.rmSync(folder, { recursive: true, force: true }));
  const bruno = JSON.parse(fs.readFileSync(path.join(heads, 'bruno.json'), 'utf8'));
  const picture = await photograph(heads, name, 0);
  const { head } = await makeHead(bruno, table.bruno, [{ picture, landmarks: await eye(picture) }], textures, { keep: ['beard'] });
  fs.writeFileSync(path.join(folder, `${name}.json`), JSON.stringify(head));
  return folder;
}

const bare = { change: (head) => ({ ...head, parts: head.parts.filter(({ name }) => !name.startsWith('beard')) }) };
for (const [name, what, has] of cases(
  [['bruno', 'with a beard', true], ['amina', 'without a beard', false], ['samuel', "with Bruno's beard in grey", true]],
  [['ettore', 'without a beard', false], ['bruno', 'with a grey beard', true], ['samuel', "with Bruno's beard", true], ['mei', "with Bruno's beard", true]],
))
  test(`${name}, ${what}, on a base without a beard`, async (t) => {
    const eye = await openEye();
    const folder = what.includes("Bruno's") ? await bearded(name, eye) : heads;
    let picture = await photograph(folder, name, 0);
    if (what.includes('grey')) picture = greyed(picture, await photograph(folder, name, 0, undefined, bare));
    const { head, bearded: told } = await makeHead(luca, table.luca, [{ picture, landmarks: await eye(picture) }], textures);
    const { darkest, palest } = await shades(head);
    t.diagnostic(`the darkest skin about the mouth: ${darkest.toFixed(2)} of the cheeks', the palest ${palest.toFixed(2)}`);
    assert.equal(told, has);
    if (has) assert.ok(darkest > 0.7 && palest < 1.25, `${darkest} ${palest}`); // the base's skin there
    else assert.ok(darkest < 0.95, `${darkest}`); // the picture's own shadows
  });
