// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the movements of a face in pictures (web/portrait/mirror.mjs): a built-in head drawn with known FAPs.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat } from '../../models/tools/portrait/images.mjs';
import { Calm, FaceReader, mayRest, mirrored } from '../../web/portrait/mirror.mjs';
import { film, headOf } from '../lib/film.mjs';

const OPEN = { 3: 600, 5: -500, 10: -450, 11: -450, 52: -500 };
const SHOTS = {
  rest: {}, open: OPEN, smile: { 6: 150, 7: 150, 53: 150, 54: 150, 12: 300, 13: 300, 59: 300, 60: 300 }, brows: { 31: 200, 32: 200, 33: 200, 34: 200, 35: 150, 36: 150 },
  blink: { 19: 700, 20: 700, 21: 300, 22: 300 }, wink: { 19: 700, 21: 300 }, left: { 49: 20000 }, right: { 49: -30000 }, down: { 48: 15000 }, tilt: { 50: 20000 }, turned: { ...OPEN, 49: 25000 },
};
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-mirror-'));
const seen = {}, calm = {};
let rest;
before(async () => {
  await film(headOf('luca'), Object.values(SHOTS), folder, { height: 480 });
  const eye = await openEye();
  for (const [k, name] of Object.keys(SHOTS).entries()) {
    const landmarks = await eye(await flat(path.join(folder, `${String(k + 1).padStart(4, '0')}.png`)));
    rest ??= landmarks;
    calm[name] = mayRest(landmarks);
    seen[name] = new FaceReader(rest).read(landmarks);
  }
});
after(() => fs.rmSync(folder, { recursive: true }));
const between = (value, from, to, why) => assert.ok(value >= from && value <= to, `${why}: ${value} is not from ${from} to ${to}`);

test('the face at rest gives zeros', () => {
  assert.ok(Object.keys(seen.rest).length > 35);
  for (const [fap, value] of Object.entries(seen.rest)) assert.ok(Math.abs(value) <= 1, `${fap}: ${value}`);
});

test('a face with parted lips, or turned aside, is not at rest', () => {
  assert.deepEqual(Object.keys(calm).filter((name) => !calm[name]), ['open', 'left', 'right', 'turned']);
});

test('lips, brows and lids move as they do in the picture', (t) => {
  t.diagnostic(JSON.stringify(seen));
  between(seen.open[5], -700, -250, 'lower lip');
  between(seen.open[3], 250, 800, 'jaw');
  between(seen.open[4], -150, 100, 'upper lip');
  for (const fap of [6, 7, 53, 54]) between(seen.smile[fap], 60, 220, `corner, ${fap}`);
  for (const fap of [12, 13, 59, 60]) between(seen.smile[fap], 70, 400, `corner upwards, ${fap}`); // the finder trembles by 20, and shows under half of it
  for (const fap of [31, 33, 35, 34, 36]) between(seen.brows[fap], 40, 260, `brow, ${fap}`);
  for (const [upper, lower] of [[19, 21], [20, 22]]) between(seen.blink[upper] + seen.blink[lower], 500, 1024, 'lids');
  between(seen.wink[19] + seen.wink[21], 500, 1024, 'the left lids');
  between(seen.wink[20] + seen.wink[22], -250, 200, 'the right lids');
});

test('the head turns as it does in the picture, and lips are read when it is turned', () => {
  between(seen.left[49], 12000, 28000, 'to its left');
  between(seen.right[49], -42000, -20000, 'to its right');
  between(seen.down[48], 8000, 25000, 'down');
  between(seen.tilt[50], 15000, 25000, 'to the right shoulder');
  between(seen.turned[49], 14000, 36000, 'left');
  between(seen.turned[5], -700, -250, 'lower lip of a turned head');
});

test('a mirror exchanges the sides', () => {
  const face = { 3: 500, 6: 10, 7: 20, 19: 700, 20: 5, 23: 4000, 24: 4000, 49: 9000, 48: 100, 50: -300 };
  assert.deepEqual(mirrored(face), { 3: 500, 6: 20, 7: 10, 19: 5, 20: 700, 23: -4000, 24: -4000, 49: -9000, 48: 100, 50: 300 });
  assert.deepEqual(mirrored(mirrored(face)), face);
});

test('what trembles is calmed; what moves arrives', () => {
  const calm = new Calm();
  let sum = 0, worst = 0;
  for (let k = 0; k < 60; k++) {
    const { 49: yaw } = calm.take(k / 30, { 49: k % 2 ? 400 : -400 });
    if (k > 20) worst = Math.max(worst, Math.abs(yaw));
  }
  assert.ok(worst < 200, `${worst} of 400`);
  for (let k = 60; k < 66; k++) sum = calm.take(k / 30, { 49: 40000 })[49];
  assert.ok(sum > 30000, `${sum} of 40000 after a fifth of a second`);
  assert.deepEqual(calm.take(9, { 49: 1 }), { 49: 1 }, 'after a gap it begins anew');
});

test('landmarks that say nothing give no nonsense', () => {
  const flat = Array.from({ length: 478 }, () => [0, 0, 0]);
  for (const value of Object.values(new FaceReader(flat).read(rest))) assert.ok(Number.isInteger(value));
  for (const value of Object.values(new FaceReader(rest).read(flat))) assert.ok(Number.isInteger(value));
});
