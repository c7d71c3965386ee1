// SPDX-License-Identifier: GPL-3.0-or-later
// The expressions file against its schema; what the program says of a broken one; and that a new expression is a new entry.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { build, root } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';

const read = (name) => JSON.parse(fs.readFileSync(path.join(root, 'models', name)));
const validate = new Ajv({ strict: false }).compile(read('expressions.schema.json'));

/** The command with a changed file. */
function faccia(file, ...args) {
  const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  fs.writeFileSync(path.join(models, 'expressions.json'), JSON.stringify(file));
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/app/faccia'), ['expressions', ...args], { env: { ...process.env, FACCIA_MODELS: models } });
  fs.rmSync(models, { recursive: true });
  return { status, stdout: String(stdout), stderr: String(stderr) };
}

test('the file is as the schema says', () => assert.ok(validate(read('expressions.json')), JSON.stringify(validate.errors?.slice(0, 3))));

test('what is broken is named with its place by the program (tests/corpus has all kinds)', () => {
  const file = read('expressions.json');
  file.performative.greet.gesture.keys[1].at = 'soon';
  const { status, stderr } = faccia(file);
  assert.equal(status, 1);
  assert.match(stderr, /performative\.greet\.gesture\.keys\[1\]\.at/);
});

test('a new expression is a new entry', () => {
  const file = read('expressions.json');
  file.affect.boredom = { activation: -0.4, evaluation: -0.1, mix: { sadness: 0.2 }, pose: { close_t_eyelid: 300, raise_l_cornerlip: 90 }, aliases: ['bored'] };
  assert.ok(validate(file), JSON.stringify(validate.errors?.slice(0, 3)));
  const { stdout } = faccia(file, '--json', '--kind', 'affect');
  const { expressions } = JSON.parse(stdout);
  assert.deepEqual(expressions.at(-1), { kind: 'affect', name: 'boredom', activation: -0.4, evaluation: -0.1, basic: false });
  const { frames } = parseFap(faccia(file, '--fap', 'bored=0.5', 'affect:joy').stdout);
  assert.equal(frames.length, 2);
  const sad = file.affect.sadness.pose;
  assert.equal(frames[0][19], Math.round(0.5 * (300 + 0.2 * sad.close_t_eyelid)));
  assert.equal(frames[0][12] - frames[0][13], 45);
  assert.equal(frames[1][3], file.affect.joy.pose.open_jaw);
});

test('the command says what it cannot do', () => {
  const file = read('expressions.json');
  for (const [args, message] of [
    [['--fap', 'hunger'], /no affect 'hunger'/],
    [['--fap', 'joy=2'], /from 0 to 1/],
    [['--fap', 'joy=much'], /from 0 to 1/],
    [['--kind', 'weather'], /kind 'weather'/],
    [['joy'], /unexpected 'joy'/],
  ]) {
    const { status, stderr, stdout } = faccia(file, ...args);
    assert.equal(status, 2);
    assert.match(stderr, message);
    assert.equal(stdout, '');
  }
});
