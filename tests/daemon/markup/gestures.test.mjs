// SPDX-License-Identifier: GPL-3.0-or-later
// Named gestures of the models and of an operator's folder: in every markup, at their times, and errors in their files.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const own = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-gestures-'));
after(() => fs.rmSync(own, { recursive: true }));

const run = (input, ...args) => faccia(args, { input });
const face = (text, ...before) => {
  const { status, stdout, stderr } = run(text, ...before, 'say', '--lang', 'it', '--seed', '1', '--life', '0', '--fap', '-', '-');
  assert.equal(status, 0, stderr);
  return { ...parseFap(stdout), stderr };
};
const gesture = (more) => ({ format: 'faccia-gesture', version: 1, name: 'gape', fps: 25, ...more });
const put = (name, value) => fs.writeFileSync(path.join(own, name), typeof value === 'string' ? value : JSON.stringify(value));
const most = ({ frames }, fap) => Math.max(...frames.map((frame) => frame[fap]));

test('every markup can request a gesture, over words or at a point, and it is shown', () => {
  for (const text of [
    '<speak xml:lang="it" xmlns:faccia="https://faccia.invalid/gesture">La mamma <faccia:gesture name="wink"/>parla piano.</speak>',
    '<jsml>La <gesture name="wink">mamma</gesture> parla piano.</jsml>',
    '<apml><performative type="inform"><rheme>La mamma <gesture name="wink"/>parla piano.</rheme></performative></apml>',
    '<bml><speech id="s"><text>La <sync id="m"/>mamma parla piano.</text></speech><gesture lexeme="WINK" start="s:m"/></bml>',
  ]) {
    const made = face(text);
    assert.equal(made.stderr, '', text);
    assert.ok(most(made, 19) > 800 && most(made, 20) < 300, `${text}: ${most(made, 19)}, ${most(made, 20)}`);
  }
  assert.ok(most(face('<speak>La mamma <gesture name="wink" intensity="0.5"/>parla piano.</speak>'), 19) < 700);
});

test('known signals act as gestures; unknown ones are reported with line and column', () => {
  const text = '<speak>Ciao,\n  <gesture name="nod"/> mamma <gesture name="winc"/>\n bella <gesture/></speak>';
  const { stdout } = run(text, 'check', '-');
  assert.deepEqual(stdout.trim().split('\n'), ["-:2:31: warning: unknown gesture 'winc': not shown; near: wink", '-:3:8: warning: a gesture needs a name']);
});

test('a custom gesture overrides the built-in one of the same name, and lips still close where they must', () => {
  put('wink.json', gesture({ name: 'wink', curves: { close_t_r_eyelid: [0, 300, 1000, 1000, 1000, 300, 0, 0] }, blend: { in: 0.08, out: 0.08 } }));
  put('gape.json', gesture({ curves: { open_jaw: Array(60).fill(1000), lower_t_midlip: Array(60).fill(-500), raise_b_midlip: Array(60).fill(-500) }, mouth: { lips: 1, corners: 1 } }));
  const right = face('<speak>La mamma <gesture name="wink"/>parla piano.</speak>', '--gestures', own);
  assert.ok(most(right, 20) > 800 && most(right, 19) < 300);
  const plain = face('<speak>Mamma e papà bevono.</speak>', '--gestures', own), gaping = face('<speak><gesture name="gape"/>Mamma e papà bevono.</speak>', '--gestures', own);
  const gap = (frame) => -(frame[4] + frame[5]);
  assert.equal(gaping.frames.length, plain.frames.length);
  assert.ok(gaping.frames.some((frame, k) => gap(frame) > gap(plain.frames[k]) + 50), 'she gapes where she may');
  // every closure without the gesture is also closed with it
  const closures = plain.frames.reduce((runs, frame, k) => (gap(frame) > -4 ? runs : gap(plain.frames[k - 1]) > -4 ? [...runs, [k]] : [...runs.slice(0, -1), [...runs.at(-1), k]]), []);
  assert.ok(closures.length >= 4, `${closures.length}`);
  for (const run of closures) assert.ok(run.some((k) => gap(gaping.frames[k]) <= 0), `${run}: ${run.map((k) => gap(gaping.frames[k]))}`);
});

test('reports a bad file with its position, and does not start', () => {
  for (const [value, message] of [
    ['{"format": "faccia-gesture",\n "version": }', /bad\.json: .*2/],
    [gesture({ curves: { open_jaw: [0, 'wide', 0] } }), /bad\.json: curves\.open_jaw\[1\]/],
    [gesture({ name: 'a/b', curves: { open_jaw: [0, 1, 0] } }), /bad\.json: name/],
    [gesture({ curves: { open_jaw: Array(700).fill(0) } }), /bad\.json: curves\.open_jaw/],
  ]) {
    put('bad.json', value);
    const { status, stderr } = run('Ciao.', '--gestures', own, 'check', '-');
    assert.equal(status, 1, stderr);
    assert.match(stderr, message);
  }
  fs.rmSync(path.join(own, 'bad.json'));
  const { status, stderr } = run('Ciao.', '--gestures', path.join(own, 'nowhere'), 'check', '-');
  assert.notEqual(status, 0);
  assert.match(stderr, /nowhere/);
});
