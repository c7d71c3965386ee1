// SPDX-License-Identifier: GPL-3.0-or-later
// The skin that moves with a lid when the mesh does not say it: from its margin to the fold, and no part of the brow, however far it hangs
// before a deep eye.
import assert from 'node:assert/strict';
import test from 'node:test';
import { lidsAndEyes } from '../../models/tools/import/actions/turns.mjs';

const RADIUS = 17;
const SIDES = { l: 1, r: -1 };
const fdp = {};
for (const [side, sign] of Object.entries(SIDES)) {
  const at = (x, y, z) => [sign * x, y, z];
  const names = side === 'l' ? ['3.1', '3.3', '3.5', '4.1', '4.3', '4.5'] : ['3.2', '3.4', '3.6', '4.2', '4.4', '4.6'];
  [at(30, 7, 14), at(30, -7, 14), at(30, 0, RADIUS), at(16, 13, 23), at(30, 16, 24), at(46, 12, 20)].forEach((place, i) => (fdp[names[i]] = place));
}
const ball = (sign) => Float64Array.from({ length: 300 }, (_, i) => {
  const [v, k] = [Math.floor(i / 3), i % 3];
  const [a, b] = [(v * 2.4) % (2 * Math.PI), Math.acos(1 - (2 * (v + 0.5)) / 100)];
  return [sign * 30 + RADIUS * Math.sin(b) * Math.cos(a), RADIUS * Math.cos(b), RADIUS * Math.sin(b) * Math.sin(a)][k];
});
const PLACES = { margin: [0, 7, 14], lid: [0, 9, 16], 'inner end of the brow': [-13, 13.5, 23], brow: [0, 16, 24], 'below the brow': [0, 14.5, 21] };

for (const [side, sign] of Object.entries(SIDES))
  test(`moves the ${side === 'l' ? 'left' : 'right'} lid without its brow`, () => {
    const position = Float64Array.from(Object.values(PLACES).flatMap(([x, y, z]) => [sign * (30 + x), y, z]));
    const skin = { name: 'skin', position, targets: {} };
    const parts = [skin, { name: 'eye_l', position: ball(1), targets: {} }, { name: 'eye_r', position: ball(-1), targets: {} }];
    const { shares } = lidsAndEyes(parts, fdp);
    const { vertices, weights } = shares(skin).find(({ turn }) => turn === `lid_${side}_upper`);
    const goes = Object.fromEntries(Object.keys(PLACES).map((name, v) => [name, weights[vertices.indexOf(v)] ?? 0]));
    assert.ok(goes.margin === 1 && goes.lid > 0.9, JSON.stringify(goes));
    for (const name of ['brow', 'below the brow', 'inner end of the brow']) assert.equal(goes[name], 0, JSON.stringify(goes));
  });
