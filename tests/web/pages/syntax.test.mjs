// SPDX-License-Identifier: GPL-3.0-or-later
// Syntax that browsers must parse: the face of a room runs on tablets that are years old (web/docs/home/index.md), and tells older
// browsers that they are not supported.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import vm from 'node:vm';
import { parse } from 'acorn';

const root = new URL('../../../', import.meta.url).pathname;
const web = process.env.FACCIA_WEB ?? path.join(root, 'build/web');
const read = (name) => fs.readFileSync(path.join(web, name), 'utf8');

/** A script and all that it imports. */
function imported(name, found = new Set()) {
  if (found.has(name)) return found;
  found.add(name);
  for (const [, other] of read(name).matchAll(/(?:from|import)\s*\(?\s*["']\.\/([\w-]+\.js)["']/g)) imported(other, found);
  return found;
}

test('the page of a room and all its imports are ECMAScript 2022', () => {
  const files = imported('room.js');
  assert.deepEqual([...files].sort(), ['room.js', 'talking-head.js']);
  for (const name of [...files, 'talking-head-worklet.js', 'opus-decoder.js'])
    assert.doesNotThrow(() => parse(read(name), { ecmaVersion: 2022, sourceType: 'module' }), name);
});

test('notifies an outdated browser, in syntax that it can parse, and no other', () => {
  const source = read('room-early.js');
  parse(source, { ecmaVersion: 5, sourceType: 'script' });
  const run = (language, Array) => {
    const text = { textContent: '' };
    const self = { queueMicrotask, WebSocket: class {} };
    vm.runInNewContext(source, { self, Array, Object, navigator: { language }, Element: { prototype: { replaceChildren() {} } }, document: { querySelector: () => text } });
    return text.textContent;
  };
  assert.equal(run('it-IT', Array), '');
  const old = { prototype: {} };
  assert.match(run('it-IT', old), /^Questo browser è troppo vecchio/);
  assert.match(run('tr', old), /^Bu tarayıcı/);
  assert.match(run('pt-BR', old), /^Este navegador/);
  assert.match(run('de', old), /^This browser/);
});
