// SPDX-License-Identifier: MIT
// The npm package: its contents, its types in each framework's templates, its manifest, its size; and importing it without a page.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { publint } from 'publint';
import ts from 'typescript';
import { TalkingHead } from '../../web/element/element.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const modules = path.join(root, 'tests/node_modules');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-package-'));
const installed = path.join(folder, 'node_modules/@faccia/talking-head');
const read = (name) => fs.readFileSync(path.join(installed, name));
const json = (name) => JSON.parse(read(name));

before(() => {
  // as an application has it: the package beside those of the frameworks
  execFileSync('node', [path.join(root, 'web/package/pack.mjs'), installed, process.env.FACCIA_WEB ?? path.join(root, 'build/web')]);
  for (const name of ['@types', '@vue', 'csstype', 'react', 'svelte', 'vue']) fs.symlinkSync(path.join(modules, name), path.join(folder, 'node_modules', name));
});
after(() => fs.rmSync(folder, { recursive: true }));

test('publint and attw find nothing, including node10 resolution; the package is ESM-only', async () => {
  const { messages } = await publint({ pkgDir: installed, strict: true });
  assert.deepEqual(messages, []);
  const { status, stdout, stderr } = spawnSync(path.join(modules, '.bin/attw'), ['--pack', installed, '--ignore-rules', 'cjs-resolves-to-esm'], { encoding: 'utf8' });
  assert.equal(status, 0, stdout + stderr);
});

test('the version is that of the daemon', () => {
  const version = fs.readFileSync(path.join(root, 'meson.build'), 'utf8').match(/version: '([^']+)'/)[1];
  assert.equal(json('package.json').version, version);
  assert.match(fs.readFileSync(path.join(root, 'CHANGELOG.md'), 'utf8'), /^## \[?(Unreleased|\d+\.\d+\.\d+)/m);
});

test('every file that the package names exists, and the scripts are valid', () => {
  const { exports, unpkg, customElements } = json('package.json');
  const named = Object.values(exports).flatMap((entry) => (typeof entry === 'string' ? [entry] : Object.values(entry)));
  for (const file of [...named, unpkg, customElements].filter((name) => !name.includes('*'))) assert.ok(read(file).length, file);
  for (const file of ['talking-head-worklet.js', 'talking-head-avatar.js', 'talking-head-draco.js', 'talking-head-basis.js', 'opus-decoder.js']) assert.ok(read(`dist/${file}`).length, file);
});

test('the published element stays within 225 kB', () => {
  for (const file of ['talking-head.js', 'talking-head.classic.js']) {
    const size = gzipSync(read(`dist/${file}`), { level: 9 }).length;
    assert.ok(size < 225_000, `${file}: ${size} bytes`);
  }
});

test('the import does nothing on a server', () => {
  fs.writeFileSync(path.join(folder, 'server.mjs'), `import { TalkingHead, setCompanions } from '@faccia/talking-head';
    setCompanions('https://example.org/faccia');
    console.log(typeof TalkingHead, typeof globalThis.customElements);`);
  assert.equal(execFileSync('node', ['server.mjs'], { cwd: folder, encoding: 'utf8' }).trim(), 'function undefined');
});

