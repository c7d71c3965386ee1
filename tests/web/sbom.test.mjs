// SPDX-License-Identifier: GPL-3.0-or-later
// The bills of materials of the npm packages: each file that is shipped, and each package whose code is in one.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { checkBill } from '../lib/bill.mjs';

const root = path.resolve(import.meta.dirname, '../..');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bills-'));
after(() => fs.rmSync(folder, { recursive: true }));
const locked = JSON.parse(fs.readFileSync(path.join(root, 'web/package-lock.json'), 'utf8')).packages;

/** The packed package and its bill of materials. */
function made(name, script, ...more) {
  const packed = path.join(folder, name);
  execFileSync('node', [path.join(root, script), packed, ...more]);
  execFileSync('node', [path.join(root, 'server/packaging/sbom-npm.mjs'), packed, path.join(folder, `${name}.cdx.json`)]);
  const bom = JSON.parse(fs.readFileSync(path.join(folder, `${name}.cdx.json`), 'utf8'));
  checkBill(bom);
  const { files } = JSON.parse(execFileSync('npm', ['pack', '--dry-run', '--json'], { cwd: packed, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }))[0];
  const { components, version } = bom.metadata.component;
  assert.equal(version, JSON.parse(fs.readFileSync(path.join(packed, 'package.json'), 'utf8')).version);
  assert.deepEqual(components.map((one) => one.name).sort(), files.map((one) => one.path).sort());
  for (const { name: file, hashes } of components) assert.equal(hashes[0].content, createHash('sha256').update(fs.readFileSync(path.join(packed, file))).digest('hex'));
  return bom;
}

test('@faccia/talking-head: three.js and the decoders, in locked versions, with their licences; no tools, and nothing of the pages', () => {
  const bom = made('talking-head', 'web/package/pack.mjs', process.env.FACCIA_WEB ?? path.join(root, 'build/web'));
  const names = bom.components.map((one) => one.name);
  for (const name of ['three', 'opus-decoder']) assert.ok(names.includes(name), name);
  for (const name of ['esbuild', 'uplot', '@vladmandic/human', 'fft.js']) assert.ok(!names.includes(name), name);
  for (const one of bom.components) {
    assert.equal(locked[`node_modules/${one.name}`].version, one.version, one.name);
    assert.equal(locked[`node_modules/${one.name}`].integrity, `sha512-${Buffer.from(one.hashes[0].content, 'hex').toString('base64')}`, one.name);
    assert.ok(one.licenses.length, one.name);
  }
  const within = bom.components.flatMap((one) => one.components ?? []).map((one) => one.name);
  for (const name of ['draco', 'basis_universal', 'libopus']) assert.ok(within.includes(name), name);
  const licence = fs.readFileSync(path.join(folder, 'talking-head/LICENSE'), 'utf8');
  for (const name of names) assert.ok(licence.includes(name), `LICENSE names ${name}`);
  assert.ok(bom.metadata.component.components.some((one) => one.name === 'LICENSE.Apache-2.0.txt'), 'with the text of the licence that some have');
});

test('@faccia/client: contains only faccia', () => {
  assert.deepEqual(made('client', 'web/client/pack.mjs').components, []);
});
