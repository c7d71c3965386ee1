// SPDX-License-Identifier: GPL-3.0-or-later
// A person's own actions from pictures of poses: Bruno, whose cheeks do more than anybody's, is put on Mara's base with and without his poses.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { headMoves } from '../../models/tools/portrait/own-actions.mjs';
import { FREE } from '../../models/tools/portrait/pose-moves.mjs';
import { POSES, posesIn } from '../../models/tools/portrait/poses.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { film, headOf } from '../lib/film.mjs';
import { violations } from '../lib/schema.mjs';

const built = fileURLToPath(new URL('../../build/', import.meta.url));
const tool = (name) => fileURLToPath(new URL(`../../models/tools/${name}`, import.meta.url));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-poses-'));
after(() => fs.rmSync(folder, { recursive: true, force: true }));
const table = JSON.parse(fs.readFileSync(path.join(built, 'web/face-points.json'), 'utf8'));
const SHOWN = ['smile', 'brows-up'];

/** The skin's vertex at each landmark. */
function verticesOf(head, at) {
  const { position } = head.parts.find(({ name }) => name === 'skin');
  return at.map((p) => {
    if (!p) return null;
    let [best, least] = [0, Infinity];
    for (let v = 0; v < position.length / 3; v++) {
      const far = Math.hypot(position[3 * v] - p[0], position[3 * v + 1] - p[1], position[3 * v + 2] - p[2]);
      if (far < least) [best, least] = [v, far];
    }
    return best;
  });
}

/** Bruno, whose cheeks are lifted twice as far where they are free, and whose brows go outward as they rise. */
function bruno() {
  const head = headOf('bruno');
  const skin = head.parts.find(({ name }) => name === 'skin');
  for (const move of skin.moves) {
    if ([41, 42].includes(move.fap)) move.deltas = move.deltas.map((x) => 2 * x);
    if ([33, 34, 35, 36].includes(move.fap)) move.deltas = move.deltas.map((x, i) => (i % 3 ? x : x + 0.8 * Math.sign(move.fap % 2 ? 1 : -1) * Math.abs(move.deltas[i + 1])));
  }
  return head;
}

test('poses of Bruno put on Mara\'s base: the head moves more as he does, and lips and lids close as before', async (t) => {
  const person = bruno();
  await film(person, [{}, ...SHOWN.map((pose) => POSES[pose].faps)], folder, { height: 400 });
  const poses = path.join(folder, 'poses');
  fs.mkdirSync(poses);
  SHOWN.forEach((pose, i) => fs.renameSync(path.join(folder, `000${i + 2}.png`), path.join(poses, `${pose === 'smile' ? 'Smile' : 'brows_up'}.png`)));
  const make = (name, ...more) => {
    const out = path.join(folder, `${name}.json`);
    const made = spawnSync('node', [tool('portrait/make-portrait.mjs'), path.join(folder, '0001.png'), '-o', out, '--like', 'mara', ...more], { encoding: 'utf8' });
    assert.equal(made.status, 0, made.stderr);
    return { out, said: made.stdout, json: JSON.parse(fs.readFileSync(out, 'utf8')) };
  };
  const [without, own] = [make('without'), make('own', '--poses', poses)];
  for (const pose of SHOWN) assert.match(own.said, new RegExp(`poses .*${pose} \\d\\.\\d`));
  assert.equal(violations('head-model', own.json), null);
  const checked = spawnSync('node', [tool('check-head.mjs'), own.out], { encoding: 'utf8' });
  assert.equal(checked.status, 0, checked.stdout);
  const his = verticesOf(person, table.bruno.at);
  const theirs = verticesOf(headOf('mara'), table.mara.at); // the same mesh
  for (const pose of SHOWN) {
    const wanted = headMoves(person, his, POSES[pose].faps);
    const off = ({ json }) => {
      const amount = Number(new RegExp(`${pose} (\\d\\.\\d)`).exec(own.said)[1]);
      const faps = Object.fromEntries(Object.entries(POSES[pose].faps).map(([fap, value]) => [fap, value * amount]));
      const [moves, plain] = [faps, POSES[pose].faps].map((values) => headMoves(unpack(json), theirs, values));
      const rms = (list) => Math.sqrt(FREE.reduce((sum, i) => sum + (wanted[i] && list[i] ? (wanted[i][0] - list[i][0]) ** 2 + (wanted[i][1] - list[i][1]) ** 2 : 0), 0) / FREE.length);
      return Math.min(rms(moves), rms(plain)); // at its own amount of the pose, or at the pose's
    };
    const [before, now] = [off(without), off(own)];
    t.diagnostic(`${pose}: ${before.toFixed(2)} mm rms from his, then ${now.toFixed(2)} mm`);
    assert.ok(now < 0.9 * before, `${pose}: ${now.toFixed(2)} of ${before.toFixed(2)} mm`);
  }
});

test('folders that are none: each is told with its picture', () => {
  const empty = path.join(folder, 'empty');
  fs.mkdirSync(empty);
  assert.throws(() => posesIn(empty), { code: 'no_pose', message: /there are no pictures of poses \(brows-up\.jpg, / });
  fs.writeFileSync(path.join(empty, 'neutral.jpg'), '');
  assert.throws(() => posesIn(empty), { code: 'no_pose' });
  fs.writeFileSync(path.join(empty, 'smile.jpg'), '');
  fs.writeFileSync(path.join(empty, 'Smile.png'), '');
  assert.throws(() => posesIn(empty), { code: 'no_pose', message: /smile is there twice/ });
  fs.rmSync(path.join(empty, 'Smile.png'));
  const refused = spawnSync('node', [tool('portrait/make-portrait.mjs'), '/usr/lib/python3/dist-packages/skimage/data/astronaut.png', '-o', path.join(folder, 'x.json'), '--poses', empty], { encoding: 'utf8' });
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /(neutral|smile)\.jpg: this is no picture that can be read/);
  assert.ok(!fs.existsSync(path.join(folder, 'x.json')));
  fs.writeFileSync(path.join(empty, 'grin.jpg'), '');
  assert.throws(() => posesIn(empty), { code: 'no_pose', message: /grin\.jpg: no pose is called grin: neutral, brows-up/ });
});
