// SPDX-License-Identifier: MIT
// Parts of the lid hidden while the eye is open appear when it closes: pores, light and normals are then those of the closed lid.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { faceValues } from '../../../../web/element/face/face-mixer.mjs';
import { deform } from '../../../../web/element/head/mesh/deform.mjs';
import { loweredBy } from '../../../../web/element/head/shading/grain.mjs';
import { Drive, influencesOf } from '../../../../web/element/head/mesh/influences.mjs';
import { readModel } from '../../../../web/element/head/model/model.mjs';
import { Normals } from '../../../../web/element/head/mesh/normals.mjs';
import { bakeOcclusion } from '../../../../web/element/head/shading/occlusion.mjs';
import { fibres } from '../../../../web/element/head/shading/surfaces.mjs';
import { heads as folder } from '../../../lib/built-heads.mjs';

const names = fs.readdirSync(folder).filter((file) => file.endsWith('.json'));
const CLOSED = faceValues({ 19: 1024, 20: 1024 });

for (const name of names)
  test(`places the closed lids of ${name} correctly`, () => {
    const model = readModel(JSON.parse(fs.readFileSync(path.join(folder, name))));
    const part = model.parts.find((one) => one.name === 'skin');
    const drive = new Drive(model);
    const influences = influencesOf(part, drive);
    drive.slotValues = new Float32Array(drive.slots.length);
    drive.set(CLOSED);
    const { position, normal } = deform(part, influences, drive);
    const lowered = loweredBy(part, model.turns);
    const exact = new Normals({ ...part, position }).rest;
    let [moved, off, worst] = [0, 0, 0];
    for (let v = 0; v < part.vertices; v++) {
      assert.ok(Math.abs(part.position[3 * v + 1] - lowered[v] - position[3 * v + 1]) < 0.01, 'pores lie as on the closed lid');
      if (Math.abs(lowered[v]) < 1) continue;
      const cosine = [0, 1, 2].reduce((sum, k) => sum + normal[3 * v + k] * exact[3 * v + k], 0);
      worst = Math.max(worst, 1 - cosine);
      off += 1 - cosine;
      moved++;
    }
    assert.ok(moved > 100, `${moved} vertices`);
    assert.ok(off / moved < 0.002, `normals are off by ${off / moved} in the mean, ${worst} at worst`);
    assert.equal(loweredBy(model.parts.find((one) => one.name === 'hair'), model.turns), undefined);
  });

const MIDDLE = 4;
const flat = (height) => Float32Array.of(-20, height, 20, 20, height, 20, 20, height, -20, -20, height, -20, 0, height, 0);
const sheet = (height, seen = height) => ({
  position: flat(height), index: Uint16Array.of(0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4), shades: true,
  seen: { position: flat(seen), normal: flat(0).map((_, i) => Number(i % 3 === 1)) },
});

test('a fold casts no shadow on the surface that it unfolds to; distant parts do', () => {
  const sky = (...parts) => {
    const work = bakeOcclusion(parts);
    for (;;) {
      const { done, value } = work.next();
      if (done) return value[0][4 * MIDDLE];
    }
  };
  const [fold, other] = [sky(sheet(4, 0)), sky(sheet(0), sheet(4))];
  assert.ok(fold > other + 60, `under a fold ${fold}, under something else ${other}`);
  const [far, apart] = [sky(sheet(30, 0)), sky(sheet(0), sheet(30))];
  assert.ok(Math.abs(far - apart) < 25, `from afar ${far}, something else ${apart}`);
});

test('hair runs along strips in any orientation in the picture', () => {
  const strip = (uv) => ({ position: Float32Array.of(0, 0, 0, 60, 0, 0, 60, 9, 0, 0, 9, 0), uv: Float32Array.from(uv), index: Uint16Array.of(0, 1, 2, 0, 2, 3), smooth: null, vertices: 4 });
  const along = (uv) => Math.abs(fibres(strip(uv))[0]);
  assert.ok(along([0, 0, 0.6, 0, 0.6, 0.1, 0, 0.1]) > 0.99, 'a strip that lies');
  assert.ok(along([0, 0.6, 0, 0, 0.1, 0, 0.1, 0.6]) > 0.99, 'a strip that stands');
  assert.ok(along([0, 0, 0.3, 0, 0.3, 0.1, 0, 0.1]) < 0.01, 'a row of curls');
});
