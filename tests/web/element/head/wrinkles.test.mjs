// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { faceValues } from '../../../../web/element/face/face-mixer.mjs';
import { agedBy, foldPlace, foldsOf, wrinklePlace, wrinklesOf } from '../../../../web/element/head/shading/wrinkles.mjs';

const at = (faps) => wrinklesOf(faceValues(faps));

test('a smooth face has no creases, raised brows fold the forehead, drawn ones the skin between them', () => {
  assert.deepEqual(at({}), [0, 0, 0, 0]);
  const surprise = at({ 31: 260, 32: 260, 33: 300, 34: 300, 35: 250, 36: 250 });
  assert.ok(surprise[0] > 0.9 && surprise[1] === 0, `${surprise}`);
  const anger = at({ 31: -190, 32: -190, 33: -120, 34: -120, 37: 130, 38: 130 });
  assert.ok(anger[0] === 0 && anger[1] > 0.8, `${anger}`);
});

test('a smile folds the skin beside the eyes, each side by itself, up to a maximum', () => {
  const [, , left, right] = at({ 41: 220, 21: 190 });
  assert.ok(left > 0.9 && right === 0);
  assert.deepEqual(at({ 41: 600, 42: 600 }).slice(2), [1, 1]);
});

test('the young have no lines beside the eyes, and shallow ones on the forehead; older skin has more of both', () => {
  const values = faceValues({ 31: 260, 32: 260, 33: 300, 34: 300, 35: 250, 36: 250, 41: 220, 42: 220 });
  const [young, grown, old] = [0.9, 1.3, 1.7].map((relief) => wrinklesOf(values, agedBy(relief)));
  assert.deepEqual(young.slice(2), [0, 0]);
  assert.ok(young[0] > 0.4 && young[0] < grown[0] && grown[0] < old[0], `${young[0]} ${grown[0]} ${old[0]}`);
  assert.ok(grown[2] > 0.3 && grown[2] < old[2] && old[2] === 1, `${grown[2]} ${old[2]}`);
  assert.ok(agedBy() < 0.1); // a head that does not say
});

test('places wrinkles by feature points, and none without them', () => {
  const fdp = { '4.1': [10, 22, 30], '4.5': [52, 24, 10], '3.5': [31, 0, 13] };
  assert.deepEqual(wrinklePlace(fdp, { ES: 60, IRISD: 9 }), [22, 10, 31 + 0.27 * 60, 0]);
  assert.equal(wrinklePlace({}, { ES: 60 }), null);
});

test('joy and disgust fold the skin between nose and mouth, each side by itself; speech hardly does', () => {
  const folds = (faps) => foldsOf(faceValues(faps));
  assert.deepEqual(folds({}), [0, 0, 0]);
  const joy = folds({ 12: 360, 13: 360, 6: 150, 7: 150, 41: 230, 42: 230, 8: -290, 9: -290 });
  assert.ok(joy[0] === 1 && joy[1] === 1 && joy[2] === 0, `${joy}`);
  const disgust = folds({ 41: 200, 42: 200, 63: 140, 8: -260, 9: -130 });
  assert.ok(disgust[0] > 0.7 && disgust[2] === 1, `${disgust}`);
  const crooked = folds({ 12: 360, 41: 230 });
  assert.ok(crooked[0] > 0.8 && crooked[1] === 0, `${crooked}`);
  const spread = folds({ 6: 120, 7: 120, 8: -150, 9: -150 }); // as /i/ is
  assert.ok(spread[0] < 0.2, `${spread}`);
});

test('folds lie beside nose and mouth', () => {
  assert.deepEqual(foldPlace({ '9.1': [13, -30, 27], '8.3': [23, -60, 18] }), [16.5, -24, 30, -59]);
  assert.equal(foldPlace({}), null);
});
