// SPDX-License-Identifier: GPL-3.0-or-later
// The form of an old face, which is told its age: where it sinks, and that lids and lips go on closing. On our own heads.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat, textures } from '../../models/tools/portrait/images.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';
import { EYES, LOWER_LIP, OPPOSITE, UPPER_LIP } from '../../web/portrait/landmarks.mjs';
import { makeHead } from '../../web/portrait/portrait.mjs';
import { sagging, sunk } from '../../web/portrait/sag.mjs';

const built = fileURLToPath(new URL('../../build/', import.meta.url));
const read = (name) => JSON.parse(fs.readFileSync(path.join(built, name), 'utf8'));
const table = read('web/face-points.json');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-aged-'));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

test('faces sink from their late fifties on, by few millimetres, and the same on both sides', () => {
  assert.deepEqual([null, 30, 56, 80, 100].map(sunk), [0, 0, 0, 1, 1]);
  assert.equal(sagging(table.mara, 56), null);
  for (const [name, base] of Object.entries(table)) {
    const moved = (years, i) => [...sagging(base, years)(Float32Array.from(base.at[i]))];
    for (const i of [136, 205, 224].filter((one) => base.at[one] && base.at[OPPOSITE[one]])) {
      const [some, much, other] = [moved(66, i), moved(80, i), moved(80, OPPOSITE[i])];
      assert.ok(much[1] < -0.5 && much[1] < some[1] && some[1] < 0, `${name}, ${i}: ${some[1]} mm at 66, ${much[1]} at 80`);
      assert.ok(Math.abs(much[1] - other[1]) < 1, `${name}, ${i}: ${much[1]} and ${other[1]} mm`);
    }
    for (const i of [...EYES.left.upper, ...EYES.right.lower, ...UPPER_LIP.flat(), ...LOWER_LIP.flat()].filter((one) => base.at[one]))
      assert.ok(Math.hypot(...moved(90, i)) < 0.05, `${name}: landmark ${i} of a margin moves`);
    const all = readModel(read(`models/heads/${name}.json`)).parts.flatMap(({ position }) => [...position]);
    const by = sagging(base, 120)(Float32Array.from(all));
    for (let v = 0; v < by.length; v += 3) assert.ok(Math.hypot(by[v], by[v + 1], by[v + 2]) < 5.1, name);
  }
});

test('an old head passes the checks of a head, and differs in its form', async () => {
  const picture = await flat(path.join(built, 'models/heads/bruno.webp'));
  const view = { picture, landmarks: await (await openEye())(picture) };
  const make = async (age) => (await makeHead(read('models/heads/luca.json'), table.luca, [view], textures, { age })).head;
  const [young, old] = [await make(40), await make(82)];
  const skins = [young, old].map((head) => readModel(head).parts.find(({ name }) => name === 'skin').position);
  const most = skins[0].reduce((far, x, i) => Math.max(far, Math.abs(x - skins[1][i])), 0);
  assert.ok(most > 2 && most < 5.1, `${most} mm`);
  const file = path.join(folder, 'old.json');
  fs.writeFileSync(file, JSON.stringify(old));
  const checked = spawnSync('node', [fileURLToPath(new URL('../../models/tools/check-head.mjs', import.meta.url)), file], { encoding: 'utf8' });
  assert.equal(checked.status, 0, checked.stdout);
});
