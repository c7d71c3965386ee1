// SPDX-License-Identifier: GPL-3.0-or-later
// Benchmarks go on running: each is known to tests/bench/run.mjs, and runs for a moment. Their figures decide nothing here.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { root } from '../lib/daemon.mjs';
import { long } from '../lib/long.mjs';
import { benchmarks, run } from '../bench/run.mjs';

const folder = path.join(root, 'tests/bench');

test('each program in tests/bench is a benchmark that run.mjs knows, or a part of one', () => {
  const files = fs.readdirSync(folder).filter((file) => file.endsWith('.mjs') && file !== 'run.mjs');
  const sources = new Map(files.map((file) => [file, fs.readFileSync(path.join(folder, file), 'utf8')]));
  const isPart = (file) => [...sources].some(([other, source]) => other !== file && (source.includes(`./${file}'`) || source.includes(`bench/${file}'`)));
  const programs = files.filter((file) => !isPart(file)).map((file) => file.slice(0, -4));
  assert.deepEqual(programs.sort(), Object.keys(benchmarks).sort());
});

for (const [name, { moment, long: why }] of Object.entries(benchmarks)) {
  if (!moment || (why && !long)) continue;
  test(`${name} runs for a moment and prints its result`, () => {
    const { status, output, errors } = run(name, moment, { stdio: ['ignore', 'pipe', 'pipe'], timeout: 300000 });
    assert.equal(status, 0, errors.slice(-2000));
    assert.match(output, /\d/);
  });
}
