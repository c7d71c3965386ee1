// SPDX-License-Identifier: GPL-3.0-or-later
// The built default head against protocol/head-model.md.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import zlib from 'node:zlib';
import * as check from '../../models/tools/lib/check.mjs';
import { mouthFigures } from '../../models/tools/lib/anatomy.mjs';
import { crossings } from '../../models/tools/lib/crossing.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { long } from '../lib/long.mjs';
import { violations } from '../lib/schema.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const file = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'models/heads/mara.json');
const text = fs.readFileSync(file);
const json = JSON.parse(text);
const head = unpack(json);

const checks = [
  ['has all parts, and all its numbers point somewhere', check.checkParts],
  ['has no cracks', check.checkCracks],
  ['moves every feature point as its FAP says', check.checkFeaturePoints],
  ['moves a lip as one when both contours get the same value', check.checkLipsMoveAsOne],
  ['has closed lips on the neutral face', check.checkNeutral],
  ['has lids that close', check.checkEyelids],
  ['bites as people do', check.checkBite],
  ['shows its incisors at rest as its sex and age want', check.checkTeethShown],
  ['has teeth as wide as the mouth wants', check.checkArch],
  ['has its tongue behind the teeth', check.checkTongue],
  ['does on the left what it does on the right', check.checkSymmetry],
];
for (const [name, run] of checks) test(name, () => assert.deepEqual(run(head), []));

test('an opening that is higher in the middle than at the sides is round below', () => {
  const skin = head.parts.find(({ name }) => name === 'skin');
  const open = pose(head, skin, { 5: -400, 10: -150, 11: -150 });
  /** mm by which the lower lip's inner contour sinks between two distances from the middle. */
  const sunk = (from, to) => {
    let most = 0;
    for (let v = 0; v < open.length; v += 3)
      if (Math.abs(skin.position[v]) >= from && Math.abs(skin.position[v]) <= to) most = Math.max(most, skin.position[v + 1] - open[v + 1]);
    return most;
  };
  const middle = sunk(0, 0.1);
  assert.ok(sunk(2, 3.2) > 0.9 * middle, `${sunk(2, 3.2)} beside ${middle}`);
  assert.ok(sunk(4.5, 6) > 0.72 * middle, `${sunk(4.5, 6)} beside ${middle}`);
});

test('visible teeth depend on sex and age, unless the recipe overrides them', () => {
  const shown = (name) => {
    const { upperShown, lowerShown } = mouthFigures({ shape: { [`macrodetails/${name}`]: 1 } });
    return [upperShown, lowerShown];
  };
  const [girl, woman, oldWoman, man, oldMan] = ['female-child', 'female-young', 'female-old', 'male-young', 'male-old'].map((name) => shown(`asian-${name}`));
  assert.deepEqual(girl, [4.5, 0.5]);
  assert.ok(woman[0] > 3.4 && woman[0] < 4 && woman[1] === 0.5, woman.join());
  assert.deepEqual(oldWoman, [1.3, 2.2]);
  assert.ok(man[0] > 1.9 && man[0] < 2.5 && man[1] < 1.3, man.join());
  assert.deepEqual(oldMan, [0.6, 3.1]);
  assert.equal(mouthFigures({ shape: {}, mouth: { sex: 'male', age: 30 } }).upperShown, 1.9);
  assert.equal(mouthFigures({ shape: {}, mouth: { upperShown: 2.7 } }).upperShown, 2.7);
});

test('finds a misplaced tooth or tongue', () => {
  const moved = (name, axis, mm) => ({
    ...head,
    parts: head.parts.map((p) => (p.name === name ? { ...p, position: p.position.map((x, i) => (i % 3 === axis ? x + mm : x)) } : p)),
  });
  assert.ok(check.checkTeethShown(moved('teeth_upper', 1, 4)).length);
  assert.ok(check.checkBite(moved('teeth_lower', 2, -6)).length);
  assert.ok(check.checkTongue({ ...head, fdp: { ...head.fdp, 6.1: head.fdp['2.2'] } }).length);
});

test('matches the schema', () => assert.equal(violations('head-model', json), null));

test('is small enough, and the packed file holds the same', () => {
  const packed = fs.readFileSync(`${file}.gz`);
  assert.ok(packed.length <= check.MOST_BYTES, `${packed.length} bytes`);
  assert.equal(packed.readUInt32LE(4), 0, 'time stamp');
  assert.ok(zlib.gunzipSync(packed).equals(text));
});

test('teeth do not penetrate the skin during speech', () => {
  const skin = head.parts.find((p) => p.name === 'skin');
  const a = {
    3: 550,
    4: -330,
    8: -330,
    9: -330,
    51: -330,
    55: -330,
    56: -330,
    5: -600,
    10: -600,
    11: -600,
    52: -600,
    57: -600,
    58: -600,
  };
  const moved = pose(head, skin, a);
  const teeth = head.parts.find((p) => p.name === 'teeth_lower');
  const low = { position: pose(head, teeth, a), index: teeth.index };
  const before = (x, y) => Math.abs(x) < 30 && y > head.fdp['2.1'][1] - 15;
  const { count, deepest } = crossings({ position: moved, index: skin.index }, low, 1.2, before);
  assert.equal(count, 0, `${count} edges, ${deepest.toFixed(1)} mm deep`);
});

test('is built identically every time', { skip: !long && 'takes minutes: FACCIA_LONG=1' }, () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'head-'));
  try {
    const again = path.join(folder, 'again.json');
    const tool = path.join(root, 'models/tools/build-head.mjs');
    const run = spawnSync(process.execPath, [tool, path.join(root, 'models/heads/mara.json'), again], {
      encoding: 'utf8',
    });
    assert.equal(run.status, 0, run.stderr);
    assert.ok(fs.readFileSync(again).equals(text), 'the JSON differs');
    assert.ok(
      fs.readFileSync(`${again}.gz`).equals(fs.readFileSync(`${file}.gz`)),
      'the packed file differs',
    );
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
});

test('rejects a recipe with a mistake, with a reason', () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'head-'));
  try {
    const recipe = JSON.parse(fs.readFileSync(path.join(root, 'models/heads/mara.json'), 'utf8'));
    recipe.shape['nose/nose-of-brass'] = 1;
    fs.writeFileSync(path.join(folder, 'wrong.json'), JSON.stringify(recipe));
    const tool = path.join(root, 'models/tools/build-head.mjs');
    const run = spawnSync(
      process.execPath,
      [tool, path.join(folder, 'wrong.json'), path.join(folder, 'out.json')],
      { encoding: 'utf8' },
    );
    assert.notEqual(run.status, 0);
    assert.match(run.stderr, /nose\/nose-of-brass/);
    assert.ok(!fs.existsSync(path.join(folder, 'out.json')));
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
});
