// SPDX-License-Identifier: GPL-3.0-or-later
// Syntax that browsers must parse: the face of a room runs on tablets that are years old (web/docs/home/index.md), and tells older
// browsers that they are not supported.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { createRequire } from 'node:module';
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

test('style sheets of pages have no rule that browsers would drop', () => {
  const { transformSync } = createRequire(path.join(root, 'web/package.json'))('esbuild');
  const pages = path.join(root, 'web/pages'), files = fs.readdirSync(pages, { recursive: true }).filter((name) => name.endsWith('.css'));
  assert.ok(files.length > 8);
  for (const file of files) {
    const { warnings } = transformSync(fs.readFileSync(path.join(pages, file), 'utf8'), { loader: 'css', logLevel: 'silent' });
    assert.deepEqual(warnings.map(({ text, location }) => `${file}:${location.line}: ${text}`), []);
  }
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
