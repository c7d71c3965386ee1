// SPDX-License-Identifier: GPL-3.0-or-later
// Hair that is grown: it leaves the face free, lies on what it meets, also while it sways, and hangs from roots that stay.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { calibrate } from '../../web/element/head/model/calibrate.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';
import { turned } from '../../web/element/head/mesh/influences.mjs';
import { bodyOf } from '../../models/tools/head/hair/body.mjs';
import { COILED, earOf, FULL, rowsOf, SPARSE } from '../../models/tools/head/hair/grow.mjs';
import { beside, hangingHair } from '../../models/tools/head/hair/hang.mjs';
import { paintStrands } from '../../models/tools/head/paint/paint-strands.mjs';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { heads as folder } from '../lib/built-heads.mjs';

const jsonOf = (name) => JSON.parse(fs.readFileSync(path.join(folder, `${name}.json`)));
const LONG = ['mara', 'mei'].map((name) => {
  const json = jsonOf(name);
  return { name, json, head: unpack(json) };
});
const named = (head, name) => head.parts.find((part) => part.name === name);
const points = ({ position }) => Array.from({ length: position.length / 3 }, (_, v) => [...position.subarray(3 * v, 3 * v + 3)]);
const LAGS = [[0, 0, 0], [0, 0.13, 0], [0, -0.13, 0], [0.08, 0, 0], [-0.08, 0, 0], [0, 0, 0.1], [0, 0, -0.1]]; // as far as Sway goes

/** Where hair is that lags. */
function swayed(hair, lag) {
  const angle = Math.hypot(...lag);
  if (!angle) return points(hair);
  const turn = { pivot: hair.sway.pivot, axis: lag.map((x) => x / angle) };
  return points(hair).map((q, v) => turned(q, turn, angle * hair.sway.weights[v]));
}

test('no hair comes before the lips, the eyes or the nose, however it sways', () => {
  for (const { name, head } of LONG) {
    const { fdp } = head;
    const wide = fdp['8.3'][0] + 8;
    for (const lag of LAGS) {
      const before = swayed(named(head, 'hair'), lag).filter(([x, y, z]) => Math.abs(x) < wide && y < 22 && y > fdp['2.1'][1] && z > -20);
      assert.equal(before.length, 0, `${name}, ${lag}: ${before[0]}`);
    }
  }
});

test('hair lies on skin and clothes, also while it sways', () => {
  for (const { name, head } of LONG) {
    const body = bodyOf([named(head, 'skin'), named(head, 'clothes')], earOf(head.fdp));
    const hair = named(head, 'hair');
    const shares = LAGS.map((lag) => swayed(hair, lag).filter((q) => body.height(q) < -4).length / hair.sway.weights.length);
    console.log(`${name}: ${shares.map((x) => (100 * x).toFixed(1)).join(', ')} % of the vertices 4 mm below`);
    assert.ok(shares[0] < 0.02, `${name} at rest: ${shares[0]}`);
    assert.ok(Math.max(...shares) < 0.05, `${name}: ${shares}`);
  }
});

test('roots stay, and free ends sway', () => {
  for (const { name, head } of LONG) {
    const { sway, position, index } = named(head, 'hair');
    assert.equal(sway.weights.length, position.length / 3);
    const near = points({ position }).map((q, v) => [q[1], sway.weights[v]]);
    const most = Math.max(...near.filter(([y]) => y > 60).map(([, weight]) => weight));
    assert.ok(most < 0.1, `${name}: hair on the skull does not slide: ${most}`);
    assert.ok(near.filter(([y, weight]) => y < -60 && weight > 0.6).length > 500, name);
    const rigid = new Set(index.filter((v) => sway.weights[v] === 0));
    assert.ok(rigid.size > 0.1 * sway.weights.length, name);
  }
});

test('a calibrated head sways about its own neck', () => {
  const [{ json, head }] = LONG;
  const wider = Object.fromEntries(Object.entries(head.fdp).filter(([name]) => /^[23789]\./.test(name)).map(([name, [x, y, z]]) => [name, [x, 1.1 * y - 8, z]]));
  const model = readModel(json);
  const moved = calibrate(model, { featurePointsCoord: wider });
  const pivots = ({ turns }) => [turns.find(({ sways }) => sways), turns.at(-1)].map(({ pivot }) => pivot);
  const [before, after] = [pivots(model), pivots(moved)];
  assert.deepEqual(before[0].map((x) => x.toFixed(2)), before[1].map((x) => x.toFixed(2)));
  assert.deepEqual(after[0].map((x) => x.toFixed(2)), after[1].map((x) => x.toFixed(2)));
  assert.ok(Math.hypot(...before[0].map((x, k) => x - after[0][k])) > 1, `${after[0]}`);
});

