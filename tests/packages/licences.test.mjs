// SPDX-License-Identifier: GPL-3.0-or-later
// Every file says under which licence it is, as REUSE has it.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { test } from 'node:test';

test('reuse lint finds nothing', () => {
  const { status, stdout } = spawnSync('reuse', ['--root', path.resolve(import.meta.dirname, '../..'), 'lint'], { encoding: 'utf8' });
  assert.equal(status, 0, stdout);
});
