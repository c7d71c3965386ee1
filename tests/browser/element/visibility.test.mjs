// SPDX-License-Identifier: GPL-3.0-or-later
// Software rendering skips invisible triangles: the picture stays the same with far fewer of them.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { bundle } from '../../bench/page-script.mjs';
import { launch } from '../../lib/browser.mjs';
import { heads as models } from '../../lib/built-heads.mjs';
import { artefacts } from '../../lib/daemon.mjs';

const script = `
import { View } from './element/head/view.mjs';
import { Head } from './element/head/head.mjs';
import { readModel } from './element/head/model/model.mjs';
import { LEVELS } from './element/head/quality.mjs';
const canvas = document.querySelector('canvas');
const view = new View(canvas);
view.resize(640, 480);
window.load = async (json) => {
  window.head = await Head.create(readModel(json), { software: true });
  view.show(head);
  await window.level('low');
};
window.level = async (level) => {
  view.setLevel(LEVELS.find(({ name }) => name === level));
  if (!head.slimmed) await head.slim();
  head.slimmed = true;
  while (!head.looking || !(await head.looking)) await new Promise((resolve) => setTimeout(resolve, 20));
};
const drawn = (draw) => {
  draw();
  const gl = view.renderer.getContext();
  const { width, height } = canvas;
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels;
};
window.compare = (faps, turned) => {
  const values = new Float32Array(69);
  for (const [fap, value] of Object.entries(faps)) values[fap] = value;
  head.setFaps(values);
  view.turned = turned;
  const some = drawn(() => view.draw());
  const triangles = head.triangles;
  const picture = canvas.toDataURL('image/png').slice(22);
  const { seenFrom } = head;
  head.seenFrom = () => { for (const { shape } of head.parts) shape.show(false, true); };
  const all = drawn(() => view.draw());
  const whole = canvas.toDataURL('image/png').slice(22);
  head.seenFrom = seenFrom;
  let [different, points] = [0, 0];
  for (let i = 0; i < all.length; i += 4) {
    if (all[i + 3] > 20) points++;
    if ([0, 1, 2, 3].some((k) => Math.abs(all[i + k] - some[i + k]) > 24)) different++;
  }
  return { different, points, triangles, all: head.parts.reduce((sum, { shape }) => sum + shape.part.index.length / 3, 0), picture, whole };
};
/** Counts pixels changed by edge smoothing, and half-transparent pixels with and without it. */
window.edges = () => {
  head.setFaps(new Float32Array(69));
  view.turned = { yaw: 0, pitch: 0 };
  const soft = drawn(() => view.draw());
  view.edges.uniforms.leap.value = 1e9;
  const hard = drawn(() => view.draw());
  const [first, half] = [4 * canvas.width * (canvas.height >> 1), (pixels, i) => Number(pixels[i + 3] > 40 && pixels[i + 3] < 215)]; // above the fade-out
  const found = { points: 0, changed: 0, soft: 0, hard: 0, samples: view.target.samples };
  for (let i = first; i < soft.length; i += 4) {
    found.points += Number(soft[i + 3] > 0);
    found.changed += Number([0, 1, 2, 3].some((k) => Math.abs(soft[i + k] - hard[i + k]) > 8));
    found.soft += half(soft, i);
    found.hard += half(hard, i);
  }
  return found;
};
`;

let browser, page;
before(async () => {
  browser = await launch();
  page = await browser.newPage();
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.setContent('<!doctype html><canvas></canvas>');
  await page.addScriptTag({ type: 'module', content: await bundle(script) });
  await page.waitForFunction(() => window.load);
  fs.mkdirSync(artefacts, { recursive: true });
});
after(() => browser?.close());

const OPEN = { 3: 600, 4: -250, 8: -200, 9: -200, 5: -700, 10: -600, 11: -600 };
const turn = (yaw, pitch, roll) => ({ 48: pitch * 1745, 49: yaw * 1745, 50: roll * 1745 });
/** [what, FAPs, the view's turn] */
const FACES = [
  ['at rest', {}, { yaw: 0, pitch: 0 }],
  ['speaking, turned', { ...OPEN, ...turn(13, -9, 11) }, { yaw: 0, pitch: 0 }],
  ['smiling, seen from the left', { 4: -200, 8: -200, 9: -200, 6: 250, 7: 250, 12: 250, 13: 250, 41: 200, 42: 200 }, { yaw: 13, pitch: 0 }],
  ['blinking, from the right and above', { 19: 900, 20: 900, 31: 200, 32: 200, 37: 100, ...turn(-6, 8, -8) }, { yaw: -7, pitch: 0 }],
  ['surprised, looking aside', { ...OPEN, 3: 850, 5: -1000, 10: -900, 11: -900, 19: -200, 20: -200, 23: 20000, 24: 20000, 31: 300, 32: 300, ...turn(-13, 0, 0) }, { yaw: 0, pitch: -9 }],
  ['pressed lips', { 4: 60, 5: 60, 8: 60, 9: 60, 10: 60, 11: 60, ...turn(10, 9, 0) }, { yaw: 0, pitch: 0 }],
  ['turned far: all of it is drawn', { ...turn(40, 0, 0) }, { yaw: 0, pitch: 0 }, true],
];

for (const name of ['mara', 'rosa'])
  test(`${name}: omits only invisible triangles`, async () => {
    await page.evaluate((json) => window.load(json), JSON.parse(fs.readFileSync(path.join(models, `${name}.json`))));
    for (const level of ['low', 'high']) {
      if (level === 'high') await page.evaluate(() => window.level('high'));
      for (const [what, faps, turned, whole] of FACES) {
        const found = await page.evaluate((all) => window.compare(...all), [faps, turned]);
        const where = `${name}, ${level}, ${what}: ${found.different} of ${found.points} points differ, ${found.triangles} of ${found.all} triangles`;
        for (const kind of found.different ? ['picture', 'whole'] : [])
          fs.writeFileSync(path.join(artefacts, `sight-${name}-${level}-${what.split(/[ ,:]/)[0]}-${kind}.png`), Buffer.from(found[kind], 'base64'));
        assert.ok(found.points > 40000, where);
        assert.ok(found.different <= (level === 'low' ? 0.00005 : 0.0003) * found.points, where);
        if (whole) assert.equal(found.triangles, found.all, where);
        else assert.ok(found.triangles < 0.87 * found.all, where);
      }
    }
    assert.deepEqual(page.problems, []);
  });

test('high quality softens edges without four-sample multisampling, and changes nothing else', async () => {
  await page.evaluate((json) => window.load(json), JSON.parse(fs.readFileSync(path.join(models, 'mara.json'))));
  await page.evaluate(() => window.level('high'));
  const { points, changed, soft, hard, samples } = await page.evaluate(() => window.edges());
  const figures = `${points} points, ${changed} changed, half clear ${soft}, before ${hard}`;
  assert.equal(samples, 0);
  assert.ok(soft > 250 && soft > 1.5 * hard, figures);
  assert.ok(changed > 0.005 * points && changed < 0.08 * points, figures);
});
