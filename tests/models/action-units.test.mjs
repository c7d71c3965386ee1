// SPDX-License-Identifier: GPL-3.0-or-later
// The affects against the Facial Action Coding System: each has the action units that the literature gives it, strong enough to be seen, and no
// others. Measured in mm on the built heads (models/tools/expressions).
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { readFapFrames } from '../../models/tools/lib/fap-frames.mjs';
import { AFFECTS, faultsOf, gradeOf, tableOf, UNITS, unitsTable } from '../../models/tools/expressions/facs.mjs';
import { measuring } from '../../models/tools/expressions/measure.mjs';
import { heads } from '../lib/built-heads.mjs';
import { build, root } from '../lib/daemon.mjs';
import { BASIC } from '../lib/sweep-poses.mjs';

const faccia = path.join(build, 'server/cli/faccia');
const expressions = JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json')));
const names = Object.keys(expressions.affect);
const people = fs.readdirSync(heads).filter((file) => /^\w+\.json$/.test(file)).map((file) => file.slice(0, -5));
const measureOf = (name) => measuring(unpack(JSON.parse(fs.readFileSync(path.join(heads, `${name}.json`)))));
const mara = measureOf('mara');

/** FAPs of expressions (affects, or others with their kind) at full intensity, by the program, with that file. */
function poses(wanted, file = expressions) {
  const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  try {
    fs.writeFileSync(path.join(models, 'expressions.json'), JSON.stringify(file));
    const { status, stdout, stderr } = spawnSync(faccia, ['expressions', '--fap', ...wanted.map((name) => `${name}=1`)], { encoding: 'utf8', env: { ...process.env, FACCIA_MODELS: models } });
    assert.equal(status, 0, stderr);
    return readFapFrames(stdout);
  } finally {
    fs.rmSync(models, { recursive: true });
  }
}
const frames = Object.fromEntries(poses(names).map((frame, i) => [names[i], frame]));

test('every affect is compared with FACS', () => assert.deepEqual(Object.keys(AFFECTS).sort(), [...names].sort()));

for (const name of names) test(`${name} has its action units, and no others`, () => assert.deepEqual(faultsOf(name, mara(frames[name])), []));

test('signals with the number of an action unit show that unit, and none more than it', () => {
  const signals = Object.entries(expressions.signal).flatMap(([name, { aliases = [], pose }]) =>
    aliases.map((alias) => [name, Number(/^au(\d+)$/.exec(alias)?.[1])]).filter(([, unit]) => pose && unit in UNITS));
  assert.ok(signals.length >= 12, `${signals}`);
  for (const [name, unit] of signals) {
    const moves = mara(poses([`signal:${name}`])[0]);
    const own = gradeOf(unit, moves);
    const more = Object.keys(UNITS).filter((other) => gradeOf(other, moves) > own);
    assert.ok(own && !more.length, `${name}: AU ${unit} ${own || 'is absent'}, beside ${more}`);
  }
});

test('every head shows the six basic emotions by these action units', () => {
  assert.ok(people.length >= 8, `${people}`);
  const faults = people.flatMap((person) => {
    const measure = measureOf(person);
    return BASIC.flatMap((name) => faultsOf(name, measure(frames[name]), 1.4).map((fault) => `${person}: ${fault}`));
  });
  assert.deepEqual(faults, []);
});

/** Changes of a pose that make it another expression, and the unit that tells. */
const WRONG = [
  ['joy', { squeeze_eyebrow: 60 }, /AU 4/], // a worried smile
  ['joy', { raise_i_eyebrow: 90 }, /AU 1/],
  ['joy', { lift_cheek: 0 }, /AU 6/], // a smile without eyes
  ['joy', { raise_cornerlip: 0 }, /AU 12/],
  ['sadness', { raise_o_eyebrow: 120 }, /AU 2/],
  ['sadness', { raise_cornerlip: 60 }, /AU 15/],
  ['anger', { close_t_eyelid: 60 }, /AU 5/], // a glare without eyes
  ['anger', { open_jaw: 250 }, /AU 26/],
  ['fear', { stretch_cornerlip: -80, open_jaw: 560 }, /AU 20/], // surprise
  ['fear', { squeeze_eyebrow: 0 }, /AU 4/],
  ['disgust', { raise_nose: 0, stretch_nose: 0 }, /AU 9/],
  ['disgust', { lower_t_midlip: 0, lower_t_lip_lm: 0, lower_t_lip_rm: 0 }, /AU 10/],
  ['surprise', { squeeze_eyebrow: 90 }, /AU 4/],
  ['surprise', { stretch_cornerlip: 200 }, /AU 20/],
];

for (const [name, changes, told] of WRONG)
  test(`${name} with ${JSON.stringify(changes)} is wrong`, () => {
    const file = structuredClone(expressions);
    Object.assign(file.affect[name].pose, changes);
    assert.match(faultsOf(name, mara(poses([name], file)[0])).join('\n'), told);
  });

test('the tool prints the table, and what is wrong with a head on which nothing moves', () => {
  const tool = path.join(root, 'models/tools/expressions/check-expressions.mjs');
  const run = (file) => spawnSync('node', [tool, faccia, file], { encoding: 'utf8' });
  const right = run(path.join(heads, 'mara.json'));
  assert.equal(right.status, 0, right.stdout + right.stderr);
  assert.equal(right.stdout.trim(), tableOf(Object.fromEntries(Object.keys(AFFECTS).map((name) => [name, mara(frames[name])]))).join('\n'));
  const head = JSON.parse(fs.readFileSync(path.join(heads, 'mara.json')));
  for (const part of head.parts) part.moves = [];
  const file = path.join(os.tmpdir(), `faccia-stiff-${process.pid}.json`);
  fs.writeFileSync(file, JSON.stringify(head));
  const stiff = run(file);
  fs.rmSync(file);
  assert.equal(stiff.status, 1, stiff.stderr);
  assert.match(stiff.stdout, /joy: AU 12, corners up and out, is 0\.0 mm, less than C/);
  assert.equal(spawnSync('node', [tool]).status, 2);
});

test('the tables of the documentation are these', () => {
  const page = fs.readFileSync(path.join(root, 'models/expressions.md'), 'utf8');
  for (const row of unitsTable()) assert.ok(page.includes(row), row);
  const rows = page.split('\n').map((line) => line.split('|').slice(1, -1).map((cell) => cell.trim()));
  const table = tableOf(Object.fromEntries(Object.keys(AFFECTS).map((name) => [name, mara(frames[name])]))).map((line) => line.split('|').slice(1, -1).map((cell) => cell.trim()));
  const start = rows.findIndex((cells) => cells.join() === table[0].join());
  assert.ok(start > 0, `no table of ${table[0]}`);
  const number = (cell) => Number(/^[\d.]+/.exec(cell)?.[0] ?? 0);
  for (const [i, cells] of table.entries())
    cells.forEach((cell, k) => {
      const said = rows[start + i][k];
      const near = k > 0 && k <= Object.keys(UNITS).length && Math.abs(number(cell) - number(said)) < 0.11 && number(said) > 0;
      assert.ok(cell === said || near, `${cells[0]}, ${table[0][k]}: "${said}" in the table, "${cell}" measured (check-expressions.mjs --write)`);
    });
});
