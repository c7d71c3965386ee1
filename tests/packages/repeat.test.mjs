// SPDX-License-Identifier: GPL-3.0-or-later
// The same sources give the same bytes: the scripts and the packages, made in another folder, at another time, with another umask,
// zone and language.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';

const web = path.resolve(import.meta.dirname, '../../web');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-repeat-'));
after(() => fs.rmSync(folder, { recursive: true }));
const WAYS = [['a', '022', 'UTC', 'C'], ['a/longer way', '077', 'Asia/Kathmandu', 'de_DE.UTF-8']];
const hash = (file) => createHash('sha256').update(fs.readFileSync(file)).digest('hex');

/** Runs in a shell with that umask. */
const run = ([name, umask, TZ, LC_ALL], script, ...args) => {
  const cwd = path.join(folder, name);
  fs.mkdirSync(cwd, { recursive: true });
  execFileSync('sh', ['-c', `umask ${umask}; ${script}`, 'sh', ...args], { cwd, env: { ...process.env, TZ, LC_ALL }, stdio: ['ignore', 'ignore', 'inherit'] });
  return cwd;
};
const all = (at) => Object.fromEntries(fs.readdirSync(at, { recursive: true }).filter((name) => fs.statSync(path.join(at, name)).isFile()).sort().map((name) => [name, hash(path.join(at, name))]));

test('the scripts and pages build reproducibly', () => {
  const [one, other] = WAYS.map((way) => all(path.join(run(way, 'node "$1/build.mjs" web', web), 'web')));
  assert.ok(Object.keys(one).length > 50);
  assert.deepEqual(other, one);
});

test('the documentation builds reproducibly', () => {
  const made = process.env.FACCIA_WEB, files = [path.join(web, 'docs/build.mjs'), path.join(made, 'help.json'), path.join(made, 'custom-elements.json')];
  const [one, other] = WAYS.map((way) => all(path.join(run(way, 'node "$1" docs "$2" "$3"', ...files), 'docs')));
  assert.ok(Object.keys(one).length > 100);
  assert.deepEqual(other, one);
});

test('the npm packages build reproducibly', () => {
  for (const script of ['package/pack.mjs', 'client/pack.mjs']) {
    const [one, other] = WAYS.map((way) => {
      const at = run(way, 'rm -rf package *.tgz; node "$1" package "$PWD/web" && npm pack --silent ./package', path.join(web, script));
      const [file] = fs.readdirSync(at).filter((name) => name.endsWith('.tgz'));
      return { file, hash: hash(path.join(at, file)) };
    });
    assert.deepEqual(other, one);
  }
});

test('the Debian packages and their bill of materials build reproducibly', () => {
  const [, other] = WAYS, at = run(other, 'sh "$1" packages', path.resolve(web, '../server/packaging/package.sh'));
  const kept = (folder) => Object.entries(all(folder)).filter(([name]) => /\.deb$|^faccia_.*\.cdx\.json$/.test(name)); // not the container's, which another test makes
  const packages = kept(process.env.FACCIA_PACKAGES);
  assert.ok(packages.length > 5);
  assert.deepEqual(kept(path.join(at, 'packages')), packages);
});
