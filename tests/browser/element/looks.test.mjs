// SPDX-License-Identifier: GPL-3.0-or-later
// Regression tests for the look of the heads, each a measure of a picture: missing shadows, black holes, glowing eyes, plastic skin.
// The artefacts contain the pictures.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { framed } from '../../../web/element/head/framing.mjs';
import { launch } from '../../lib/browser.mjs';
import { heads as models } from '../../lib/built-heads.mjs';
import { artefacts } from '../../lib/daemon.mjs';
import { headPage } from '../../lib/head-page.mjs';

const names = ['mara', 'bruno', 'ettore', 'samuel', 'luca'];
const heads = new Map(names.map((name) => [name, JSON.parse(fs.readFileSync(path.join(models, `${name}.json`)))]));
const SIZE = { width: 640, height: 480 };

let browser, page;
before(async () => {
  browser = await launch();
  page = await headPage(browser);
  fs.mkdirSync(artefacts, { recursive: true });
});
after(async () => {
  await browser?.close();
});

const loaded = new Set();
async function look(name, faps, { view = null, level = 'low', ...camera } = {}, flat) {
  const key = flat ? `${name}-flat` : name;
  if (!loaded.has(key)) await page.load(key, heads.get(name), flat);
  loaded.add(key);
  const shot = { ...framed(heads.get(name), view, SIZE.width / SIZE.height), ...SIZE, level, ...camera };
  const bytes = await page.shot(key, faps, shot);
  fs.writeFileSync(path.join(artefacts, `looks-${key}-${view ?? 'portrait'}-${level}.png`), bytes);
  return { png: PNG.sync.read(bytes), shot };
}

const light = ({ data }, i) => 0.2126 * data[i] + 0.7152 * data[i + 1] + 0.0722 * data[i + 2];

/** Mean brightness of a disc around a point of the head; radius in mm. */
function patch({ png, shot: { target, distance, fov } }, [x, y, z], radius) {
  const focal = png.height / 2 / Math.tan((fov * Math.PI) / 360) / (distance + target[2] - z);
  const [column, row, reach] = [png.width / 2 + (x - target[0]) * focal, png.height / 2 - (y - target[1]) * focal, Math.max(1, radius * focal)];
  let sum = 0,
    n = 0;
  for (let j = Math.floor(row - reach); j <= row + reach; j++)
    for (let i = Math.floor(column - reach); i <= column + reach; i++) {
      if (Math.hypot(i - column, j - row) > reach) continue;
      sum += light(png, 4 * (j * png.width + i));
      n++;
    }
  return sum / n;
}

test('leaves no light material black: no holes under the hair or at the collar', async () => {
  for (const name of ['mara', 'ettore', 'luca']) {
    const { png } = await look(name, []);
    let drawn = 0,
      black = 0;
    for (let i = 0; i < png.data.length; i += 4) {
      if (png.data[i + 3] < 128) continue;
      drawn++;
      if (light(png, i) < 14) black++;
    }
    assert.ok(drawn > 40000, `${name}: ${drawn} points`);
    assert.ok(black < 0.002 * drawn, `${name}: ${black} of ${drawn} points are black`);
  }
});

// Maximum brightness beside the nose relative to the lit side. Vertex shading alone gives 0.87 to 0.9; the texture adds the rest.
const SHADOWS = { mara: 0.86, bruno: 0.875, ettore: 0.84 };

test('the nose casts a shadow, in low quality too', async () => {
  for (const [name, most] of Object.entries(SHADOWS)) {
    const seen = await look(name, []);
    // The light is at the left of the picture.
    const [x, y, z] = heads.get(name).fdp['9.1'];
    const [shadow, open] = [1, -1].map((side) => patch(seen, [side * (Math.abs(x) + 5), y - 4, z - 7], 2.5));
    assert.ok(shadow < most * open, `${name}: ${shadow.toFixed(0)} in the shadow, ${open.toFixed(0)} on the other side`);
  }
});

const EYES = { eye_l: [255, 255, 255], eye_r: [255, 255, 255], skin: [0, 0, 255], lashes: [255, 0, 0], hair: [0, 255, 0] };

test('the whites of the eyes are darker than light skin around them and not far brighter than dark skin', async () => {
  for (const [name, most] of [['mara', 0.95], ['samuel', 2.2]]) {
    const [, y, z] = heads.get(name).fdp['3.5'];
    const camera = { target: [0, y, z], distance: 500, fov: 8, level: 'low' };
    const { png: flat } = await look(name, [], camera, Object.entries(EYES).map(([part, colour]) => [part, ...colour]));
    const { png } = await look(name, [], camera);
    const whites = [],
      skin = [];
    for (let i = 0; i < flat.data.length; i += 4) {
      if (flat.data[i + 3] < 255) continue;
      if (flat.data[i] > 200 && flat.data[i + 1] > 200) whites.push(light(png, i));
      else if (flat.data[i + 2] > 200) skin.push(light(png, i));
    }
    const at = (list, share) => list.sort((a, b) => a - b)[Math.floor(share * list.length)];
    const [white, usual] = [at(whites, 0.75), at(skin, 0.5)]; // 75th percentile: iris and pupil are the darker half
    assert.ok(white < most * usual, `${name}: ${white.toFixed(0)} beside a skin of ${usual.toFixed(0)}`);
  }
});

test('shows pores in close-ups, and only in high quality', async () => {
  const { fdp, materials } = heads.get('mara');
  heads.set('smooth', { ...heads.get('mara'), materials: { ...materials, skin: { ...materials.skin, relief: 0 } } });
  const camera = { target: [-38, fdp['9.1'][1], 20], distance: 300, fov: 6 };
  const rough = async (name, level) => {
    const { png } = await look(name, [], { ...camera, level });
    let sum = 0;
    for (let y = 1; y < png.height - 1; y++)
      for (let x = 1; x < png.width - 1; x++) {
        const at = (i, j) => light(png, 4 * ((y + j) * png.width + x + i));
        sum += Math.abs(4 * at(0, 0) - at(1, 0) - at(-1, 0) - at(0, 1) - at(0, -1));
      }
    return sum / png.width / png.height;
  };
  const [own, smooth] = [await rough('mara', 'high'), await rough('smooth', 'high')];
  assert.ok(own > 1.3 * smooth, `${own.toFixed(2)} with pores, ${smooth.toFixed(2)} without`);
  assert.equal(await rough('mara', 'low'), await rough('smooth', 'low'), 'low quality has none, and pays for none');
  assert.deepEqual(page.page.problems, []);
});
