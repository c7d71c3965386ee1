// SPDX-License-Identifier: GPL-3.0-or-later
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { AU, clampFap, fapByName, faps, fapScale, FAP_COUNT } from '../../protocol/fap.mjs';

test('the table is indexed by number', () => {
  assert.equal(faps.length, FAP_COUNT + 1);
  assert.equal(faps[0], undefined);
  for (let n = 1; n <= FAP_COUNT; n++) {
    assert.equal(faps[n].number, n);
    assert.equal(fapByName(faps[n].name), n);
  }
  assert.equal(fapByName('open_jaw'), 3);
  assert.equal(fapByName('nothing'), 0);
});

test('values are limited to the range', () => {
  assert.equal(clampFap(3, -5), 0);
  assert.equal(clampFap(3, 99999), 4320);
  assert.equal(clampFap(5, -12.5), -12.5);
  assert.equal(clampFap(48, -1e9), -1860 * 170);
  assert.equal(clampFap(1, -5), -5);
});

test('a unit has the length that the face gives it', () => {
  const fapu = { IRISD: 1024, ES: 2048, ENS: 3072, MNS: 4096, MW: 5120 };
  assert.equal(fapScale(19, fapu), 1);
  assert.equal(fapScale(27, fapu), 2);
  assert.equal(fapScale(31, fapu), 3);
  assert.equal(fapScale(3, fapu), 4);
  assert.equal(fapScale(6, fapu), 5);
  assert.equal(fapScale(49, fapu), AU);
  assert.equal(AU, 1e-5);
  assert.equal(fapScale(1, fapu), 0);
});
