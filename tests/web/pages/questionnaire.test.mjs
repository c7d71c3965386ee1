// SPDX-License-Identifier: GPL-3.0-or-later
// Questionnaires: what the page reads is what the schema allows, and the counts are right.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import fs from 'node:fs';
import path from 'node:path';
import { root } from '../../lib/daemon.mjs';
import { answersCsv, readQuestionnaire, tally } from '../../../web/pages/operator/questionnaire.js';
import { readTable } from '../../../web/pages/operator/scene.js';
import { readManner, sizeFrom } from '../../../web/pages/room/manner.js';

const ITEMS = [{ id: 'liked', text: 'Did you like it?', scale: ['No', 'A little', 'Much'] }, { id: 'why', text: 'Why?', seconds: 30 }];
const valid = new Ajv({ strictTypes: false }).compile(JSON.parse(fs.readFileSync(path.join(root, 'protocol/schema/questionnaire.json'))));

test('reads what the schema allows, and names the place of an error', () => {
  const good = { title: 'How it was', lang: 'en', items: ITEMS, answers: [{ id: 'liked', reason: 'chosen', choice: 2, text: 'Much', seconds: 3.5 }] };
  assert.ok(valid(good));
  assert.deepEqual(readQuestionnaire(good), good);
  const wrong = { title: (q) => (q.title = ''), items: (q) => (q.items = []), 'items.0.scale': (q) => (q.items[0].scale = ['Yes']), 'items.1.text': (q) => delete q.items[1].text, 'items.1.seconds': (q) => (q.items[1].seconds = 0) };
  for (const [place, change] of Object.entries(wrong)) {
    const copy = structuredClone(good);
    change(copy);
    assert.ok(!valid(copy), place);
    assert.throws(() => readQuestionnaire(copy), { place });
  }
  for (const none of [null, 7, 'x', {}]) assert.throws(() => readQuestionnaire(none), { place: 'title' });
  assert.throws(() => readQuestionnaire({ ...good, items: [ITEMS[0], ITEMS[0]] }), { place: 'items.1.id' });
  assert.throws(() => readQuestionnaire({ ...good, answers: [{ id: 'other' }] }), { place: 'answers' });
});

test('counts percentages, means and words, without those who did not answer', () => {
  const people = [
    [{ id: 'liked', reason: 'chosen', choice: 2, text: 'Much' }, { id: 'why', reason: 'heard', text: '=1+1, "really"' }],
    [{ id: 'liked', reason: 'chosen', choice: 1, text: 'A little' }, { id: 'why', reason: 'timeout' }],
    [{ id: 'liked', reason: 'chosen', choice: 2, text: 'Much' }],
    [{ id: 'liked', reason: 'timeout' }],
  ];
  const [liked, why] = tally(ITEMS, people);
  assert.deepEqual(liked.counts.map(({ count }) => count), [0, 1, 2]);
  assert.deepEqual(liked.counts.map(({ percent }) => Math.round(percent)), [0, 33, 67]);
  assert.ok(Math.abs(liked.mean - 8 / 3) < 1e-9 && liked.n === 3);
  assert.deepEqual([why.n, why.mean, why.words], [1, null, ['=1+1, "really"']]);
  assert.deepEqual(tally(ITEMS, []).map(({ n, mean }) => [n, mean]), [[0, null], [0, null]]);
  const table = answersCsv(ITEMS, people);
  assert.deepEqual(readTable(table).slice(1).map((row) => row[0]), ['1', '1', '2', '2', '3', '4']);
  assert.deepEqual(readTable(table)[2], ['1', 'why', 'Why?', 'heard', '', '=1+1, "really"', '']);
});

test("the person's manner is bounded, and captions grow with the distance", () => {
  assert.deepEqual(readManner({ speed: 9, pitch: 'x', volume: 0.8, distance: 2 }), { speed: 2, pitch: 1, volume: 0.8, distance: 2 });
  assert.deepEqual(readManner(null), { speed: 1, pitch: 1, volume: 1, distance: null });
  const millimetres = (metres) => Number(/([\d.]+)mm/.exec(sizeFrom(metres))[1]);
  assert.ok(Math.abs(millimetres(3) - 3 * millimetres(1)) < 0.2);
  assert.ok(Math.abs((millimetres(2) * 0.7) / 2000 - Math.tan((22 / 60) * Math.PI / 180)) < 1e-4); // 22 minutes of arc
});
