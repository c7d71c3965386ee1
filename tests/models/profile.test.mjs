// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures from the side: our own heads, whose shape is known, photographed from the front and from both sides, and made on another head of ours.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test, { after, before } from 'node:test';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { align } from '../../web/portrait/align.mjs';
import { fitShape } from '../../web/portrait/fit.mjs';
import { asProfile } from '../../web/portrait/portrait.mjs';
import { outlinesOf, withProfiles } from '../../web/portrait/profile.mjs';
import { models } from '../lib/built-heads.mjs';
import { photograph, writePng } from '../lib/drawn-photographs.mjs';
import { further } from '../lib/long.mjs';

const build = process.env.FACCIA_BUILD ?? new URL('../../build', import.meta.url).pathname;
const table = JSON.parse(fs.readFileSync(path.join(process.env.FACCIA_WEB ?? path.join(build, 'web'), 'face-points.json'), 'utf8'));
const heads = path.join(models, 'heads');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-profile-'));
const at = (name) => path.join(folder, name);
const PROFILE = [151, 9, 8, 168, 6, 197, 195, 5, 4, 1, 19, 94, 2, 164, 0, 17, 18, 200, 199, 175, 152];
const EYES = [33, 133, 362, 263];
const WALL = (column, row) => 170 + 0.12 * column - 0.08 * row + 3 * Math.sin(7.3 * column + 3.1 * row); // a lamp from the right, and noise
const people = {};

before(async () => {
  const eye = await openEye();
  for (const name of ['bruno', 'mei', 'samuel']) {
    const front = await photograph(heads, name, 0);
    const sides = [await photograph(heads, name, 90, WALL), await photograph(heads, name, -90)];
    people[name] = { front, sides, landmarks: await eye(front) };
  }
});
after(() => fs.rmSync(folder, { recursive: true }));

/** Root mean square of what the profile's points miss in depth, mm, laid onto the true ones by it and the corners of the eyes. */
function missed(target, name) {
  const truth = table[name].at;
  const which = [...PROFILE, ...EYES].filter((i) => target[i] && truth[i]);
  const { apply } = align(target.map((p) => p ?? [0, 0, 0]), truth.map((p) => p ?? [0, 0, 0]), which);
  const off = PROFILE.filter((i) => which.includes(i)).map((i) => apply(target[i])[2] - truth[i][2]);
  return Math.sqrt(off.reduce((sum, x) => sum + x * x, 0) / off.length);
}

test('both profiles bring the depth of a face closer to the true one than the front alone', further, (t) => {
  const figures = [];
  for (const [name, base] of [['bruno', 'mei'], ['bruno', 'luca'], ['mei', 'luca'], ['mei', 'bruno'], ['samuel', 'mei'], ['samuel', 'luca']]) {
    const { landmarks, sides } = people[name];
    const { target } = fitShape([{ landmarks }], table[base]);
    const three = withProfiles(target, sides.map((picture) => ({ picture, outlines: outlinesOf(picture) })));
    const [one, all] = [missed(target, name), missed(three, name)];
    figures.push([one, all]);
    t.diagnostic(`${name} on ${base}: ${one.toFixed(2)} mm from one picture, ${all.toFixed(2)} from three`);
    assert.ok(all < 0.9 * one, `${name} on ${base}: ${one} ${all}`);
    three.forEach((p, i) => p && assert.deepEqual(p.slice(0, 2), target[i].slice(0, 2)));
  }
  const mean = (k) => figures.reduce((sum, one) => sum + one[k] / figures.length, 0);
  t.diagnostic(`in the mean ${mean(0).toFixed(2)} and ${mean(1).toFixed(2)} mm`);
  assert.ok(mean(1) < 0.75 * mean(0));
});

test('finds a profile in either direction, and rejects other pictures', () => {
  const tip = ({ points }) => points.reduce((best, p) => (Math.abs(p[0] - 150) > Math.abs(best[0] - 150) ? p : best));
  const [one, other] = people.mei.sides.map((picture) => asProfile(picture, table));
  assert.ok((tip(one)[0] - 150) * (tip(other)[0] - 150) < 0, 'they look to either side');
  const blank = (inside) => {
    const data = new Uint8ClampedArray(4 * 300 * 390).fill(200);
    for (let v = 0; v < 390; v++) for (let u = 0; u < 300; u++) if (inside(u, v)) data.set([90, 60, 50, 255], 4 * (300 * v + u));
    return { width: 300, height: 390, data };
  };
  for (const [what, inside] of Object.entries({ nothing: () => false, all: () => true, ball: (u, v) => Math.hypot(u - 150, v - 200) < 110, box: (u, v) => u > 60 && u < 240 && v > 90 }))
    assert.throws(() => asProfile(blank(inside), table), { code: 'no_face' }, what);
});

test('the tool accepts profiles with a front view, and rejects them alone', async () => {
  const files = ['front.png', 'left.png', 'right.png'].map(at);
  const { front, sides } = people.mei;
  for (const [i, picture] of [front, ...sides].entries()) await writePng(picture, files[i]);
  const make = (...words) => spawnSync(process.execPath, [new URL('../../models/tools/portrait/make-portrait.mjs', import.meta.url).pathname, ...words, '--like', 'luca', '--heads', heads,
    '--points', path.join(process.env.FACCIA_WEB ?? path.join(build, 'web'), 'face-points.json')], { encoding: 'utf8' });
  const { status, stdout, stderr } = make(...files, '-o', at('mei.json'));
  assert.equal(status, 0, stderr);
  assert.match(stdout, /0 pictures half from the side, 2 from the side/);
  const alone = make(files[1], '-o', at('never.json'));
  assert.equal(alone.status, 1);
  assert.match(alone.stderr, /one picture must show the face from the front/);
  assert.ok(!fs.existsSync(at('never.json')));
});
