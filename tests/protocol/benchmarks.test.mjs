// SPDX-License-Identifier: GPL-3.0-or-later
// Benchmarks go on running: each is known to tests/bench/run.mjs, imports what is there, has what it needs installed, and runs for a moment. Their figures decide
// nothing here.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { build as bundle } from '../../web/node_modules/esbuild/lib/main.js';
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

test('each has a short run, or a reason for having none', () => {
  for (const [name, { moment, without }] of Object.entries(benchmarks)) assert.equal(Boolean(moment), !without, name);
});

test('the imports of each exist', async () => {
  const entryPoints = Object.keys(benchmarks).map((name) => path.join(folder, `${name}.mjs`));
  const others = { name: 'others', setup: (build) => build.onResolve({ filter: /node_modules/ }, () => ({ external: true })) };
  const { errors, warnings } = await bundle({ entryPoints, bundle: true, write: false, outdir: folder, platform: 'node', format: 'esm', target: 'esnext', packages: 'external', plugins: [others], logLevel: 'silent' })
    .catch((failed) => failed);
  assert.deepEqual([...errors, ...warnings].map(({ text, location }) => `${location?.file}:${location?.line}: ${text}`), []);
});

// Returns a benchmark's source and the Debian package that provides it.
const USED = {
  'festival': /festival:/, 'festvox-italp16k': /festival:lp|'lp'/, 'festvox-itapc16k': /festival:pc|'pc'/, 'festvox-us-slt-hts': /festival:slt|'slt'/, 'festvox-kallpc16k': /festival:kal|'kal'/,
  'asterisk-core-sounds-it-wav': /prompts\(/, 'pocketsphinx-testdata': /\/pocketsphinx\//, 'chromium': /launch\(/, 'redis-server': /lib\/redis\.mjs/, 'ffmpeg': /'ffmpeg'/, 'sox': /'sox'/, 'sqlite3': /'sqlite3'/,
  'espeak-ng': /espeak-ng -v|'espeak-ng'/, 'time': /\/usr\/bin\/time/,
};

test('run.mjs installs the tools of each before it runs', () => {
  for (const [name, { packages = [] }] of Object.entries(benchmarks)) {
    const source = fs.readFileSync(path.join(folder, `${name}.mjs`), 'utf8');
    const parts = [...source.matchAll(/from '\.\/([a-z-]+\.mjs)'/g)].map(([, part]) => fs.readFileSync(path.join(folder, part), 'utf8'));
    for (const [wanted, used] of Object.entries(USED))
      if ([source, ...parts].some((text) => used.test(text))) assert.ok(packages.includes(wanted), `${name} uses what ${wanted} has`);
  }
});

for (const [name, { moment, long: why }] of Object.entries(benchmarks)) {
  if (!moment || (why && !long)) continue;
  test(`${name} runs briefly and prints its result`, () => {
    const { status, output, errors } = run(name, moment, { stdio: ['ignore', 'pipe', 'pipe'], timeout: why ? 900000 : 300000 });
    assert.equal(status, 0, errors.slice(-2000));
    assert.match(output, /\d/);
  });
}
