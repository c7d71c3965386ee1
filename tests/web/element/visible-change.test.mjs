// SPDX-License-Identifier: GPL-3.0-or-later
// How far a face has moved since it was drawn.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { VisibleChange } from '../../../web/element/stage/visible-change.mjs';

const FAPU = { IRISD: 10, ES: 60, ENS: 45, MNS: 20, MW: 50 };
const face = (values) => Object.assign(new Float32Array(69), values);

test('says how far the farthest point has moved, in mm', () => {
  const change = new VisibleChange(FAPU);
  assert.equal(change.since(face({})), Infinity, 'nothing was drawn');
  change.drawn(face({}));
  assert.equal(change.since(face({})), 0);
  const moved = { 'the jaw by half of MNS': [{ 3: 512 }, 10], 'a lid by IRISD': [{ 19: 1024 }, 10], 'a corner by a tenth of MW': [{ 6: 102.4 }, 5],
    'an eye by a hundredth of a radian': [{ 23: 1000 }, 0.12], 'the head by as much': [{ 49: -1000 }, 2.5], 'a breath': [{ 0: 1 }, 5] };
  for (const [what, [values, mm]] of Object.entries(moved)) assert.ok(Math.abs(change.since(face(values)) - mm) < 1e-4, what);
  assert.ok(Math.abs(change.since(face({ 3: 512, 19: -1024, 49: 2000 })) - 10) < 1e-4, 'the farthest of all');
});

test('slow movements add up until the face is drawn again', () => {
  const change = new VisibleChange(FAPU), values = face({});
  change.drawn(values);
  let steps = 0;
  for (; change.since(values) < 0.34; steps++) values[48] += 20; // 0.05 mm
  assert.equal(steps, 7);
  change.drawn(values);
  assert.equal(change.since(values), 0);
  values[48] -= 20;
  assert.ok(change.since(values) > 0);
});
