// SPDX-License-Identifier: MIT
// The margins of the lids, for the shadow on the eyeball: they are where the feature points are, and meet when the eye is closed.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { faceValues } from '../../../../web/element/face/face-mixer.mjs';
import { lidsAt, lidsOf } from '../../../../web/element/head/shading/lids.mjs';
import { readModel } from '../../../../web/element/head/model/model.mjs';
import { heads as folder } from '../../../lib/built-heads.mjs';

const names = fs.readdirSync(folder).filter((file) => file.endsWith('.json'));
const value = (line, x) => line.reduce((sum, factor, power) => sum + factor * x ** power, 0);

for (const name of names)
  test(`finds the lids of ${name}`, () => {
    const model = readModel(JSON.parse(fs.readFileSync(path.join(folder, name))));
    for (const [side, upper, lower] of [['l', '3.1', '3.3'], ['r', '3.2', '3.4']]) {
      const eye = model.parts.find((part) => part.name === `eye_${side}`);
      const center = model.turns[eye.turns[0].turn].pivot;
      const radius = Math.hypot(...center.map((x, k) => x - eye.position[k]));
      const lids = lidsOf(model, center, radius);
      const rest = lidsAt(lids, faceValues({}));
      for (const [line, point] of [[rest.upper, upper], [rest.lower, lower]]) {
        const [x, y, z] = model.fdp[point].map((q, k) => q - center[k]);
        const off = (value(line, x) - Math.atan2(y, z)) * radius;
        assert.ok(Math.abs(off) < 0.1, `${side}, ${point}: ${off.toFixed(2)} mm`);
      }
      // Without the feature points the margins are found by the mesh alone: the same to about a millimetre.
      const meshed = lidsOf({ ...model, fdp: {} }, center, radius);
      for (const which of ['upper', 'lower'])
        for (const x of [-8, 0, 8]) {
          const off = (value(meshed[which], x) - value(lids[which], x)) * radius;
          assert.ok(Math.abs(off) < 1.2, `${side}, ${which} at ${x}: ${off.toFixed(2)} mm`);
        }
      const closed = lidsAt(lids, faceValues({ 19: 1024, 20: 1024 }));
      for (const x of [-8, 0, 8]) assert.ok(Math.abs(value(closed.upper, x) - value(rest.lower, x)) < 1e-3, 'the upper one comes to the lower one');
      const half = lidsAt(lids, faceValues({ 19: 512, 20: 512 }));
      assert.ok(value(half.upper, 0) < value(rest.upper, 0) - 0.1 && value(half.upper, 0) > value(rest.lower, 0) + 0.1);
    }
  });

test('a head without lids has no shade on its eyes', () => {
  const { upper, lower } = lidsAt(lidsOf({ parts: [], turns: [], fdp: {} }, [31, 0, 0], 12), faceValues({ 19: 1024 }));
  assert.ok(Number.isFinite(upper[0]) && Number.isFinite(lower[0]));
  const open = lidsAt(lidsOf({ parts: [], turns: [], fdp: {} }, [31, 0, 0], 12), faceValues({}));
  assert.ok(open.upper[0] > Math.PI && open.lower[0] < -Math.PI);
});
