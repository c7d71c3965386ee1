// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import fs from 'node:fs';
import test from 'node:test';
import { layOut, markupOf, mixAt, pointOf, spread } from '../../../web/pages/shared/mood-disc.js';
import { emotion as words } from '../../../web/pages/texts/index.js';

const affect = (name, activation, evaluation, basic = true) => ({ name, activation, evaluation, basic });
const affects = [
  affect('joy', 0.2, 0.4),
  affect('surprise', 0.4, 0),
  affect('anger', 0.3, -0.4),
  affect('fear', 0.1, -0.4),
  affect('disgust', -0.17, -0.4),
  affect('sadness', -0.2, -0.4),
  affect('love', 0.05, 0.3, false),
  affect('hate', 0.6, -0.6, false),
  affect('relief', 0.05, 0.3, false),
];
const placed = layOut(affects);
const at = (angle, radius) => ({ x: radius * Math.cos(angle), y: radius * Math.sin(angle) });
const angleOf = (name) => placed.find((a) => a.name === name).angle;

test('places the basic emotions at equal distances, in the order of their true angles', () => {
  const angles = placed.filter((a) => a.basic).map((a) => a.angle).sort((a, b) => a - b);
  angles.slice(1).forEach((angle, i) => assert.ok(Math.abs(angle - angles[i] - Math.PI / 3) < 1e-9));
  assert.ok(Math.abs(angleOf('joy') - Math.atan2(0.2, 0.4)) < 1e-9, 'the first one where it is');
});

test('places the others between their neighbours, inside', () => {
  const hate = placed.find((a) => a.name === 'hate');
  assert.ok(hate.angle > angleOf('surprise') && hate.angle < angleOf('fear'));
  assert.ok(hate.radius < 1 && hate.radius > placed.find((a) => a.name === 'love').radius);
});

test('a mixture lies where it was selected', () => {
  for (let angle = 0; angle < 2 * Math.PI; angle += 0.3)
    for (const radius of [0.2, 0.7, 1]) {
      const point = at(angle, radius), back = pointOf(mixAt(point, placed), placed);
      assert.ok(Math.hypot(point.x - back.x, point.y - back.y) < 0.03, `${angle} ${radius}`);
    }
  assert.deepEqual(pointOf([], placed), { x: 0, y: 0, affect: null });
  const alone = pointOf([{ name: 'love', intensity: 0.5 }], placed);
  assert.equal(alone.affect, 'love');
  assert.ok(Math.abs(Math.atan2(alone.y, alone.x) - angleOf('love')) < 1e-9);
});

test('separates overlapping dots', () => {
  const dots = spread(placed, 0.1);
  for (const [i, a] of dots.entries())
    for (const b of dots.slice(i + 1)) assert.ok(Math.hypot(a.x - b.x, a.y - b.y) > 0.099, `${a.name} and ${b.name}`);
});

test('a direction is an emotion, the distance from the middle its intensity', () => {
  for (const { name, angle } of placed.filter((a) => a.basic)) {
    assert.deepEqual(mixAt(at(angle, 1), placed), [{ name, intensity: 1 }]);
    assert.deepEqual(mixAt(at(angle, 0.4), placed), [{ name, intensity: 0.4 }]);
  }
  assert.deepEqual(mixAt({ x: 0, y: 0 }, placed), []);
});

test('mixes two neighbouring emotions, all the way round without a jump', () => {
  const half = mixAt(at(angleOf('joy') + Math.PI / 6, 0.8), placed);
  assert.deepEqual(half.map((p) => p.name).sort(), ['joy', 'surprise']);
  assert.deepEqual(half.map((p) => p.intensity), [0.4, 0.4]);
  const vector = (angle) => {
    const mix = mixAt(at(angle, 1), placed);
    assert.ok(mix.length <= 2);
    return Object.fromEntries(mix.map((p) => [p.name, p.intensity]));
  };
  for (let angle = 0; angle < 7; angle += 0.02) {
    const [a, b] = [vector(angle), vector(angle + 0.02)];
    for (const { name } of affects) assert.ok(Math.abs((a[name] ?? 0) - (b[name] ?? 0)) < 0.04, `${name} at ${angle}`);
  }
});

test('shows no disc and no error without affects', () => {
  assert.deepEqual(layOut([]), []);
  assert.deepEqual(mixAt({ x: 1, y: 0 }, []), []);
});

test('writes the mixture as markup', () => {
  const mix = [{ name: 'joy', intensity: 0.6 }, { name: 'surprise', intensity: 0.2 }];
  assert.match(markupOf('apml', mix, 'Tom & <b>', 'it'), /<rheme affect="joy" intensity="0.6">Tom &amp; &lt;b&gt;<\/rheme>/);
  assert.match(markupOf('jsml', mix, 'Ciao', 'it'), /<HAPPY WEIGHT="0.6"><SURPRISED WEIGHT="0.2">Ciao<\/SURPRISED><\/HAPPY>/);
  assert.match(markupOf('ssml', mix, 'Ciao', 'it'), /<emo:category name="joy" value="0.6"\/><emo:category name="surprise" value="0.2"\/>Ciao/);
  assert.match(markupOf('apml', [], 'Ciao', 'it'), /<rheme>Ciao</);
});

test('the page has its texts in every language, and a word for every affect', () => {
  const { affect: known } = JSON.parse(fs.readFileSync(new URL('../../../models/expressions.json', import.meta.url)));
  for (const [lang, table] of Object.entries(words)) {
    assert.deepEqual(Object.keys(table).sort(), Object.keys(words.en).sort(), lang);
    if (lang !== 'en') assert.deepEqual(Object.keys(table.affects).sort(), Object.keys(known).sort(), lang);
  }
});
