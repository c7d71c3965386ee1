// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture proposes for a head: of drawn heads, whose truth is known, and of NASA's public-domain portrait from Debian's
// python3-skimage; and heads that wear the hair, beard and glasses of others.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat } from '../../models/tools/portrait/images.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';
import { dress, beardOfKind } from '../../web/portrait/dress.mjs';
import { isLong, offerOf, wornOf } from '../../web/portrait/offer.mjs';
import { traitsOf } from '../../web/portrait/traits.mjs';
import { LEARNT } from '../../web/portrait/traits-learnt.mjs';
import { violations } from '../lib/schema.mjs';

const built = fileURLToPath(new URL('../../build/', import.meta.url));
const table = JSON.parse(fs.readFileSync(path.join(built, 'web/face-points.json'), 'utf8'));
const head = (name) => JSON.parse(fs.readFileSync(path.join(built, `models/heads/${name}.json`), 'utf8'));
const named = (json, word) => json.parts.filter(({ name }) => name.startsWith(word));
let offers;

before(async () => {
  const eye = await openEye();
  offers = {};
  for (const [name, file] of [...Object.keys(table).map((name) => [name, path.join(built, `models/heads/${name}.webp`)]), ['person', '/usr/lib/python3/dist-packages/skimage/data/astronaut.png']]) {
    const picture = await flat(file);
    offers[name] = offerOf({ picture, landmarks: await eye(picture) }, table);
  }
});

test('recognises glasses, beard and long hair where they are, and none that are not', () => {
  const has = { bruno: ['beard', 'moustache'], rosa: ['glasses'], mara: ['long'], mei: ['long'] };
  for (const [name, { traits }] of Object.entries(offers))
    for (const [trait, answer] of Object.entries(traits)) {
      const wrong = has[name]?.includes(trait) ? 'no' : 'yes';
      assert.notEqual(answer, wrong, `${name}: ${trait}`);
    }
  assert.equal(offers.rosa.traits.glasses, 'yes');
  assert.equal(offers.mei.traits.long, 'yes');
});

test('offers three hairstyles, the most similar first, and long and short ones where it is not sure', () => {
  for (const [name, { styles, traits, first }] of Object.entries(offers)) {
    assert.equal(new Set(styles).size, 3, name);
    if (traits.long === 'unsure') {
      assert.equal(new Set(styles.map((style) => isLong(table[style]))).size, 2, name);
      assert.equal(first.hair, null, 'its user must choose');
    } else if (name !== 'person') assert.equal(styles[0], name);
  }
});

test('says unsure between its bounds, and asks whether a head is bald', () => {
  const measured = (score) => Object.fromEntries(Object.values(LEARNT).map(({ from, weights }) => [from, weights.map(() => score)]));
  for (const [name, { yes, no, bias, from, weights }] of Object.entries(LEARNT)) {
    const sum = weights.reduce((all, w) => all + w, 0);
    const at = (score) => traitsOf({ ...measured(0), [from]: weights.map(() => (score - bias) / sum) })[name];
    assert.deepEqual([at(yes + 0.01), at(no - 0.01)], ['yes', 'no'], name);
    if (yes > no) assert.equal(at((yes + no) / 2), 'unsure', name);
  }
});

test('a head wears what others have, laid onto its own skull, and stays a valid head', async () => {
  const [luca, mei] = [head('luca'), head('mei')];
  const dressed = dress(luca, mei, 'hair');
  assert.equal(violations('head-model', dressed), null);
  assert.equal(named(dressed, 'hair').length, named(mei, 'hair').length);
  assert.notEqual(named(dressed, 'hair')[0].position.data, named(mei, 'hair')[0].position.data);
  assert.ok(JSON.stringify(luca) === JSON.stringify(head('luca')), 'the base is left as it is');
  const top = (json, word) => {
    const { position } = unpack(json).parts.find(({ name }) => name.startsWith(word));
    return position.reduce((most, y, i) => (i % 3 === 1 ? Math.max(most, y) : most), -Infinity);
  };
  const [above, was] = [top(dressed, 'hair') - top(luca, 'skin'), top(mei, 'hair') - top(mei, 'skin')];
  assert.ok(Math.abs(above - was) < 6, `hair is ${above.toFixed(1)} mm above the skull, on its own head ${was.toFixed(1)}`);
});

test('a moustache is the part of a beard above the corners of the lips', () => {
  const bruno = head('bruno');
  const only = beardOfKind(bruno, 'moustache');
  assert.equal(violations('head-model', only), null);
  const [part, whole] = [only, bruno].map((json) => readModel(json).parts.find(({ name }) => name === 'beard'));
  assert.ok(part.index.length > 300 && part.index.length < whole.index.length / 2, `${part.index.length} of ${whole.index.length}`);
  const { fdp } = readModel(bruno);
  const low = Math.min(fdp['8.4'][1], fdp['8.3'][1]);
  assert.ok([...part.index].every((v) => part.position[3 * v + 1] > low));
});

test('a choice is worn once: the base keeps its own, or wears that of another', async () => {
  const load = async (name) => ({ name, ...head(name) });
  const own = await wornOf({ hair: 'bruno', beard: 'full', glasses: 'none' }, 'bruno', table, load);
  assert.deepEqual([own.keep, Object.keys(own.wear), own.bearded], [['hair', 'beard'], [], true]);
  const other = await wornOf({ hair: 'none', beard: 'moustache', glasses: 'some' }, 'bruno', table, load);
  assert.deepEqual([other.keep, Object.keys(other.wear)], [[], ['beard', 'glasses']]);
  assert.equal(other.wear.glasses.name, 'rosa');
});
