// SPDX-License-Identifier: GPL-3.0-or-later
// No mesh of a head goes through another: lips, teeth, tongue, lids, lashes and brows in every sound of Italian and every basic emotion,
// as the program mixes them. Soft parts yield, so what goes in by less than the tolerance is a touch.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { crossings } from '../../models/tools/lib/crossing.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { expressionPose, soundPoses } from '../lib/mouth-poses.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const head = unpack(JSON.parse(fs.readFileSync(path.join(process.env.FACCIA_MODELS ?? path.join(root, 'build/models'), 'heads/mara.json'))));
const EMOTIONS = ['joy', 'sadness', 'anger', 'fear', 'disgust', 'surprise'];

/** Tolerances in mm: teeth among each other hardly any, lips and tongue press against what they touch. */
const PAIRS = [
  ['teeth_upper', 'teeth_lower', 0.8],
  ['teeth_upper', 'skin', 1.2],
  ['teeth_lower', 'skin', 1.2],
  ['teeth_upper', 'mouth', 1.2],
  ['teeth_lower', 'mouth', 1.2],
  ['tongue', 'teeth_upper', 1.2],
  ['tongue', 'teeth_lower', 1.2],
  ['tongue', 'skin', 1.2],
];

/** The parts near the mouth, with only the triangles that are there: a sweep of the whole head would take minutes. */
const near = Object.fromEntries(
  [...new Set(PAIRS.flatMap(([a, b]) => [a, b]))].map((name) => {
    const part = head.parts.find((one) => one.name === name);
    const [, y, z] = head.fdp['2.2'];
    const index = [];
    for (let t = 0; t < part.index.length; t += 3) {
      const v = part.index[t] * 3;
      const p = part.position;
      if (Math.abs(p[v]) < 34 && Math.abs(p[v + 1] - y) < 26 && p[v + 2] > z - 45) index.push(...part.index.slice(t, t + 3));
    }
    return [name, { part, index }];
  }),
);

function through(faps) {
  const posed = Object.fromEntries(Object.entries(near).map(([name, { part, index }]) => [name, { position: pose(head, part, faps), index }]));
  return PAIRS.flatMap(([a, b, tolerance]) => {
    const { count, deepest, at } = crossings(posed[a], posed[b], tolerance);
    return count ? [`${a} goes through ${b} at ${count} edges, ${deepest.toFixed(1)} mm deep, at ${at.map((x) => x.toFixed(0))}`] : [];
  });
}

const silent = Object.fromEntries(EMOTIONS.map((name) => [name, expressionPose(`${name}=1`)]));
const wholes = { rest: [], ...silent };

for (const emotion of [undefined, ...EMOTIONS])
  test(`nothing in the mouth crosses, ${emotion ?? 'without an expression'}`, () => {
    const poses = soundPoses('it', emotion);
    const wrong = [];
    for (const [ipa, faps] of [...Object.entries(poses), [emotion ?? 'rest', wholes[emotion ?? 'rest']]])
      wrong.push(...through(faps).map((what) => `${ipa}: ${what}`));
    assert.deepEqual(wrong, []);
  });

/** Vertices of a part in front of an eye, by how far they are outside of the eyeball. */
function outside(part, side, faps) {
  const eye = head.parts.find((one) => one.name === `eye_${side}`);
  const { pivot } = head.turns.find(({ name }) => eye.turns.some((t) => t.turn === name));
  const radius = Math.max(...Array.from({ length: eye.position.length / 3 }, (_, v) => Math.hypot(...pivot.map((c, k) => eye.position[v * 3 + k] - c))));
  const p = pose(head, part, faps);
  return Array.from({ length: p.length / 3 }, (_, v) => Math.hypot(...pivot.map((c, k) => p[v * 3 + k] - c)) - radius);
}

test('lids and lashes stay outside of the eyeballs, in every emotion and closed', () => {
  const closed = { 19: 1024, 20: 1024 };
  for (const name of ['skin', 'lashes'])
    for (const side of ['l', 'r']) {
      const part = head.parts.find((one) => one.name === name);
      const rest = outside(part, side, {});
      // What is outside at rest, on the front of the eye: the socket behind the lids lies inside of the ball's sphere.
      const { pivot } = head.turns.find(({ name: turn }) => head.parts.find((one) => one.name === `eye_${side}`).turns.some((t) => t.turn === turn));
      const mine = rest.flatMap((d, v) => (d > 0.3 && d < 12 && part.position[v * 3 + 2] > pivot[2] + 3 ? [v] : []));
      assert.ok(mine.length > 20, `${name}: ${mine.length} vertices round eye_${side}`);
      for (const [what, faps] of Object.entries({ ...wholes, closed, 'closed joy': { ...silent.joy, ...closed } })) {
        const now = outside(part, side, faps);
        const worst = Math.min(...mine.map((v) => now[v]));
        assert.ok(worst > -0.8, `${what}: ${name} is ${(-worst).toFixed(2)} mm inside of eye_${side}`);
      }
    }
});

test('no hair goes through a brow', () => {
  const [brows, hair] = ['brows', 'hair'].map((name) => head.parts.find((one) => one.name === name));
  for (const [what, faps] of Object.entries(wholes)) {
    const { count, deepest } = crossings(...[brows, hair].map((part) => ({ position: pose(head, part, faps), index: part.index })), 0.5);
    assert.equal(count, 0, `${what}: ${count} edges, ${deepest.toFixed(1)} mm`);
  }
});