test('hair falls from a parting to its own side, ends at its cut, and keeps its height above a ball', () => {
  const middle = [0, 25, -75];
  const away = (q) => Math.hypot(...q.map((x, k) => x - middle[k]));
  const unit = (q) => q.map((x, k) => (x - middle[k]) / away(q));
  const skull = { height: (q) => away(q) - 80, normal: unit, lifted: (q, mm) => q.map((x, k) => x + mm * unit(q)[k]) };
  const style = { ragged: 0, cut: [[0, -120], [180, -120]], comb: [], hangs: { parting: { x: 10, behind: -80 }, clear: [[-200, 40], [66, 40]], front: [[-200, 0], [80, 60]] } };
  const combed = (_, __, ___, side) => [side, 0, 0];
  const layer = { length: [400, 400], rise: [0.3], lay: 0.3, lift: [4], wild: 0 };
  for (const x of [14, 6]) {
    const root = skull.lifted([x, 100, -70], 80 - away([x, 100, -70]));
    const { spine, sway } = hangingHair(root, layer, { skull, style, roll: () => 0.5, combed });
    const tip = spine.at(-1);
    assert.equal(Math.sign(beside(style.hangs.parting, root)), Math.sign(tip[0]), `from ${x}: ${tip}`);
    assert.ok(tip[1] < -100 && tip[1] > -132, `${tip}`);
    for (const q of spine.slice(5)) assert.ok(skull.height(q) > 2, `${q}: ${skull.height(q)} mm`);
    assert.ok(sway[0] === 0 && sway.at(-1) > 0.9, `${sway}`);
  }
});

test('rows of a card stand where it bends', () => {
  const straight = Array.from({ length: 11 }, (_, i) => [0, -i, 0]);
  assert.deepEqual(rowsOf(straight, 6).map((x) => x.toFixed(6)), [0, 2, 4, 6, 8, 10].map((x) => x.toFixed(6)));
  const hook = [...Array.from({ length: 9 }, (_, i) => [Math.sin((i * Math.PI) / 16), Math.cos((i * Math.PI) / 16), 0]), ...Array.from({ length: 24 }, (_, i) => [1, -0.2 * (i + 1), 0])];
  const rows = rowsOf(hook, 9);
  assert.equal(rows[0], 0);
  assert.ok(Math.abs(rows.at(-1) - (hook.length - 1)) < 1e-6, `${rows}`);
  assert.ok(rows.every((x, i) => !i || x > rows[i - 1]), `${rows}`);
  assert.ok(rows.filter((x) => x < 9).length >= 6, `most are in the bend, its first quarter: ${rows}`);
});

test('no card ends on a shoulder: it reaches its cut, or starts below it', () => {
  const [, mei] = LONG;
  const { position, index } = named(mei.head, 'hair');
  const card = Array.from({ length: position.length / 3 }, (_, v) => v);
  const first = (v) => {
    while (card[v] !== v) v = card[v] = card[card[v]];
    return v;
  };
  for (let i = 0; i < index.length; i += 3) for (const k of [1, 2]) card[first(index[i + k])] = first(index[i]);
  const heights = new Map();
  card.forEach((_, v) => heights.set(first(v), [...(heights.get(first(v)) ?? []), position[3 * v + 1]]));
  const long = [...heights.values()].filter((ys) => ys.length >= 16).map((ys) => [Math.min(...ys), Math.max(...ys)]);
  assert.ok(long.length > 300, `${long.length} long cards`);
  assert.ok(long.filter(([low]) => low > -165).length < 0.01 * long.length, long.filter(([low]) => low > -165).join(' '));
});

test('coils stay in their cells, and leave gaps', () => {
  const size = 256;
  const { data } = paintStrands({ size, strands: { coils: true, ramp: [[0, '#000000'], [1, '#ffffff']] } });
  const [wide, high] = [size / (FULL + SPARSE), size / COILED];
  for (let row = 0; row < COILED; row++) {
    const shares = Array.from({ length: FULL + SPARSE }, (_, column) => {
      let opaque = 0;
      for (let y = row * high; y < (row + 1) * high; y++) for (let x = column * wide; x < (column + 1) * wide; x++) opaque += data[4 * (y * size + x) + 3] > 127;
      return opaque / (wide * high);
    });
    for (const share of shares.slice(0, FULL)) assert.ok(share > 0.25 && share < 0.85, `full cells: ${shares}`);
    for (const share of shares.slice(FULL)) assert.ok(share > 0.02 && share < 0.4, `sparse cells: ${shares}`);
  }
});
