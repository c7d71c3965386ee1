// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that the C files are formatted by clang-format (skipped for other versions, which format differently) and that ESLint finds
// nothing in JavaScript: an undefined name in a benchmark would otherwise only fail when it is run.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import path from 'node:path';
import { test } from 'node:test';

const VERSION = 14; // Debian 12's
const root = path.resolve(import.meta.dirname, '../..');
const found = spawnSync('clang-format', ['--version'], { encoding: 'utf8' }).stdout?.match(/version (\d+)/)?.[1];
const skip = !found
  ? 'clang-format is not installed: apt-get install clang-format'
  : Number(found) !== VERSION && `clang-format ${found} is installed, and .clang-format is for version ${VERSION}: its layout would differ`;

/** The files that clang-format would change. */
const unformatted = (files) =>
  files.filter((file) => spawnSync('clang-format', ['--dry-run', '--Werror', file], { cwd: root }).status !== 0);

test('every C file is formatted: git ls-files "*.c" "*.h" | xargs clang-format -i', { skip }, () => {
  const files = execFileSync('git', ['ls-files', '*.c', '*.h'], { cwd: root, encoding: 'utf8' }).trim().split('\n');
  assert.ok(files.length > 100, `${files.length} files`);
  const { status } = spawnSync('clang-format', ['--dry-run', '--Werror', ...files], { cwd: root });
  assert.deepEqual(status === 0 ? [] : unformatted(files), []);
});

for (const [what, cwd, args] of [
  ['of the client and the pages', 'web', ['.']],
  ['of tests, benchmarks and tools', '.', ['--config', 'tests/eslint.config.js', 'tests', 'models/tools', 'protocol', 'server']],
])
  test(`ESLint finds nothing in the JavaScript ${what}`, () => {
    const { status, stdout, stderr } = spawnSync(process.execPath, [path.join(root, 'web/node_modules/eslint/bin/eslint.js'), ...args], { cwd: path.join(root, cwd), encoding: 'utf8' });
    assert.equal(status, 0, stdout + stderr);
  });
