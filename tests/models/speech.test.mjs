// SPDX-License-Identifier: GPL-3.0-or-later
// The speech packs against their schema; and what the programs say of a broken one.
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

test('lists the languages that have packs, and the general one', () => assert.deepEqual(packs.sort(), ['cmn.json', 'en.json', 'it.json', 'pt-BR.json', 'tr.json', 'und.json', 'yue.json']));

for (const name of packs)
  test(`${name} matches the schema`, () => {
    assert.ok(validate(read(name)), JSON.stringify(validate.errors?.slice(0, 3)));
  });

for (const name of ['it', 'en', 'tr', 'pt-BR'])
  test(`${name}.json names a source for each phone`, () => {
    for (const [phone, { source }] of Object.entries(read(`${name}.json`).phones)) assert.match(source ?? '', /measured|printed|by rule/, phone);
  });

for (const kind of ['visemes', 'letters', 'alphabets'])
  for (const name of fs.readdirSync(path.join(folder, kind)).filter((file) => file.endsWith('.json')))
    test(`${kind}/${name} matches the schema`, () => {
      const check = schema(kind);
      assert.ok(check(read(`${kind}/${name}`)), JSON.stringify(check.errors?.slice(0, 3)));
    });

test('the programs report an error in a language file with its position (tests/corpus has all kinds)', () => {
  const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  fs.cpSync(folder, path.join(models, 'speech'), { recursive: true });
  const table = read('visemes/pt.json');
  delete table.groups.i.class;
  fs.writeFileSync(path.join(models, 'speech/visemes/pt.json'), JSON.stringify(table));
  const { status, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['say', 'a'], { env: { ...process.env, FACCIA_MODELS: models } });
  fs.rmSync(models, { recursive: true });
  assert.equal(status, 1);
  assert.match(String(stderr), /visemes: "pt": groups\.i\.class/);
});

test('adds a language by one file', () => {
  const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  fs.cpSync(folder, path.join(models, 'speech'), { recursive: true });
  fs.copyFileSync(path.join(root, 'models/expressions.json'), path.join(models, 'expressions.json'));
  const spanish = { tag: 'es', name: 'español', inherits: 'it', sources: ['a test'], voices: ['espeak:es'], abbreviations: ['sr'], phones: { x: { sampa: 'x', like: 'k' }, θ: { sampa: 'T', like: 'θ' } } };
  assert.ok(validate(spanish), JSON.stringify(validate.errors?.slice(0, 3)));
  fs.writeFileSync(path.join(models, 'speech/es.json'), JSON.stringify(spanish));
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['say', '--lang', 'es', 'El hijo come jamón.'], { env: { ...process.env, FACCIA_MODELS: models } });
  fs.rmSync(models, { recursive: true });
  assert.equal(status, 0, String(stderr));
  assert.equal(JSON.parse(stdout).lang, 'es');
});

test('the general pack is the output of its tool', () => {
  const { status, stdout, stderr } = spawnSync('python3', [path.join(root, 'models/tools/make-speech-und.py')]);
  assert.equal(status, 0, String(stderr));
  assert.deepEqual(JSON.parse(stdout), read('und.json'));
});
