// SPDX-License-Identifier: GPL-3.0-or-later
// The table of errors in the server, the protocol's text, and the schemas: each has what the others have.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { sources } from '../lib/sources.mjs';

const read = (name) => fs.readFileSync(new URL(`../../${name}`, import.meta.url), 'utf8');
const rows = [...read('server/base/error_codes.h').matchAll(/^ {4}X\((\w+), "([^"]*)", (\d+), "([^"]*)"\)/gm)].map(
  ([, identifier, code, status, message]) => ({ identifier, code, status: Number(status), message }),
);
const table = Object.fromEntries(rows.map(({ code, status }) => [code, status]));

test('the table is valid', () => {
  assert.ok(rows.length > 80, `${rows.length}`);
  assert.equal(Object.keys(table).length, rows.length, 'a code stands there once');
  for (const { identifier, code, status, message } of rows) {
    assert.equal(code, identifier.toLowerCase().replaceAll('_', '-'));
    assert.ok(status === 0 || (status >= 400 && status < 600), `${code}: ${status}`);
    assert.match(message, /^\S.*[^.]$/);
  }
});

test('protocol/README.md has the same codes with the same statuses', () => {
  const told = {};
  const section = read('protocol/README.md').split('\n## Error codes\n')[1].split('\n## ')[0];
  for (const [, codes, status] of section.matchAll(/^\| (`.*?`) \| (\d*) ?\| \S/gm))
    for (const [, code] of codes.matchAll(/`([^`]*)`/g)) {
      assert.ok(!(code in told), `${code} twice`);
      told[code] = Number(status);
    }
  assert.deepEqual(told, table);
});

test('the declaration and the server schema have the same codes, and OpenAPI and AsyncAPI refer to that schema', () => {
  const { code } = JSON.parse(read('protocol/schema/server.json')).$defs;
  for (const codes of [code.enum, JSON.parse(read('protocol/messages.json')).codes]) assert.deepEqual([...codes].sort(), Object.keys(table).sort());
  const means = (file, pointer) => read(`protocol/${file}`).includes(`"schema/server.json#/$defs/${pointer}"`);
  assert.ok(means('openapi.json', 'error') && means('asyncapi.json', 'error') && means('asyncapi.json', 'warning'));
});

test('markup.md and websocket.md name only codes of the table', () => {
  const [, warnings] = read('protocol/markup.md').split('\n## Warnings and errors\n');
  for (const [, codes] of warnings.matchAll(/^\| (`[a-z0-9-]+`(?:, `[a-z0-9-]+`)*) \|/gm))
    for (const [, code] of codes.matchAll(/`([^`]*)`/g)) assert.ok(code in table, code);
  for (const [, code] of read('protocol/websocket.md').matchAll(/\b[45]\d\d `([a-z-]+)`/g)) assert.ok(code in table, code);
});

test('every error of the table is raised somewhere, and the server spells codes only there', () => {
  const files = sources('server').filter(({ name }) => !name.endsWith('error_codes.h'));
  const text = files.map((file) => file.code).join('\n');
  assert.deepEqual(rows.filter(({ identifier }) => !text.includes(`ERROR_${identifier}`)).map(({ code }) => code), []);
  const distinct = rows.map(({ code }) => code).filter((code) => /^(bad|unknown|missing|too|voice|unsupported)-/.test(code));
  const spelled = files.flatMap(({ name, code }) => distinct.filter((word) => code.includes(`"${word}"`)).map((word) => `${name}: ${word}`));
  assert.deepEqual(spelled, []);
});
