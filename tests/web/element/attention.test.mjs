// SPDX-License-Identifier: GPL-3.0-or-later
// Attention: she looks at who speaks, nods where they pause, and goes back to what she did.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Attention } from '../../../web/element/face/attention.mjs';

const own = () => {
  const values = new Float32Array(69);
  values[3] = 100; // jaw
  for (const n of [23, 24, 49]) values[n] = 10000; // looks to her left
  return values;
};
/** Draws 25 pictures a second for so many seconds; returns the last. */
function watch(attention, from, seconds, act = () => {}) {
  let shown;
  for (let now = from; now <= from + 1000 * seconds; now += 40) {
    act(now);
    shown = attention.apply(own(), now);
  }
  return shown;
}

test('turns eyes and head to the speaker, smoothly, and nothing else', () => {
  const attention = new Attention();
  assert.equal(attention.active(0), false);
  assert.deepEqual(attention.apply(own(), 0), own());
  attention.on = true;
  let before = 10000;
  watch(attention, 40, 1, () => {
    const values = attention.apply(own(), 0);
    assert.ok(values[3] === 100);
  });
  const shown = watch(attention, 1100, 1, () => {});
  for (const n of [23, 24, 49]) assert.ok(Math.abs(shown[n]) <= 2001, `${n}: ${shown[n]}`);
  attention.on = false;
  for (let now = 2200; now < 3000; now += 40) {
    const value = attention.apply(own(), now)[23];
    assert.ok(Math.abs(value - (now === 2200 ? value : before)) < 2500); // no jump
    before = value;
  }
  assert.equal(before, 10000);
  assert.equal(attention.active(3000), false);
});

test('nods once for a pause, never twice at once, and not to nobody', () => {
  const attention = new Attention();
  attention.nod(1000);
  assert.equal(watch(attention, 1000, 0.3)[48], 0);
  attention.on = true;
  let deepest = 0, nods = 0, down = false;
  watch(attention, 2000, 6, (now) => {
    if (now % 400 === 0) attention.nod(now); // far too often
    const pitch = attention.apply(own(), now)[48];
    deepest = Math.max(deepest, pitch);
    if (pitch > 4000 && !down) nods++;
    down = pitch > 4000;
  });
  assert.ok(deepest > 7000 && deepest <= 7500, String(deepest));
  assert.ok(nods >= 2 && nods <= 4, String(nods));
});
