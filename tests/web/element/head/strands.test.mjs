// SPDX-License-Identifier: GPL-3.0-or-later
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { sliced } from '../../../../web/element/head/mesh/slices.mjs';
import { strands } from '../../../../web/element/head/mesh/strands.mjs';

test('distinguishes strands narrower than a point from locks of any length', () => {
  const strip = (x, width, length) => [x, 0, 0, x + width, 0, 0, x, length, 0, x + width, length, 0];
  const part = {
    position: Float32Array.from([...strip(0, 1.5, 600), ...strip(20, 40, 600), ...strip(80, 4, 30)]),
    index: Uint16Array.from([0, 4, 8].flatMap((v) => [v, v + 1, v + 2, v + 2, v + 1, v + 3])),
    vertices: 12,
  };
  const loose = (mm) => [...strands(part, mm)].filter((_, v) => v % 4 === 0);
  assert.deepEqual(loose(1), [0, 0, 0]);
  assert.deepEqual(loose(2.5), [1, 0, 0]);
  assert.deepEqual(loose(5), [1, 0, 1]);
});

/** How often 600 steps of a millisecond let a page run that needs the given time each. */
async function rests(pageMs) {
  let [time, count] = [0, 0];
  const steps = (function* () {
    for (let i = 0; i < 600; i++) yield time++;
    return 'done';
  })();
  const clock = { now: () => time, rest: async () => { time += pageMs; count++; } };
  assert.equal(await sliced(steps, null, clock), 'done');
  return count;
}

test('long work takes longer slices on a slow page, within a limit', async () => {
  const [quick, slow, stuck] = [await rests(4), await rests(100), await rests(5000)];
  assert.ok(quick >= 40, `${quick} rests`);
  assert.ok(slow > 10 && slow < 20, `${slow} rests`);
  assert.equal(stuck, 4);
});
