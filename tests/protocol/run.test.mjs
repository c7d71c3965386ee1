// SPDX-License-Identifier: GPL-3.0-or-later
// Arguments of tests/run.sh and tests/one.sh: groups, files, parts of names; refused arguments; and how to run one file by hand.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';

const root = path.resolve(import.meta.dirname, '../..');
const sh = (args, env = {}) => spawnSync('sh', args, { cwd: root, encoding: 'utf8', env: { ...process.env, ...env } });
const listed = (...what) => {
  const { status, stdout, stderr } = sh(['tests/run.sh', '--list', ...what]);
  assert.equal(status, 0, stderr);
  return stdout.trim().split('\n').map((file) => path.relative(root, file));
};

test('part of a name, a file or a group selects tests', () => {
  assert.ok(listed('api').includes('tests/daemon/api/api.test.mjs'));
  assert.ok(listed('markup').includes('tests/unit/markup/test_markup.c') && listed('markup').includes('tests/daemon/markup/markup.test.mjs'));
  assert.deepEqual(listed('tests/daemon/api/api.test.mjs'), ['tests/daemon/api/api.test.mjs']);
  assert.deepEqual(listed('tests/unit/markup/test_markup.c'), ['tests/unit/markup/test_markup.c']);
  assert.deepEqual(listed('protocol'), fs.readdirSync(path.join(root, 'tests/protocol')).filter((name) => name.endsWith('.test.mjs')).sort().map((name) => `tests/protocol/${name}`));
});

test('rejects an unknown name before installing or building anything', () => {
  const { status, stderr, stdout } = sh(['tests/run.sh', 'no-such-test']);
  assert.equal(status, 1);
  assert.match(stderr, /no test file has 'no-such-test' in its name; groups: unit /);
  assert.equal(stdout, '');
  assert.equal(sh(['tests/run.sh', '--nothing']).status, 1);
});

test('one.sh runs a file alone, with nothing set', () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-one-'));
  const { PATH, HOME } = process.env;
  const { status, stdout, stderr } = spawnSync('sh', ['tests/one.sh', 'tests/protocol/fap.test.mjs'], { cwd: root, encoding: 'utf8', env: { PATH, HOME, FACCIA_ARTEFACTS: folder } });
  assert.equal(status, 0, stderr);
  assert.match(stdout, /^protocol-fap: \d+ passed, 0 failed/m);
  assert.equal(stderr, '');
  assert.match(sh(['tests/one.sh']).stderr, /^usage: /);
  fs.rmSync(folder, { recursive: true });
});
