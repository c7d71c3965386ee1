// SPDX-License-Identifier: GPL-3.0-or-later
// All heads: made from recipes alone, each against everything that a head must be. The default one has head.test.mjs as well.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { mouthFigures } from '../../models/tools/lib/anatomy.mjs';
import { merge, readRecipe } from '../../models/tools/head/recipe.mjs';
import { violations } from '../lib/schema.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');
const recipes = path.join(root, 'models/heads');
const built = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'models/heads');
const names = fs.readdirSync(recipes).filter((file) => file.endsWith('.json')).map((file) => file.slice(0, -5));
const head = (name) => JSON.parse(fs.readFileSync(path.join(built, `${name}.json`)));

test('there are at least ten people, and Mara is the first', () => {
  assert.ok(names.length >= 10, `${names}`);
  const ranked = names.map(head).sort((a, b) => a.rank - b.rank);
  assert.equal(ranked[0].name, 'mara');
  assert.equal(new Set(ranked.map(({ rank }) => rank)).size, names.length, 'ranks');
  for (const { name, about, voice } of ranked) {
    assert.ok(about, `${name}: no word on who it is`);
    assert.match(voice.gender, /^(female|male)$/, name);
  }
  for (const part of ['beard', 'glasses']) assert.ok(ranked.some(({ parts }) => parts.some(({ name }) => name === part)), `nobody has ${part}`);
  const figures = names.map((name) => mouthFigures(readRecipe(path.join(recipes, `${name}.json`))));
  for (const male of [0, 1]) {
    const ages = figures.filter((one) => Math.round(one.male) === male).map(({ age }) => age);
    assert.ok(Math.max(...ages) > 60 && Math.min(...ages) < 40, `${male ? 'men' : 'women'} of ${ages}`);
  }
});

for (const name of names)
  test(`${name} matches the schema and limits of a head`, () => {
    const tool = path.join(root, 'models/tools/check-head.mjs');
    const run = spawnSync(process.execPath, [tool, path.join(built, `${name}.json`)], { encoding: 'utf8' });
    assert.equal(run.stdout, `${name}: as it should be\n`);
    assert.equal(violations('head-model', head(name)), null);
    const poster = fs.readFileSync(path.join(built, `${name}.webp`));
    assert.equal(poster.toString('latin1', 8, 12), 'WEBP');
    assert.ok(poster.length > 3000 && poster.length < 20000, `poster of ${poster.length} bytes`);
  });

for (const name of names)
  test(`the skin of ${name} is fully coloured`, async () => {
    const { data, info } = await sharp(Buffer.from(head(name).textures.skin.data, 'base64')).removeAlpha().raw().toBuffer({ resolveWithObject: true });
    let green = 0; // NaN becomes null when written: nothing of red and blue would remain (compression shifts a dark texel by 14 at most)
    for (let i = 0; i < data.length; i += info.channels) green += data[i + 1] > data[i] + 20;
    assert.equal(green, 0, `${green} texels are greener than red`);
  });

test('shared parts of two heads are identical bytes', () => {
  const [mara, mei] = ['mara', 'mei'].map(head); // of like age: teeth wear
  const part = (json, name) => json.parts.find((one) => one.name === name);
  for (const name of ['teeth_upper', 'teeth_lower', 'tongue'])
    for (const list of ['uv', 'index']) assert.equal(part(mara, name)[list].data, part(mei, name)[list].data, `${name} ${list}`);
  for (const name of ['teeth', 'tongue']) assert.equal(mara.textures[name].data, mei.textures[name].data, name);
});

test('a recipe with `like` inherits whatever it leaves out', () => {
  const base = { a: 1, list: [1, 2], in: { x: 1, y: { z: 2 } }, gone: {} };
  assert.deepEqual(merge(base, { a: 2, list: [3], in: { y: { w: 1 } }, gone: null }), { a: 2, list: [3], in: { x: 1, y: { z: 2, w: 1 } } });
  assert.deepEqual(merge(base, { in: { like: null, only: 1 } }).in, { only: 1 });
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'recipes-'));
  try {
    fs.writeFileSync(path.join(folder, 'one.json'), '{"like":"two"}');
    fs.writeFileSync(path.join(folder, 'two.json'), '{"like":"one"}');
    assert.throws(() => readRecipe(path.join(folder, 'one.json')), /circle/);
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
  const bruno = readRecipe(path.join(recipes, 'bruno.json'));
  assert.ok(bruno.fdp['2.1'], 'from Mara');
  assert.equal(bruno.like, undefined);
  assert.equal(bruno.shape['macrodetails/caucasian-female-young'], undefined, 'a shape stands alone');
});
