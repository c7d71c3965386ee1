// SPDX-License-Identifier: GPL-3.0-or-later
// The bodies of the heads: arms hang, necks have tendons, clothes turn inward at their hems and hide the skin below.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { lowered } from '../../models/tools/head/body/arms.mjs';
import { hems, nearestHem } from '../../models/tools/head/body/edges.mjs';
import { thickened } from '../../models/tools/head/body/thicken.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { heads as folder } from '../lib/built-heads.mjs';
import { violations } from '../lib/schema.mjs';

const files = fs.readdirSync(folder).filter((file) => file.endsWith('.json')).map((file) => JSON.parse(fs.readFileSync(path.join(folder, file))));
const heads = files.map(unpack);
const part = (head, name) => head.parts.find((one) => one.name === name);

const JOINTS = { 'joint-l-shoulder': [155, -224, -91], 'joint-l-elbow': [313, -397, -87], 'joint-l-clavicle': [23, -209, -91] };
const warp = lowered({ point: ({ group }) => JOINTS[group] }, 33);

test('arms are lowered, both alike; neck and trunk stay', () => {
  const elbow = warp(JOINTS['joint-l-elbow']);
  const down = Math.atan2(JOINTS['joint-l-shoulder'][1] - elbow[1], elbow[0] - JOINTS['joint-l-shoulder'][0]);
  assert.ok(down > 1.25 && down < 1.6, `the arm hangs at ${((down * 180) / Math.PI).toFixed(0)} degrees`);
  const other = warp(JOINTS['joint-l-elbow'].map((x, k) => (k ? x : -x)));
  assert.deepEqual(other, [-elbow[0], elbow[1], elbow[2]]);
  for (const q of [[0, -240, 0], [30, -150, -60], [110, -400, -20], [-50, -90, 20], [70, 30, -80]]) assert.deepEqual(warp(q), q);
  const steps = Array.from({ length: 30 }, (_, i) => warp([60 + 6 * i, -180 - 3 * i, -90]));
  for (const [i, q] of steps.slice(1).entries()) assert.ok(Math.hypot(...q.map((x, k) => x - steps[i][k])) < 14, 'the shoulder does not tear');
});

test('shoulders are about as wide as those of people, and fall', () => {
  for (const head of heads) {
    const { position } = part(head, 'clothes');
    const half = (from, to) => position.reduce((most, x, i) => (i % 3 === 0 && position[i + 1] > from && position[i + 1] < to ? Math.max(most, x) : most), 0);
    const [high, low] = [half(-190, -170), half(-330, -280)];
    assert.ok(low > 150 && low < 280, `${head.name}: ${low.toFixed(0)} mm to the side`);
    assert.ok(high < low - 4, `${head.name}: ${high.toFixed(0)} mm at the top, ${low.toFixed(0)} below`);
    const widest = position.reduce((most, x, i) => (i % 3 === 0 ? Math.max(most, x) : most), 0);
    assert.ok(widest < 1.25 * low, `${head.name}: the arms stand out to ${widest.toFixed(0)}`);
  }
});

/** A square of cloth in the plane z = 0, below which it is cut. */
function cloth(n = 6, step = 20) {
  const position = [], uv = [], index = [], refs = [];
  for (let j = 0; j <= n; j++)
    for (let i = 0; i <= n; i++) {
      position.push(i * step, j * step, 0);
      uv.push(i / n, j / n);
      refs.push([[i, 1]]);
    }
  for (let j = 0; j < n; j++)
    for (let i = 0; i < n; i++) {
      const a = j * (n + 1) + i;
      index.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
  return { position: Float64Array.from(position), uv, index, refs, smooth: null };
}

test('a hem turns inward, but not where the cloth is cut', () => {
  const plain = cloth();
  const edges = hems(plain);
  assert.equal(edges.length, 6 + 2 * 4, 'three sides, from where it is cut on');
  const made = thickened(plain, { thick: 2, turned: 8 });
  assert.equal(made.index.length - plain.index.length, 12 * edges.length);
  const added = made.position.slice(plain.position.length);
  assert.ok(added.every((x, i) => i % 3 !== 2 || (x <= -0.99 && x >= -2.01)), 'inside of the cloth, by its thickness at most');
  const inner = Array.from({ length: added.length / 3 }, (_, v) => added.slice(3 * v, 3 * v + 3)).filter(([, , z]) => z < -1.9);
  const under = inner.filter(([x, y]) => x > 3 && x < 117 && y < 117);
  assert.ok(inner.length > 12 && under.length >= inner.length - 2, 'and back under it, but for the two corners');
  assert.equal(made.smooth.length, made.refs.length);
});

test('tells how far the next hem is', () => {
  const at = nearestHem(cloth(), 15);
  assert.ok(Math.abs(at([60, 112, 0])[0] - 8) < 1e-9);
  assert.equal(at([60, 60, 0])[0], Infinity);
});

test('the tendons of the neck and the larynx of men stand out', () => {
  /** How far the skin stands before its surroundings at a height in the middle, mm. */
  const bump = (head, y) => {
    const { position } = part(head, 'skin');
    const front = (at) => {
      let most = -Infinity;
      for (let i = 0; i < position.length; i += 3)
        if (Math.abs(position[i]) < 9 && Math.abs(position[i + 1] - at) < 7 && position[i + 2] > most) most = position[i + 2];
      return most;
    };
    return front(y) - (front(y + 17) + front(y - 17)) / 2;
  };
  const of = (name) => heads.find((head) => head.name === name);
  const apple = (name) => bump(of(name), of(name).fdp['2.1'][1] - 42);
  for (const man of ['bruno', 'samuel', 'ettore']) assert.ok(apple(man) > apple('mara') + 0.5, `${man}: ${apple(man).toFixed(2)}, Mara: ${apple('mara').toFixed(2)}`);
});

test('every head says how far down it goes and what a breath moves, and fits its schema', () => {
  for (const [i, head] of heads.entries()) {
    const low = part(head, 'clothes').position.reduce((least, y, k) => (k % 3 === 1 ? Math.min(least, y) : least), Infinity);
    assert.ok(low < head.view.bottom, `${head.name}: clothes down to ${low.toFixed(0)}, bottom ${head.view.bottom}`);
    assert.ok(Math.hypot(...head.breath.shift) > 2 && Math.hypot(...head.breath.shift) < 5, head.name);
    assert.ok(files[i].parts.find(({ name }) => name === 'clothes').breath, head.name);
    assert.equal(violations('head-model', files[i]), null);
  }
});
