// SPDX-License-Identifier: GPL-3.0-or-later
// openapi.json and asyncapi.json against the rules of their formats, and of Redocly's linter at its strictest.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { createConfig, lint } from '@redocly/openapi-core';

const folder = fileURLToPath(new URL('../../protocol/', import.meta.url));
const config = await createConfig({ extends: ['recommended-strict'] });
const problems = async (file) =>
  (await lint({ ref: file, config })).map(({ ruleId, message, location: [place] }) => `${place.pointer}: ${message} (${ruleId})`);

for (const name of ['openapi.json', 'asyncapi.json'])
  test(`${name} passes the linter`, async () => assert.deepEqual(await problems(path.join(folder, name)), []));

test('the linter finds errors', async () => {
  const copy = JSON.parse(fs.readFileSync(path.join(folder, 'openapi.json'), 'utf8'));
  delete copy.paths['/v1/speech'].post.operationId;
  copy.paths['/v1/say'].post.parameters[0] = { $ref: '#/components/parameters/nowhere' };
  const file = path.join(folder, `.lint-${process.pid}.json`); // beside what it refers to
  fs.writeFileSync(file, JSON.stringify(copy));
  try {
    assert.deepEqual((await problems(file)).map((text) => text.match(/\((.*)\)$/)[1]).sort(), ['no-unresolved-refs', 'operation-operationId']);
  } finally {
    fs.rmSync(file);
  }
});

test('every operation has a unique id', () => {
  const { paths } = JSON.parse(fs.readFileSync(path.join(folder, 'openapi.json'), 'utf8'));
  const ids = Object.values(paths).flatMap(({ get, post }) => [get, post].filter(Boolean).map(({ operationId }) => operationId));
  assert.ok(ids.length >= 18 && ids.every(Boolean));
  assert.equal(new Set(ids).size, ids.length);
});

test('SECURITY.md names an existing test for each attack', () => {
  const root = path.join(folder, '..');
  const section = fs.readFileSync(path.join(root, 'SECURITY.md'), 'utf8').split('\n## Attacks and defences\n')[1].split('\n## ')[0];
  const attacks = section.split('\n- **').slice(1).map((item) => item.replace(/\s+/g, ' '));
  assert.ok(attacks.length > 60);
  for (const attack of attacks) {
    const [, tests] = attack.split(/ Tests?: /);
    const named = [...(tests ?? '').matchAll(/`([^`]+)`/g)].map(([, name]) => (name.startsWith('fuzz_') ? `fuzz/${name}.c` : name));
    assert.ok(named.length, attack);
    for (const name of named) assert.ok(fs.existsSync(path.join(root, 'tests', name)), name);
  }
});
