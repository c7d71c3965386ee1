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
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
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
  ['does on the left what it does on the right', check.checkSymmetry],
];
for (const [name, run] of checks) test(name, () => assert.deepEqual(run(head), []));

test('keeps to the schema', () => assert.equal(violations('head-model', json), null));

test('is small enough, and the packed file holds the same', () => {
  const packed = fs.readFileSync(`${file}.gz`);
  assert.ok(packed.length <= check.MOST_BYTES, `${packed.length} bytes`);
  assert.equal(packed.readUInt32LE(4), 0, 'time stamp');
  assert.ok(zlib.gunzipSync(packed).equals(text));
});

test('stays out of its own way: no tooth comes through the skin when she speaks', () => {
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
  const chin = nearest(skin, head.fdp['2.10']),
    lip = nearest(skin, head.fdp['8.2']);
  const teeth = pose(
    head,
    head.parts.find((p) => p.name === 'teeth_lower'),
    a,
  );
  let front = -Infinity;
  for (let i = 0; i < teeth.length; i += 3)
    if (Math.abs(teeth[i]) < 6 && teeth[i + 1] > moved[chin * 3 + 1]) front = Math.max(front, teeth[i + 2]);
  for (const [name, v] of [
    ['chin', chin],
    ['lower lip', lip],
  ]) {
    assert.ok(
      moved[v * 3 + 2] > front + 1,
      `${name} at ${moved[v * 3 + 2].toFixed(1)} mm, teeth at ${front.toFixed(1)} mm`,
    );
  }
});

test('is built the same every time', () => {
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

test('a recipe with a mistake is refused with a reason', () => {
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

function nearest(part, place) {
  let best = 0,
    least = Infinity;
  for (let v = 0; v < part.position.length / 3; v++) {
    const d = Math.hypot(...place.map((x, k) => x - part.position[v * 3 + k]));
    if (d < least) [best, least] = [v, d];
  }
  return best;
}
