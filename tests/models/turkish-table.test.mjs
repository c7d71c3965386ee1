// SPDX-License-Identifier: GPL-3.0-or-later
// The Turkish letters beside the tables of E. Akagündüz (METU 2004) as they are printed: every other number has its reason written beside it.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { faccia } from '../lib/command.mjs';
import { root } from '../lib/daemon.mjs';

const pack = JSON.parse(fs.readFileSync(path.join(root, 'models/speech/letters/tr.json'), 'utf8'));
/* table 5.4, the column that was used, ms */
const PRINTED = {
  a: 55, e: 50, ı: 34, i: 35, o: 61, ö: 62, ü: 35, b: 66, c: 78, ç: 105, d: 56, f: 91, g: 68, ğ: 61, h: 58, j: 94, k: 90, l: 47, m: 68, n: 59, p: 96, r: 55, s: 118,
  ş: 114, t: 84, v: 63, y: 58, z: 129,
};

test('durations are those of table 5.4, or have a reason', () => {
  const other = Object.entries(pack.letters).filter(([letter, { ms }]) => ms !== PRINTED[letter]).map(([letter, { ms }]) => [letter, ms]);
  assert.deepEqual(other, [['u', 39], ['z', 88]]);
  const reasons = pack.sources.join(' ');
  for (const number of [/129 ms/, /88 ms/, /U: .*39/, /SILENCE, 607 ms/]) assert.match(reasons, number);
  assert.equal(Object.keys(pack.letters).length, 29);
});

test('there are 36 shapes and the neutral face', () => assert.equal(Object.keys(pack.shapes).length + (pack.neutral in pack.shapes ? 0 : 1), 37));

test('the six emotions have the tags of table 5.3, with rho 3 and omega 0.2', () => {
  for (const [tag, affect] of Object.entries({ ANGRY: 'anger', AFRAID: 'fear', SAD: 'sadness', HAPPY: 'joy', SURPRISED: 'surprise', DISGUSTED: 'disgust' }))
    assert.match(faccia(['check', '--score', '-', '--markup', 'jsml', '-'], { input: `<SENT><${tag}>Merhaba.</${tag}></SENT>` }).stdout, new RegExp(`cue affect ${affect} `));
  const source = fs.readFileSync(path.join(root, 'server/face/expression/cue_envelope.c'), 'utf8');
  assert.match(source, /#define RHO 3\n/);
  assert.match(source, /#define WEIGHT_DEFAULT 0\.2\n/);
});
