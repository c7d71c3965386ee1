// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever a server of the Wyoming protocol answers, the command plugin's program ends.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const file = (path) => fileURLToPath(new URL(path, import.meta.url));

test('reports damaged answers of a server', () => {
  const args = [file('../lib/wyoming-answers.py'), file('../../server/plugins/command/wyoming.py'), '2000'];
  const { status, stdout, stderr } = spawnSync('python3', args, { encoding: 'utf8', timeout: 120000 });
  assert.equal(status, 0, stderr);
  console.log(stdout.trim());
});
