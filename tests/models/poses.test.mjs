// SPDX-License-Identifier: GPL-3.0-or-later
// Learns a person's own poses from pictures: one of our heads, with a smile that no tool knows, as pictures. For the accuracy of all poses
// see tests/bench/poses.mjs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { FAPS } from '../../models/tools/lib/faps.mjs';
import { pose, unitLength, unpack } from '../../models/tools/lib/deform.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat } from '../../models/tools/portrait/images.mjs';
import { VISEMES_TAKEN, viseme } from '../../web/portrait/actions/poses.mjs';
import { film, headOf } from '../lib/film.mjs';
import { othersOf, otherwise, posesOf, samePlaces, withHabits } from '../lib/habits.mjs';
import { violations } from '../lib/schema.mjs';

const tool = fileURLToPath(new URL('../../models/tools/portrait/make-portrait.mjs', import.meta.url));
const built = fileURLToPath(new URL('../../build/', import.meta.url));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-poses-'));
const [drawn, poses] = ['drawn', 'poses'].map((name) => path.join(folder, name));
const run = (...args) => spawnSync('node', [tool, path.join(drawn, '0001.png'), '--like', 'mara', ...args], { encoding: 'utf8' });
const truth = withHabits(headOf('luca'));
let made;

before(async () => {
  const { smile } = posesOf();
  await film(truth, [{}, { ...smile, 49: 2000 }], drawn, { height: 480 });
  fs.mkdirSync(poses);
  const put = (from, name) => fs.copyFileSync(path.join(drawn, from), path.join(poses, name));
  put('0002.png', 'smile.png');
  put('0001.png', 'open.png'); // it is not
  put('0001.png', 'Jaw_Front.png');
  put('0001.png', 'wink.png');
  fs.writeFileSync(path.join(poses, 'sad.png'), 'GIF89a no picture');
  made = run('--poses', poses, '-o', path.join(folder, 'own.json'));
});
after(() => fs.rmSync(folder, { recursive: true, force: true }));

test('applies a smile to the face; reports unusable pictures with a reason, ignores unknown names', (t) => {
  t.diagnostic(made.stdout);
  assert.equal(made.status, 0, made.stderr);
  assert.match(made.stdout, /wink\.png: left out/);
  assert.match(made.stdout, /open\.png: unfit: it does not show this pose/);
  assert.match(made.stdout, /Jaw_Front\.png: unfit: the front does not show/);
  assert.match(made.stdout, /sad\.png: unfit: this is no picture/);
  assert.match(made.stdout, /1 poses, \d+ actions of its own/);
  assert.equal(violations('head-model', JSON.parse(fs.readFileSync(path.join(folder, 'own.json'), 'utf8'))), null);
});

test('half a smile, in no picture, comes closer to the person\'s; feature points move as in MPEG-4, and closed lips stay closed', async (t) => {
  const json = JSON.parse(fs.readFileSync(path.join(folder, 'own.json'), 'utf8'));
  const mara = JSON.parse(fs.readFileSync(path.join(built, 'models/heads/mara.json'), 'utf8'));
  const plain = { ...json, parts: json.parts.map((part) => ({ ...part, moves: part.moves.slice(0, mara.parts.find(({ name }) => name === part.name).moves.length) })) };
  const [own, base] = [json, plain].map(unpack);
  const table = JSON.parse(fs.readFileSync(path.join(built, 'web/face-points.json'), 'utf8'));
  const places = samePlaces(own, truth, table.mara, table.luca, await (await openEye())(await flat(path.join(drawn, '0001.png'))));
  const [is, was] = [own, base].map((head) => otherwise(head, truth, othersOf(truth)['half a smile'], places).rms);
  t.diagnostic(`off by ${was.toFixed(3)} mm before, ${is.toFixed(3)} now`);
  assert.ok(is < 0.97 * was, `${was} -> ${is}`);
  const gone = (head, point, faps) => {
    const skin = head.parts.find(({ name }) => name === 'skin');
    let at = 0;
    const far = (v) => Math.hypot(...point.map((x, k) => skin.position[3 * v + k] - x));
    for (let v = 1; v < skin.position.length / 3; v++) if (far(v) < far(at)) at = v;
    return [...pose(head, skin, faps).subarray(3 * at, 3 * at + 3)].map((x, k) => x - skin.position[3 * at + k]);
  };
  const { smile } = posesOf();
  for (const fap of [12, 13, 53, 54, 59, 60, 41, 42]) {
    const { point, direction } = FAPS[fap];
    const mm = gone(own, own.fdp[point], { [fap]: 300 }).reduce((sum, x, k) => sum + x * direction[k], 0);
    const wanted = 300 * unitLength(own, fap);
    assert.ok(Math.abs(mm - wanted) < 0.02 * wanted + 0.05, `FAP ${fap}: ${mm} mm of ${wanted}`);
  }
  for (const [upper, lower] of [['2.2', '2.3'], ['2.6', '2.8'], ['2.7', '2.9']]) {
    const [a, b] = [upper, lower].map((point) => gone(own, own.fdp[point], smile));
    const [c, d] = [upper, lower].map((point) => gone(base, base.fdp[point], smile));
    const apart = a.map((x, k) => x - b[k] - (c[k] - d[k])); // upward: a gap; downward: the lips press
    assert.ok(apart[1] < 0.05 && Math.hypot(...apart) < 0.3, `${upper} and ${lower} part: ${apart}`);
  }
});

test('reports a missing pose folder, a single picture without --times, and --times without --poses', () => {
  assert.match(run('--poses', path.join(folder, 'none'), '-o', path.join(folder, 'x.json')).stderr, /none: there is none/);
  assert.match(run('--poses', path.join(drawn, '0001.png'), '-o', path.join(folder, 'x.json')).stderr, /--times/);
  assert.equal(run('--times', 'x.json', '-o', path.join(folder, 'x.json')).status, 2);
  assert.ok(!fs.existsSync(path.join(folder, 'x.json')));
});

test('pose mouths match the engines\' visemes', () => {
  const { poses: made } = JSON.parse(fs.readFileSync(new URL('../../models/pictures/poses.json', import.meta.url), 'utf8'));
  for (const name of VISEMES_TAKEN) {
    const faps = Object.entries(made.find((one) => one.name === name).faps).filter(([fap]) => FAPS[fap].name.match(/tongue/) === null);
    assert.deepEqual(viseme(name), Object.fromEntries(faps), name);
  }
});
