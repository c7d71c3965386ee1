// SPDX-License-Identifier: GPL-3.0-or-later
// The definitions of the avatar shapes: complete, as symmetric as faces, and the computed ones up to date.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { moods, visemes } from '../../models/tools/avatar/make-shapes.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const program = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'server/cli/faccia');
const read = (name) => JSON.parse(fs.readFileSync(path.join(root, 'models', name)));
const { faps: table } = JSON.parse(fs.readFileSync(path.join(root, 'protocol/fap-table.json')));
const { shapes } = read('shapes/arkit.json');

test('has fifty-two shapes, each with its reason and within the FAP ranges', () => {
  assert.equal(Object.keys(shapes).length, 52);
  for (const [name, { faps, why }] of Object.entries(shapes)) {
    assert.ok(why.length > 5, name);
    for (const [fap, value] of Object.entries(faps)) {
      const { min, max } = table.find(({ number }) => number === Number(fap));
      assert.ok(value && value >= min && value <= max, `${name}: FAP ${fap}`);
    }
  }
});

test('the right shape of a pair mirrors the left one', () => {
  const paired = new Map([6, 8, 10, 12, 19, 21, 23, 25, 31, 33, 35, 37, 39, 41, 53, 55, 57, 59, 61].flatMap((n) => [[n, n + 1], [n + 1, n]]));
  const turned = new Set([15, 23, 24, 43, 49, 50, 64]);
  const mirror = (faps) => Object.fromEntries(Object.entries(faps).map(([fap, value]) => [paired.get(Number(fap)) ?? fap, turned.has(Number(fap)) ? -value : value]));
  for (const [name, { faps }] of Object.entries(shapes)) {
    const other = name.replace(/Left$|Right$/, (side) => (side === 'Left' ? 'Right' : 'Left'));
    assert.deepEqual(shapes[other].faps, mirror(faps), name);
  }
});

test('closures close: mouthClose undoes jawOpen, a blink joins the lids, and no other closed part opens', () => {
  const gap = (name, [upper, lower]) => -(shapes[name].faps[upper] ?? 0) - (shapes[name].faps[lower] ?? 0);
  const opens = ['jawOpen', 'mouthFunnel', 'mouthLowerDownLeft', 'mouthLowerDownRight', 'mouthUpperUpLeft', 'mouthUpperUpRight'];
  for (const pair of [[4, 5], [8, 10], [9, 11]]) {
    assert.equal(gap('jawOpen', pair) + gap('mouthClose', pair), 0);
    for (const name of Object.keys(shapes)) assert.ok(gap(name, pair) <= 0 || opens.includes(name), name);
  }
  assert.equal(shapes.eyeBlinkLeft.faps[19] + shapes.eyeBlinkLeft.faps[21], 1024);
});

test('the visemes and moods match what faccia shows', () => {
  assert.deepEqual(Object.fromEntries(Object.entries(read('shapes/visemes.json').visemes).map(([name, { faps }]) => [name, faps])), visemes(program));
  assert.deepEqual(read('shapes/moods.json').moods, moods(program));
});

test('the poses of the sets of pictures match what the engines show', () => {
  const made = spawnSync('node', [path.join(root, 'models/tools/make-poses.mjs'), program], { encoding: 'utf8', maxBuffer: 1 << 24 });
  assert.equal(made.status, 0, made.stderr);
  assert.deepEqual(JSON.parse(made.stdout), read('pictures/poses.json'));
});

test('every phone of every pack has one viseme id', () => {
  const { ids } = read('shapes/viseme-ids.json');
  assert.deepEqual(ids.map(({ id }) => id), Array.from({ length: 22 }, (_, i) => i));
  const all = ids.flatMap(({ phones }) => phones);
  assert.equal(new Set(all).size, all.length, 'each once');
  let count = 0;
  for (const name of fs.readdirSync(path.join(root, 'models/speech')).filter((file) => file.endsWith('.json')))
    for (const [ipa, phone] of Object.entries(read(`speech/${name}`).phones)) {
      count++;
      assert.ok(phone.parts || all.includes(ipa), `${name}: ${ipa}`);
    }
  assert.ok(count > 150);
});
