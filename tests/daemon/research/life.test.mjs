// SPDX-License-Identifier: GPL-3.0-or-later
// faccia life: statistics of the idle face, and its .fap file.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { build } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const env = { ...process.env, FACCIA_MODELS: path.join(build, 'models'), FACCIA_PLUGINS: path.join(build, 'server/plugins'), FACCIA_WORKER: path.join(build, 'server/voice/faccia-voice') };
const life = (...args) => spawnSync(path.join(build, 'server/cli/faccia'), ['life', ...args], { env, encoding: 'utf8' });
const figure = (run, name) => Number(run.stdout.match(new RegExp(`^${name} +([\\d.]+)`, 'm'))[1]);

test('measures and writes idling, the same for the same seed', () => {
  const dir = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
  const file = path.join(dir, 'idle.fap');
  const run = life('--seconds', '120', '--seed', '4', '--fap', file);
  assert.equal(run.status, 0, run.stderr);
  assert.ok(figure(run, 'blinks/minute') > 8 && figure(run, 'blinks/minute') < 25, run.stdout);
  assert.equal(figure(run, 'seconds'), 120);
  const { fps, frames } = parseFap(fs.readFileSync(file, 'utf8'));
  assert.equal(fps, 100);
  assert.equal(frames.length, 12000);
  assert.ok(frames.some((f) => f[19] > 800), 'eyes close');
  assert.ok(frames.every((f) => f[3] === 0 && f[5] === 0), 'nobody speaks');
  assert.equal(life('--seconds', '120', '--seed', '4').stdout, run.stdout);
  assert.notEqual(life('--seconds', '120', '--seed', '5').stdout, run.stdout);
  fs.rmSync(dir, { recursive: true });
});

test('a question tilts the head, and nothing else does', () => {
  const rolls = (text) => parseFap(life('-l', 'it', '--fap', '-', text).stdout).frames.map((f) => f[50] / 1745);
  const told = rolls('Vieni anche tu domani.');
  const apart = (other) => Math.max(...told.map((roll, i) => Math.abs(roll - (other[i] ?? roll))));
  assert.ok(apart(rolls('Vieni anche tu domani?')) > 1.5);
  assert.ok(apart(rolls('Vieni anche tu domani.')) < 0.2);
});

test('nothing moves at strength 0', () => {
  const run = life('--seconds', '10', '--strength', '0', '--fap', '-');
  assert.ok(parseFap(run.stdout).frames.every((f) => Object.values(f).every((v) => !v)));
  assert.match(run.stderr, /blinks\/minute +0\.0/);
});

test('reports wrong usage', () => {
  for (const args of [['--seconds', '0'], ['--strength', '3'], ['--fps', 'x'], ['--seed', '-1'], ['--lang', 'xx', 'ciao'], ['--what'], ['-f', '/dev/null', 'ciao']]) {
    const run = life(...args);
    assert.equal(run.status, 2, args.join(' '));
    assert.ok(run.stderr.length > 10);
  }
  assert.equal(life('--fap', '/no/such/file').status, 1);
  assert.match(life('--help').stdout, /^Usage: faccia life/);
});
