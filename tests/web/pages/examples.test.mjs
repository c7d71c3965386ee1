// SPDX-License-Identifier: MIT
// The examples of the element, without a page: they show all of it, and their sources compile.
import assert from 'node:assert/strict';
import path from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { parse as parseVue, compileScript } from 'vue/compiler-sfc';
import { compile as compileSvelte } from 'svelte/compiler';
import ts from 'typescript';
import { controlOf, RANGES } from '../../../web/pages/examples/controls.js';
import { inAWord } from '../../../web/pages/examples/log.js';
import { KINDS, source } from '../../../web/pages/examples/source.js';
import { stories } from '../../../web/pages/examples/stories.js';
import { manifest } from '../../../web/package/manifest.mjs';

const web = fileURLToPath(new URL('../../../web/', import.meta.url));
const [element] = manifest(path.join(web, 'element/talking-head.d.ts'), path.join(web, 'docs/element/reference.md'), 'talking-head.js').modules[0].declarations;
const server = 'http://127.0.0.1:8080';

test('every attribute, property, method, event, part, custom property and slot has an example, and no example shows a missing one', () => {
  const fields = Object.fromEntries(element.attributes.map(({ name, fieldName }) => [fieldName, name]));
  const all = [
    ...element.attributes.map(({ name }) => name),
    ...element.members.filter(({ name }) => !fields[name]).map(({ kind, name }) => (kind === 'method' ? `${name}()` : `.${name}`)),
    ...element.events.map(({ name }) => `@${name}`),
    ...element.cssParts.map(({ name }) => `::${name}`),
    ...element.cssProperties.map(({ name }) => name),
    ...element.slots.map(({ name }) => (name ? `slot ${name}` : 'slot')),
  ];
  const shown = new Set(stories.flatMap(({ shows, controls = [] }) => [...shows, ...controls]));
  assert.deepEqual(all.filter((name) => !shown.has(name)), [], 'without an example');
  assert.deepEqual([...shown].filter((name) => !all.includes(name)), [], 'not of the element');
});

test('the source of an example contains everything that it claims to show', () => {
  for (const story of stories) {
    const text = source(story, story.attributes ?? {}, 'html', server);
    for (const name of story.shows) {
      const written = name.endsWith('()') ? `.${name.slice(0, -1)}` : name.startsWith('@') ? `addEventListener('${name.slice(1)}'`
        : name.startsWith('::') ? `::part(${name.slice(2)})` : name === 'slot' ? `>${story.content}<` : name;
      assert.ok(text.includes(written), `${story.id}: ${name}`);
    }
  }
  assert.equal(new Set(stories.map(({ id }) => id)).size, stories.length);
});

test('fields match the types of their attributes', () => {
  const kind = (text, name = 'x') => controlOf({ name, type: { text } });
  assert.deepEqual(kind("'face' | 'bust' | null"), { kind: 'select', choices: ['face', 'bust'] });
  assert.deepEqual([kind('boolean').kind, kind('boolean | null').kind, kind('string | null').kind], ['checkbox', 'select', 'text']);
  assert.equal(kind(undefined, '--a-word-color').kind, 'color');
  for (const { name, type } of element.attributes) if (/number/.test(type?.text) && name !== 'expression') assert.ok(RANGES[name], `${name} has no bounds`);
});

test('every source compiles in each framework, and uses attributes that the element has', () => {
  for (const story of stories)
    for (const kind of Object.keys(KINDS)) {
      const given = { src: 'ws://127.0.0.1:8080/v1/stream', label: 'a "b" {c} <d>', ...story.attributes, style: '--talking-head-caption-size: 2rem' };
      const text = source(story, given, kind, server);
      const place = `${story.id}, ${kind}:\n${text}`;
      assert.match(text, story.attributes?.src ? /src="v1\/speech\?format=bundle&/ : /src="ws:\/\/127\.0\.0\.1:8080\/v1\/stream"/, place);
      if (kind === 'react') {
        const { diagnostics } = ts.transpileModule(text, { reportDiagnostics: true, fileName: 'a.tsx', compilerOptions: { jsx: ts.JsxEmit.ReactJSX, target: ts.ScriptTarget.ES2022 } });
        assert.deepEqual(diagnostics.map(({ messageText }) => messageText), [], place);
      } else if (kind === 'vue') {
        const { descriptor, errors } = parseVue(text);
        assert.deepEqual(errors, [], place);
        compileScript(descriptor, { id: story.id, inlineTemplate: true, templateOptions: { compilerOptions: { isCustomElement: (tag) => tag === 'talking-head' } } });
      } else if (kind === 'svelte') {
        assert.ok(compileSvelte(text, { generate: 'client' }).js.code.length, place);
      }
    }
});

test('prints an event in one line, without its samples', () => {
  assert.equal(inAWord({ id: 'a', faps: new Float32Array(68), words: Array(40).fill(0), text: 'x'.repeat(100) }),
    `{"id":"a","faps":"68 values","words":"40 items","text":"${'x'.repeat(79)}…"}`);
  assert.equal(inAWord(undefined), '');
});
