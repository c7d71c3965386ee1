// SPDX-License-Identifier: GPL-3.0-or-later
// No mesh of a head goes through another: lips, teeth, tongue, lids, lashes, brows, eyeballs, hair, glasses, in every sound of every
// language with every basic emotion, as the program mixes them. All affects, both blends and finer steps: tests/bench/crossings.mjs.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { before, test } from 'node:test';
import { crossings } from '../../models/tools/lib/crossing.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { heads as folder } from '../lib/built-heads.mjs';
import { further } from '../lib/long.mjs';
import { EYE_FAPS, MOUTH_FAPS, Sweep } from '../lib/sweep.mjs';
import { apart, BASIC, sweepPoses } from '../lib/sweep-poses.mjs';

const names = fs.readdirSync(folder).filter((file) => file.endsWith('.json')).map((file) => file.slice(0, -5));
const read = (name) => unpack(JSON.parse(fs.readFileSync(path.join(folder, `${name}.json`))));

/** mm: of poses that are nearer to each other than this in every FAP one is looked at. */
const apartBy = (name) => (name === 'mara' ? 2 : 4);

let poses;
before(() => {
  poses = sweepPoses([null, ...BASIC], { once: true });
});

for (const name of names)
  test(`no mesh intersects another: ${name}`, ['mara', 'bruno'].includes(name) ? {} : further, async () => {
    const head = read(name);
    const sweep = await Sweep.of(head);
    const mouths = apart(poses.mouths, MOUTH_FAPS, apartBy(name), head);
    const eyes = apart(poses.eyes, EYE_FAPS, apartBy(name), head);
    assert.ok(mouths.length > 50 && eyes.length > 20, `${mouths.length} mouths, ${eyes.length} pairs of eyes`);
    const found = [...mouths.map((one) => [one, sweep.mouth(one.faps)]), ...eyes.map((one) => [one, sweep.eyes(one.faps)])];
    const wrong = found.flatMap(([{ what }, list]) => list.map(({ pair, count, mm, at }) => `${what}: ${pair}, ${count} edges, ${mm.toFixed(1)} mm, at ${at.map((x) => x.toFixed(0))}`));
    assert.deepEqual(wrong, []);
  });

test('finds intersections and their position', async () => {
  const square = (z, tilt = 0) => ({ position: Float64Array.of(-5, -5, z - tilt, 5, -5, z + tilt, 5, 5, z + tilt, -5, 5, z - tilt), index: Uint16Array.of(0, 1, 2, 0, 2, 3) });
  assert.equal(crossings(square(0), square(1), 0.5).count, 0);
  const { count, deepest, at } = crossings(square(0), square(0, 4), 0.5);
  assert.ok(count > 0 && deepest > 3 && deepest < 5 && Math.abs(at[0]) < 0.1 && Math.abs(at[2]) < 0.1, JSON.stringify({ count, deepest, at }));
  assert.equal(crossings(square(0), square(0, 0.3), 0.5).count, 0, 'a touch');
  const head = read('mara');
  const sweep = await Sweep.of(head);
  assert.deepEqual(sweep.mouth([]), []);
  assert.deepEqual(sweep.eyes([]), []);
  const pairs = (list) => list.map(({ pair }) => pair);
  const shut = { 3: 0, 4: 500, 8: 500, 9: 500, 5: 900, 10: 900, 11: 900, 16: -400 };
  assert.ok(pairs(sweep.mouth(shut)).some((pair) => /teeth_upper/.test(pair)), 'a lip that is drawn through the teeth');
  const over = { 19: 1500, 20: 1500, 21: 600, 22: 600 };
  assert.ok(pairs(sweep.eyes(over)).includes('lid_upper through lid_lower'), 'lids that pass each other');
});
