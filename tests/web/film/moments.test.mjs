// SPDX-License-Identifier: MIT
// The moments at which a film's heads breathe and sway.
import assert from 'node:assert/strict';
import test from 'node:test';
import { moments } from '../../../web/film/moments.mjs';

const all = (job) => [...moments(job)];
const shown = (job) => all(job).flatMap((one) => (one.shown ? [one.time] : []));

test('there is a moment for each picture, and none is more than 40 ms after the one before', () => {
  for (const fps of [1, 2, 10, 24, 25, 29.97, 50, 120]) {
    const list = all({ start: 0, count: 7, fps });
    assert.deepEqual(shown({ start: 0, count: 7, fps }), Array.from({ length: 7 }, (_, k) => k / fps));
    assert.ok(list.every(({ time }, i) => !i || (time > list[i - 1].time && time < list[i - 1].time + 0.0401)), `${fps}`);
  }
});

test('one picture comes after the same moments as in the whole film', () => {
  for (const [fps, k] of [[25, 7], [10, 13], [3, 2], [29.97, 11]]) {
    const film = all({ start: 0, count: k + 1, fps });
    const before = film.slice(0, film.findLastIndex((one) => one.shown) + 1).map(({ time }) => time);
    const still = all({ start: k / fps, count: 1, fps });
    assert.deepEqual(still.slice(0, before.length).map(({ time }) => time), before);
    assert.deepEqual(shown({ start: k / fps, count: 1, fps }), [k / fps]);
    assert.equal(still.findIndex((one) => one.shown), before.length - 1);
  }
});
