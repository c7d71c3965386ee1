// SPDX-License-Identifier: GPL-3.0-or-later
// The affects against the Facial Action Coding System: each moves what its action units move, far enough to be seen and no farther than
// faces do, and nothing that would make it another expression. Measured in mm on the built heads.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { measuring } from '../lib/action-units.mjs';
import { heads } from '../lib/built-heads.mjs';
import { root } from '../lib/daemon.mjs';
import { expressionPose } from '../lib/mouth-poses.mjs';

const { affect } = JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json')));
const names = Object.keys(affect);
const people = fs.readdirSync(heads).filter((file) => /^\w+\.json$/.test(file)).map((file) => file.slice(0, -5));
const head = (name) => unpack(JSON.parse(fs.readFileSync(path.join(heads, `${name}.json`))));
const poses = Object.fromEntries(names.map((name) => [name, expressionPose(`${name}=1`)]));
const ofMara = measuring(head('mara'));

const NONE = [-1, 1];
const SOME = [0.8, 20];
const CALM = { 'inner brow up': [-1, 2.2], 'brows together': [-0.5, 0.5] }; // neither AU 1 alone nor AU 4: the brows do not worry

/** What must move, and what must not: least and greatest mm of each move. The numbers are those of FACS. */
const BASIC = {
  joy: { ...CALM, 'outer brow up': NONE, 'cheek up': [3, 8], 'lower lid up': [1.5, 4], 'corner up': [4, 9], 'corner out': [3, 10], 'upper lid up': [-2, 0] }, // 6 + 12 + 25
  sadness: { 'inner brow up': [4, 9], 'outer brow up': [-4, 0], 'brows together': [1.5, 6], 'corner up': [-6, -2], 'corner out': [-2, 1], 'chin up': [0.5, 4], 'jaw down': [-3, 0.5] }, // 1 + 4 + 15 + 17
  surprise: { 'inner brow up': [5, 11], 'outer brow up': [5, 11], 'brows together': [-0.5, 0.5], 'upper lid up': [1, 4], 'jaw down': [6, 16], 'corner up': [-6, 0], 'cheek up': NONE }, // 1 + 2 + 5 + 26
  fear: { 'inner brow up': [4, 10], 'outer brow up': [2, 8], 'brows together': [2, 7], 'upper lid up': [1, 4], 'corner out': [4, 10], 'corner up': [-5, 0.5], 'jaw down': [1.5, 6] }, // 1 + 2 + 4 + 5 + 20 + 26
  anger: { 'inner brow up': [-9, -3], 'outer brow up': [-5, 0], 'brows together': [3, 7], 'upper lid up': [0.3, 3], 'lower lid up': [0.9, 4], 'lips narrower': [1.5, 8], 'corner up': [-4, 0.5], 'cheek up': NONE }, // 4 + 5 + 7 + 23 or 24
  disgust: { 'inner brow up': [-7, -1.5], 'outer brow up': [-4, 0.5], 'nostril up': [0.3, 3], 'upper lip up': [1.5, 6], 'corner up': [-5, -1], 'lower lid up': [1, 4], 'chin up': [0.5, 4] }, // 9 + 10 + 15 + 17
};

/** The others: those that are good smile without worry, those that are not do not smile. */
const GOOD = { ...CALM, 'brows together': [-0.5, 0.9], 'inner brow up': [-1, 3.5], 'corner up': [1.5, 7], 'corner out': [1.5, 8], 'cheek up': [1.5, 7] };
const OTHERS = {
  distress: { 'inner brow up': SOME, 'brows together': [1, 7], 'corner up': [-6, -1] },
  embarrassment: { 'corner up': [0.5, 4], 'upper lid up': [-4, -0.5] }, // 12, held back, with the look down
  'happy-for': GOOD,
  gloating: { 'corner up': [1.5, 7], 'inner brow up': [-3, 1] },
  resentment: { 'brows together': [1, 7], 'inner brow up': [-6, 0], 'corner up': [-4, -0.8] },
  relief: { ...GOOD, 'upper lid up': [-4, -1] },
  jealousy: { 'brows together': [1, 7], 'corner up': [-4, -0.8] },
  envy: { 'brows together': [1, 7], 'corner up': [-4, -0.8] },
  'sorry-for': { 'inner brow up': [2, 8], 'brows together': [0.5, 5], 'corner up': [-5, -1] },
  hope: { ...GOOD, 'corner up': [0.8, 7], 'corner out': SOME, 'inner brow up': [1, 5.5], 'outer brow up': [1, 6] },
  satisfaction: GOOD,
  'fear-confirmed': { 'inner brow up': [3, 9], 'brows together': [1, 7], 'corner up': [-6, -1] },
  disappointment: { 'inner brow up': SOME, 'corner up': [-5, -1] },
  pride: GOOD,
  shame: { 'upper lid up': [-5, -1], 'corner up': [-5, -1] },
  reproach: { 'brows together': [1, 7], 'corner up': [-4, -0.5] },
  liking: GOOD,
  disliking: { 'brows together': [0.8, 6], 'inner brow up': [-7, -1], 'upper lip up': SOME, 'corner up': [-4, -0.5] },
  gratitude: GOOD,
  gratification: GOOD,
  remorse: { 'inner brow up': [3, 9], 'brows together': [1, 7], 'corner up': [-6, -1] },
  love: GOOD,
  hate: { 'brows together': [3, 8], 'inner brow up': [-10, -3], 'corner up': [-5, -0.8] },
};

function check(name, moves, limits, share = 1) {
  for (const [move, [least, most]] of Object.entries(limits)) {
    const value = moves[move];
    const [low, high] = [least, most].map((limit, i) => (Math.abs(limit) < 1 ? limit : limit * (limit > 0 === (i === 0) ? share : 1 / share)));
    assert.ok(value >= low && value <= high, `${name}: ${move} is ${value.toFixed(2)} mm, not ${low.toFixed(1)} to ${high.toFixed(1)}`);
  }
}

test('every affect is compared with FACS', () => assert.deepEqual(Object.keys({ ...BASIC, ...OTHERS }).sort(), [...names].sort()));

for (const [name, limits] of Object.entries({ ...BASIC, ...OTHERS }))
  test(`${name} moves what its action units move, and nothing else`, () => check(name, ofMara(poses[name]), limits));

test('every head shows the six basic emotions by these action units', () => {
  assert.ok(people.length >= 8, `${people}`);
  for (const person of people) {
    const measure = measuring(head(person));
    for (const [name, limits] of Object.entries(BASIC)) check(`${person}, ${name}`, measure(poses[name]), limits, 0.7);
  }
});

test('the table of the documentation shows these movements', () => {
  const rows = fs.readFileSync(path.join(root, 'models/expressions.md'), 'utf8').split('\n').map((line) => line.split('|').slice(1, -1).map((cell) => cell.trim()));
  const titles = ['affect', ...Object.keys(ofMara({}))];
  const start = rows.findIndex((cells) => cells.join() === titles.join());
  assert.ok(start > 0, `no table of ${titles}`);
  for (const [i, name] of names.entries()) {
    const [title, ...cells] = rows[start + 2 + i];
    assert.equal(title, name);
    for (const [k, value] of Object.values(ofMara(poses[name])).entries())
      assert.ok(Math.abs(Number(cells[k]) - value) < 0.11, `${name}, ${titles[k + 1]}: ${cells[k]} in the table, ${value.toFixed(2)} measured`);
  }
});