test('the manifest describes every attribute, part, event and custom property', () => {
  const element = json('custom-elements.json').modules[0].declarations[0];
  const names = (list) => list.map(({ name }) => name).sort();
  const template = fs.readFileSync(path.join(root, 'web/element/template.mjs'), 'utf8');
  const parts = [...template.matchAll(/part: '([^']+)'/g)].map(([, name]) => name);
  assert.deepEqual(names(element.cssParts), [...parts, 'backdrop', 'who', 'said', 'word', 'rest', 'captions-empty'].sort());
  assert.deepEqual(names(element.cssProperties), [...new Set(template.match(/--talking-head-[a-z-]+/g))].sort());
  const attributes = names(element.attributes);
  for (const name of TalkingHead.observedAttributes) assert.ok(attributes.includes(name), name);
  const listed = (name) => fs.readFileSync(path.join(installed, 'dist/talking-head.d.ts'), 'utf8').split(`export interface ${name} {\n`)[1].split('\n}')[0];
  const typed = [...listed('TalkingHeadAttributes').matchAll(/^ {2}'?([a-z-]+)'?\?:/gm)].map(([, name]) => name);
  assert.deepEqual(typed.sort(), attributes);
  for (const kind of ['attributes', 'events', 'cssParts', 'cssProperties'])
    for (const { name, description } of element[kind]) assert.ok(description?.length > 8, `${kind} ${name}`);
  assert.ok(element.events.length >= 24 && element.members.some(({ name, kind }) => name === 'speak' && kind === 'method'));
});

const right = {
  'react.tsx': `import '@faccia/talking-head'; import '@faccia/talking-head/react';
    export const face = <talking-head src="ws://localhost/v1/stream" rate={180} captions={false} expression={{ joy: 0.6 }} className="x"
      onword={(event) => event.detail.text.length} onend={({ detail }) => detail.reason === 'done'} />;`,
  'vue.ts': `import '@faccia/talking-head/vue'; import type { GlobalComponents } from 'vue';
    type Props = InstanceType<GlobalComponents['talking-head']>['$props'];
    export const props: Props = { src: 'ws://localhost/v1/stream', rate: 180, captions: 'off', onWord: (event) => event.detail.text.length };`,
  'svelte.ts': `import '@faccia/talking-head/svelte'; import type { SvelteHTMLElements } from 'svelte/elements';
    export const props: SvelteHTMLElements['talking-head'] = { src: 'ws://localhost/v1/stream', rate: 180, onword: (event) => event.detail.text.length };`,
};
const wrong = {
  'wrong-react.tsx': `import '@faccia/talking-head/react';
    export const a = <talking-head quality="best" />;
    export const b = <talking-head onword={(event: { detail: { loudness: number } }) => event.detail.loudness} />;`,
  'wrong-vue.ts': `import '@faccia/talking-head/vue'; import type { GlobalComponents } from 'vue';
    export const props: InstanceType<GlobalComponents['talking-head']>['$props'] = { view: 'back' };`,
  'wrong-svelte.ts': `import '@faccia/talking-head/svelte'; import type { SvelteHTMLElements } from 'svelte/elements';
    export const props: SvelteHTMLElements['talking-head'] = { captions: 'perhaps' };`,
};

// `node10` is what Next writes into the tsconfig of an application that has none.
for (const resolution of ['Bundler', 'Node10']) test(`templates of React, Vue and Svelte are typed (${resolution}): correct ones compile, each wrong one does not`, () => {
  const files = Object.entries({ ...right, ...wrong }).map(([name, text]) => {
    fs.writeFileSync(path.join(folder, name), text);
    return path.join(folder, name);
  });
  const options = {
    strict: true, noEmit: true, skipLibCheck: true, types: [], jsx: ts.JsxEmit.ReactJSX, preserveSymlinks: true, allowJs: false,
    target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.ESNext, moduleResolution: ts.ModuleResolutionKind[resolution],
  };
  const program = ts.createProgram(files, options);
  const found = ts.getPreEmitDiagnostics(program).map(({ file, start, messageText }) =>
    [path.basename(file?.fileName ?? ''), file ? file.getLineAndCharacterOfPosition(start).line + 1 : 0, ts.flattenDiagnosticMessageText(messageText, ' ')]);
  assert.deepEqual(found.filter(([name]) => !name.startsWith('wrong')), []);
  assert.deepEqual([...new Set(found.map(([name, line]) => `${name}:${line}`))].sort(), ['wrong-react.tsx:2', 'wrong-react.tsx:3', 'wrong-svelte.ts:2', 'wrong-vue.ts:2']);
});
