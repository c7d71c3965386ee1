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
const faccia = (file, ...args) => command(file, ['expressions', ...args]);

function command(file, args, input) {
  const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  fs.writeFileSync(path.join(models, 'expressions.json'), JSON.stringify(file));
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), args, { input, env: { ...process.env, FACCIA_MODELS: models } });
  fs.rmSync(models, { recursive: true });
  return { status, stdout: String(stdout), stderr: String(stderr) };
}

test('the file matches its schema', () => assert.ok(validate(read('expressions.json')), JSON.stringify(validate.errors?.slice(0, 3))));

test('the program reports errors with their position (tests/corpus has all kinds)', () => {
  const file = read('expressions.json');
  file.performative.greet.gesture.keys[1].at = 'soon';
  const { status, stderr } = faccia(file);
  assert.equal(status, 1);
  assert.match(stderr, /performative\.greet\.gesture\.keys\[1\]\.at/);
});

test('adds an expression by one entry', () => {
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

/** Each markup that names affects freely, with a sentence for each of the names. */
const MARKUPS = {
  apml: (names) => `<apml><performative type="inform">${names.map((name) => `<rheme affect="${name}">Uno.</rheme>`).join('\n')}</performative></apml>`,
  ssml: (names) => `<speak xmlns:mstts="http://www.w3.org/2001/mstts">${names.map((name) => `<mstts:express-as style="${name}">Uno.</mstts:express-as>`).join('\n')}</speak>`,
  emotionml: (names) =>
    `<emotionml version="1.0" xmlns="http://www.w3.org/2009/10/emotionml">${names.map((name) => `<emotion><category name="${name}"/>Uno.</emotion>`).join('\n')}</emotionml>`,
  bml: (names) => `<bml><speech id="s"><text>${'Uno. '.repeat(8)}</text></speech>${names.map((name) => `<face lexeme="${name}" start="s:start" end="s:end"/>`).join('\n')}</bml>`,
};

/** The affects that the text's cues name, by the program with that expressions file. */
function cues(file, markup, names) {
  const { status, stdout, stderr } = command(file, ['check', '--score', '--markup', markup, '-'], MARKUPS[markup](names));
  assert.equal(status, 0, stderr + stdout);
  return { warnings: stdout.split('\n').filter((line) => line.includes('warning')), affects: [...stdout.matchAll(/^cue affect (\S+) /gm)].map(([, name]) => name) };
}

for (const markup of Object.keys(MARKUPS))
  test(`shows every affect, by each of its names, on request by ${markup}`, () => {
    const file = read('expressions.json');
    for (const [name, { aliases = [] }] of Object.entries(file.affect)) {
      // "complex:..." is APML's own way to write two; BML writes its names with dashes
      const names = [name, ...aliases.filter((alias) => alias !== '*' && !alias.includes(':') && !(markup === 'bml' && alias.includes('_')))];
      const { warnings, affects } = cues(file, markup, names);
      assert.deepEqual(warnings, []);
      assert.equal(affects.length, names.length, `${name}: ${affects.join(' ')}`);
      for (const affect of affects) assert.ok(affect === name || (markup === 'apml' && aliases.includes(affect)), `${affect} is not ${name}`);
    }
  });

test('every markup accepts an affect added to the file, which may take another affect\'s alias', () => {
  const file = read('expressions.json');
  file.affect.joy.aliases = file.affect.joy.aliases.filter((alias) => alias !== 'amused');
  file.affect.amused = { activation: 0.1, evaluation: 0.4, pose: { raise_l_cornerlip: 300 } };
  assert.ok(validate(file));
  for (const markup of Object.keys(MARKUPS)) assert.deepEqual(cues(file, markup, ['amused']), { warnings: [], affects: ['amused'] }, markup);
  // with two entries of that name, a request for it would be ambiguous
  file.affect.joy.aliases.push('amused');
  const { status, stderr } = command(file, ['expressions']);
  assert.equal(status, 1);
  assert.match(stderr, /affect\.\w+: the name 'amused' occurs twice/);
});

test('the command reports invalid options', () => {
  const file = read('expressions.json');
  for (const [args, message] of [
    [['--fap', 'hunger'], /unknown affect 'hunger'/],
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
