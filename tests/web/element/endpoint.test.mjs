// SPDX-License-Identifier: GPL-3.0-or-later
// Where somebody begins and ends to speak, by loudness over the noise of the room.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Endpoint } from '../../../web/element/audio/endpoint.mjs';

const RATE = 24000, BLOCK = 480;
let seed = 1;
const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647 - 0.5;

/** Gives the endpoint sounds of so many seconds and dB each; returns the changes with their times. */
function changes(parts, endpoint = new Endpoint(RATE)) {
  const found = [];
  let time = 0;
  for (const [seconds, level, more] of parts) {
    for (const end = time + seconds; time < end - 1e-6; time += BLOCK / RATE) {
      const peak = 32768 * 10 ** (level / 20) * Math.sqrt(12);
      const change = endpoint.push(Int16Array.from({ length: BLOCK }, () => Math.max(-32768, Math.min(32767, peak * random()))), more);
      if (change) found.push([change, time]);
    }
  }
  return found;
}
const kinds = (found) => found.map(([kind]) => kind);
const near = (time, expected) => assert.ok(Math.abs(time - expected) < 0.15, `${time} for ${expected}`);

test('finds speech in quiet and noisy rooms, with its pauses', () => {
  for (const noise of [-90, -60, -45, -35]) {
    const found = changes([[3, noise], [1, noise + 25], [0.5, noise], [1, noise + 20], [2, noise]].map(([s, level]) => [s, noise < -60 && level > noise ? level + 40 : level]));
    assert.deepEqual(kinds(found), ['begin', 'end'], `${noise} dB: ${found}`);
    near(found[0][1], 3.1);
    near(found[1][1], 6.3);
  }
});

test('ignores clicks, silence and a noise that stays', () => {
  assert.deepEqual(changes([[2, -60], [0.04, -20], [2, -60], [0.04, -20], [2, -60]]), []);
  assert.deepEqual(changes([[2, -90], [10, -56]]), []);
  const fan = changes([[2, -60], [40, -40], [2, -40]]);
  assert.deepEqual(kinds(fan), ['begin', 'end']); // it is noticed once, and then belongs to the room
  assert.deepEqual(kinds(changes([[2, -60], [40, -40], [1, -18], [2, -40]])).slice(-2), ['begin', 'end']);
});

test('wants more while the page makes a sound itself', () => {
  assert.deepEqual(changes([[2, -60], [2, -46, 8], [2, -60]]), []);
  assert.deepEqual(kinds(changes([[2, -60], [2, -30, 8], [2, -60]])), ['begin', 'end']);
  assert.equal(new Endpoint(RATE).push(new Int16Array(0)), null);
});
