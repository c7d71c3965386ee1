// SPDX-License-Identifier: GPL-3.0-or-later
// The bill of materials against the packages and the sources: what is in them is in it, and nothing else.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { checkBill } from '../lib/bill.mjs';

const packages = process.env.FACCIA_PACKAGES;
const root = path.resolve(import.meta.dirname, '../..');
const files = fs.readdirSync(packages);
const debs = files.filter((name) => name.endsWith('.deb') && !name.includes('dbgsym')).map((name) => path.join(packages, name));
const bom = JSON.parse(fs.readFileSync(path.join(packages, files.find((name) => /^faccia_.*\.cdx\.json$/.test(name))), 'utf8'));
const field = (deb, name) => execFileSync('dpkg-deb', ['-f', deb, name], { encoding: 'utf8' }).trim();
const named = (name, kind = '') => bom.components.find((one) => one.name === name && one.purl.startsWith(`pkg:${kind}`));
const needs = (name) => bom.dependencies.find(({ ref }) => ref === named(name).purl).dependsOn;

test('is valid CycloneDX whose references are unique and resolve', () => checkBill(bom));

test('lists each package as built, with all its dependencies', () => {
  assert.ok(debs.length > 5);
  for (const deb of debs) {
    const one = named(field(deb, 'Package'), 'deb/faccia');
    assert.equal(one.version, field(deb, 'Version'));
    assert.deepEqual(one.hashes, [{ alg: 'SHA-256', content: createHash('sha256').update(fs.readFileSync(deb)).digest('hex') }]);
    for (const need of field(deb, 'Depends').split(',').map((part) => part.match(/[a-z0-9][a-z0-9.+-]+/)?.[0]).filter(Boolean))
      assert.ok(needs(one.name).some((ref) => ref.match(/^pkg:deb\/\w+\/([^@?]+)/)[1] === need), `${one.name} needs ${need}`);
  }
});

test('lists each package that the scripts import, in the locked version, with its licence', () => {
  const { packages: locked } = JSON.parse(fs.readFileSync(path.join(root, 'web/package-lock.json'), 'utf8'));
  const scripts = bom.components.filter((one) => one.purl.startsWith('pkg:npm/'));
  for (const one of scripts) {
    assert.equal(locked[`node_modules/${one.name}`].version, one.version, one.name);
    assert.ok(one.licenses?.length, one.name);
    assert.ok(needs('faccia-data').includes(one.purl) || needs('faccia').includes(one.purl), one.name);
    const integrity = Buffer.from(one.hashes[0].content, 'hex').toString('base64');
    assert.equal(locked[`node_modules/${one.name}`].integrity, `sha512-${integrity}`, one.name);
  }
  const sources = ['web/element', 'web/portrait'].flatMap((folder) =>
    fs.readdirSync(path.join(root, folder), { recursive: true }).filter((name) => name.endsWith('.mjs')).map((name) => path.join(root, folder, name)));
  const text = sources.map((file) => fs.readFileSync(file, 'utf8')).join('\n');
  const imported = new Set([...text.matchAll(/(?:from|import\()\s*'((?:@[\w-]+\/)?[a-z][\w.-]*)/g)].map(([, name]) => name).filter((name) => `node_modules/${name}` in locked));
  assert.ok(imported.has('three'));
  for (const name of imported) assert.ok(scripts.some((one) => one.name === name), name);
  for (const name of ['esbuild', 'eslint']) assert.ok(!scripts.some((one) => one.name === name), `${name} is a tool`);
});
