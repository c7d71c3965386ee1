// SPDX-License-Identifier: GPL-3.0-or-later
// The speech packs against their schema; and what the loader says of a broken one.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { build, root } from '../lib/daemon.mjs';

const folder = path.join(root, 'models/speech');
const read = (name) => JSON.parse(fs.readFileSync(path.join(folder, name)));
const schema = (name) => new Ajv({ strict: false }).compile(read(`schema/${name}.json`));
const validate = schema('pack');
const packs = fs.readdirSync(folder).filter((name) => name.endsWith('.json'));

test('the languages that have packs, and the one for all others', () => assert.deepEqual(packs.sort(), ['cmn.json', 'en.json', 'it.json', 'pt-BR.json', 'tr.json', 'und.json', 'yue.json']));

for (const name of packs)
  test(`${name} is as the schema says`, () => {
    assert.ok(validate(read(name)), JSON.stringify(validate.errors?.slice(0, 3)));
  });

for (const name of ['it', 'en', 'tr', 'pt-BR'])
  test(`${name}.json says of each phone where it comes from`, () => {
    for (const [phone, { source }] of Object.entries(read(`${name}.json`).phones)) assert.match(source ?? '', /measured|printed|by rule/, phone);
  });

for (const kind of ['visemes', 'letters', 'alphabets'])
  for (const name of fs.readdirSync(path.join(folder, kind)).filter((file) => file.endsWith('.json')))
    test(`${kind}/${name} is as the schema says`, () => {
      const check = schema(kind);
      assert.ok(check(read(`${kind}/${name}`)), JSON.stringify(check.errors?.slice(0, 3)));
    });

const broken = [
  ['pack', 'it', 'an unknown key', (pack) => (pack.phones.p.colour = 'red'), /phones\.p\.colour/],
  ['pack', 'it', 'a target outside of the phone', (pack) => (pack.phones.p.targets.LI.a.t = 2), /phones\.p\.targets\.LI\.a\.t/],
  ['pack', 'it', 'dominance above 1', (pack) => (pack.groups.a.coefficients.LI.alpha = 3), /groups\.a\.coefficients\.LI\.alpha/],
  ['pack', 'it', 'a contact of nothing', (pack) => (pack.phones.p.contact.kind = 'nose'), /phones\.p\.contact\.kind/],
  ['pack', 'it', 'no FAPUs', (pack) => delete pack.fapu, /fapu/],
  ['visemes', 'visemes/pt', 'a vowel without a class', (table) => delete table.groups.i.class, /groups\.i\.class/],
  ['visemes', 'visemes/pt', 'a rule of four places', (table) => table.rules[2].at.pop(), /rules\[2\]\.at/],
  ['visemes', 'visemes/pt', 'a place that there is not', (table) => (table.rules[0].right = '6'), /rules\[0\]\.right/],
  ['visemes', 'visemes/pt', 'a shape beside nothing', (table) => (table.visemes.p1.beside = []), /visemes\.p1\.beside/],
  ['letters', 'letters/tr', 'two letters for one', (table) => (table.letters.ch = table.letters.c), /letters\.ch/],
  ['letters', 'letters/tr', 'a letter of no length', (table) => (table.letters.a.ms = 0), /letters\.a\.ms/],
  ['letters', 'letters/tr', 'a consonant of another shape', (table) => (table.letters['ğ'].shapes = 'consonant'), /letters\.ğ\.shapes/],
  ['alphabets', 'alphabets/ipa', 'a place of articulation that nobody has', (alphabet) => (alphabet.consonants.p.place = 'nasal'), /consonants\.p\.place/],
  ['alphabets', 'alphabets/ipa', 'a vowel with a manner', (alphabet) => (alphabet.vowels.a.manner = 'nasal'), /vowels\.a\.manner/],
];
for (const [kind, name, what, change, place] of broken)
  test(`${name}, ${what}: schema and loader both name the place`, () => {
    const data = read(`${name}.json`);
    change(data);
    assert.equal(schema(kind)(data), false);
    const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
    fs.cpSync(folder, path.join(models, 'speech'), { recursive: true });
    fs.writeFileSync(path.join(models, `speech/${name}.json`), JSON.stringify(data));
    const { status, stderr } = spawnSync(path.join(build, 'server/app/faccia'), ['say', 'a'], { env: { ...process.env, FACCIA_MODELS: models } });
    fs.rmSync(models, { recursive: true });
    assert.equal(status, 1);
    assert.match(String(stderr), place);
  });

test('a new language is a file', () => {
  const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  fs.cpSync(folder, path.join(models, 'speech'), { recursive: true });
  fs.copyFileSync(path.join(root, 'models/expressions.json'), path.join(models, 'expressions.json'));
  const spanish = { tag: 'es', name: 'español', inherits: 'it', sources: ['a test'], voices: ['espeak:es'], abbreviations: ['sr'], phones: { x: { sampa: 'x', like: 'k' }, θ: { sampa: 'T', like: 'θ' } } };
  assert.ok(validate(spanish), JSON.stringify(validate.errors?.slice(0, 3)));
  fs.writeFileSync(path.join(models, 'speech/es.json'), JSON.stringify(spanish));
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/app/faccia'), ['say', '--lang', 'es', 'El hijo come jamón.'], { env: { ...process.env, FACCIA_MODELS: models } });
  fs.rmSync(models, { recursive: true });
  assert.equal(status, 0, String(stderr));
  assert.equal(JSON.parse(stdout).lang, 'es');
});

test('the general pack is what its tool writes', () => {
  const { status, stdout, stderr } = spawnSync('python3', [path.join(root, 'models/tools/make-speech-und.py')]);
  assert.equal(status, 0, String(stderr));
  assert.deepEqual(JSON.parse(stdout), read('und.json'));
});
