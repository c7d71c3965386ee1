// SPDX-License-Identifier: GPL-3.0-or-later
// A beard in a picture does not end in the middle of the face of a base that has none; a dark face without one is left as it is.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { textures } from '../../models/tools/portrait/images.mjs';
import { makeHead } from '../../web/src/portrait/portrait.mjs';
import { photograph } from '../lib/drawn-photographs.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const heads = path.join(process.env.FACCIA_MODELS ?? path.join(build, 'models'), 'heads');
const table = JSON.parse(fs.readFileSync(path.join(process.env.FACCIA_WEB ?? path.join(build, 'web'), 'face-points.json'), 'utf8'));
const luca = JSON.parse(fs.readFileSync(path.join(heads, 'luca.json'), 'utf8'));
const CHEEKS = [50, 280, 205, 425]; // landmarks
const ABOUT = [43, 273, 106, 335, 18, 200, 199, 57, 287]; // about the mouth, where a beard grows

/** How bright the darkest skin about the mouth is, of that of the cheeks. */
async function darkest(head) {
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
  return Math.min(...ABOUT.map((i) => bright(table.luca.at[i], 4) / cheeks));
}

for (const [name, has] of [['bruno', true], ['amina', false]])
  test(`${name}, ${has ? 'with' : 'without'} a beard, on a base without one`, async (t) => {
    const picture = await photograph(heads, name, 0);
    const landmarks = await (await openEye())(picture);
    const { head, bearded } = await makeHead(luca, table.luca, [{ picture, landmarks }], textures);
    const share = await darkest(head);
    t.diagnostic(`the darkest skin about the mouth: ${share.toFixed(2)} of the cheeks'`);
    assert.equal(bearded, has);
    assert.ok(has ? share > 0.7 : share < 0.8, `${share}`); // the base's skin there, or the picture's own shadows
  });
