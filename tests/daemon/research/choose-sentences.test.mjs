// SPDX-License-Identifier: GPL-3.0-or-later
// faccia corpus: the sentences that it chooses cover what it says, counted again from the phones of each sentence spoken alone.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const SENTENCES = [
  'Il gatto dorme sul tetto.', 'Il gatto dorme sul tetto rosso.', 'Una nuvola grigia passa lenta.', 'Il gatto dorme.', 'Chi bussa alla porta di notte?',
  'Sul tetto dorme il gatto.', 'Gli zii giocano a scacchi.', 'Il gatto dorme ancora sul tetto.', 'Che bello!', 'Ogni sogno svanisce presto.', 'Il tetto rosso.',
];
const phones = new Map();
const phonesOf = (sentence) => {
  if (!phones.has(sentence)) {
    const json = path.join(folder, 'a.json');
    const { status, stderr } = faccia(['say', '--lang', 'it', '--json', json, sentence]);
    assert.equal(status, 0, stderr);
    phones.set(sentence, JSON.parse(fs.readFileSync(json)).phones.map(({ ipa }) => ipa || '_'));
  }
  return phones.get(sentence);
};
const units = (sentence, size) => {
  const list = size > 1 ? ['_', ...phonesOf(sentence), '_'] : phonesOf(sentence);
  return list.slice(size - 1).map((_, i) => list.slice(i, i + size).join(' '));
};
const choose = (...args) => {
  const { status, stdout, stderr } = faccia(['corpus', '--lang', 'it', ...args, SENTENCES.join('\n')]);
  assert.equal(status, 0, stderr);
  const [, taken, all, known, kinds] = /^(\d+) of (\d+) sentences, \d+ s: (\d+) of the (\d+) \w+ in them \([\d.]+ %\)$/m.exec(stderr) ?? assert.fail(stderr);
  return { lines: stdout.split('\n').filter(Boolean), taken: Number(taken), all: Number(all), known: Number(known), kinds: Number(kinds) };
};
const covered = (sentences, size) => new Set(sentences.flatMap((sentence) => units(sentence, size)));

for (const [size, unit] of [[1, 'phones'], [2, 'diphones'], [3, 'triphones']])
  test(`covers all ${unit}, with fewer sentences than there are`, () => {
    const { lines, taken, all, known, kinds } = choose('--unit', unit);
    assert.equal(all, SENTENCES.length - 1, 'one has two words');
    assert.equal(taken, lines.length);
    assert.equal(new Set(lines).size, lines.length);
    assert.ok(lines.every((line) => SENTENCES.includes(line)), lines.join(' / '));
    const whole = covered(SENTENCES.filter((sentence) => sentence.split(' ').length > 2), size);
    assert.deepEqual([known, kinds], [whole.size, whole.size]);
    assert.deepEqual(covered(lines, size), whole);
    assert.ok(lines.length < all, `${lines.length} of ${all}`);
  });

test('a few chosen ones cover more than as many from the beginning; limits hold', () => {
  const { lines } = choose('--count', '3');
  assert.equal(lines.length, 3);
  assert.ok(covered(lines, 2).size > 1.2 * covered(SENTENCES.slice(0, 3), 2).size);
  const half = choose('--cover', '50');
  assert.ok(half.known >= half.kinds / 2 && half.lines.length < choose().lines.length);
  assert.ok(choose('--least', '5', '--most', '5').lines.every((line) => line.split(' ').length === 5));
});

test('reports wrong usage', () => {
  for (const [args, code, message] of [[['--unit', 'words', 'Ciao a tutti.'], 2, /--unit: must be phones/], [['--lang', 'xx', 'Ciao a tutti.'], 2, /xx/], [[], 2, /text/i], [['--cover', '0', 'a'], 2, /--cover/]]) {
    const { status, stderr } = faccia(['corpus', ...args]);
    assert.match(stderr, message);
    assert.equal(status, code, args.join(' '));
  }
});
