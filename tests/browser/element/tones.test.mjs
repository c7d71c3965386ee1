// SPDX-License-Identifier: GPL-3.0-or-later
// A head has the same tones at every level of quality, in its set of pictures and on its poster; outlines are soft at every level.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { framed } from '../../../web/element/head/framing.mjs';
import { LEVELS } from '../../../web/element/head/quality.mjs';
import { launch } from '../../lib/browser.mjs';
import { heads as folder, models } from '../../lib/built-heads.mjs';
import { headPage } from '../../lib/head-page.mjs';

const sharp = createRequire(new URL('../../../models/package.json', import.meta.url))('sharp');
const SIZE = { width: 480, height: 624 }; // of the sets of pictures
const APART = 3; // L*
const names = fs.readdirSync(folder).filter((file) => /^\w+\.json$/.test(file)).map((file) => file.slice(0, -5));
const headOf = (name) => JSON.parse(fs.readFileSync(path.join(folder, `${name}.json`)));

let browser, page;
before(async () => {
  browser = await launch();
  page = await headPage(browser);
});
after(async () => {
  await browser?.close();
});

/** RGBA in the common size. */
const pixels = async (bytes) => (await sharp(bytes).ensureAlpha().resize({ ...SIZE, fit: 'fill', kernel: 'nearest' }).raw().toBuffer());

/** The portrait in the middle of a set's base. */
const portraitOf = ({ width, frame, base }) =>
  sharp(Buffer.from(base.data, 'base64')).extract({ left: Math.round((width - frame.width) / 2), top: 0, ...frame }).png().toBuffer();

const linear = (byte) => (byte <= 10 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
const lightness = ([red, green, blue]) => {
  const y = 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
  return y > 0.008856 ? 116 * Math.cbrt(y) - 16 : 903.3 * y;
};

/** The row of the chin, above which all skin is the face's. */
function chinRow({ fdp, view }) {
  const { target, distance, fov } = framed({ fdp, view, fapu: {} }, null, SIZE.width / SIZE.height);
  const focal = SIZE.height / 2 / Math.tan((fov * Math.PI) / 360);
  return SIZE.height / 2 - ((fdp['2.1'][1] - target[1]) * focal) / (distance + target[2] - fdp['2.1'][2]);
}

/** The mean L* of the points of a face. */
function mean(data, face) {
  let sum = 0;
  for (const i of face) sum += lightness(data.subarray(i, i + 3));
  return sum / face.length;
}

test('the skin of every head is equally light at every level, in pictures and on the poster', async (t) => {
  assert.ok(names.length >= 8, String(names));
  for (const name of names) {
    const head = headOf(name);
    const camera = { ...framed(head, null, SIZE.width / SIZE.height), ...SIZE };
    await page.load(`${name}-flat`, head, [['skin', 255, 0, 0], ['', 0, 0, 255]]);
    await page.load(name, head);
    const flat = await pixels(await page.shot(`${name}-flat`, {}, { ...camera, level: 'fine' }));
    const seen = {};
    for (const { name: level } of LEVELS) seen[level] = await pixels(await page.shot(name, {}, { ...camera, level }));
    const set = JSON.parse(fs.readFileSync(path.join(models, 'pictures', `${name}.json`)));
    seen.pictures = await pixels(await portraitOf(set));
    seen.poster = await pixels(fs.readFileSync(path.join(folder, `${name}.webp`)));
    const face = [];
    for (let i = 0; i < 4 * SIZE.width * Math.floor(chinRow(head)); i += 4)
      if (flat[i] > 200 && flat[i + 2] < 60 && Object.values(seen).every((data) => data[i + 3] > 250)) face.push(i);
    assert.ok(face.length > 20000, `${name}: ${face.length} points`);
    const light = Object.fromEntries(Object.entries(seen).map(([level, data]) => [level, mean(data, face)]));
    t.diagnostic(`${name}: ${Object.entries(light).map(([level, l]) => `${level} ${l.toFixed(1)}`).join(', ')}`);
    for (const [level, l] of Object.entries(light))
      assert.ok(Math.abs(l - light.high) < APART, `${name}: ${l.toFixed(1)} L* at ${level}, ${light.high.toFixed(1)} at high`);
  }
});

test('outlines are soft where edges are smoothed: most pass through a point that is neither clear nor full', async () => {
  const head = headOf('luca');
  await page.load('luca', head);
  for (const { name: level, soft } of LEVELS) {
    const camera = { ...framed(head, null, SIZE.width / SIZE.height), ...SIZE, level };
    const { data, info } = await sharp(await page.shot('luca', {}, camera)).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
    let [softly, all] = [0, 0];
    for (let y = Math.floor(0.35 * info.height); y < 0.6 * info.height; y++) { // ears and cheeks
      const alpha = Array.from({ length: info.width }, (_, x) => data[4 * (y * info.width + x) + 3]);
      const first = alpha.findIndex((value) => value > 0), last = alpha.findLastIndex((value) => value > 0);
      for (const value of [alpha[first], alpha[last]]) {
        all++;
        softly += value < 250;
      }
    }
    if (soft) assert.ok(softly > 0.5 * all, `${level}: ${softly} of ${all}`);
    else assert.ok(softly < 0.5 * all, `${level}: ${softly} of ${all}, unexpectedly`);
  }
  assert.deepEqual(page.page.problems, []);
});
