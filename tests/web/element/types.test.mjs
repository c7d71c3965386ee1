// SPDX-License-Identifier: MIT
// The types of the element: that they are right, complete, and refuse what is wrong.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import ts from 'typescript';
import { TalkingHead } from '../../../web/element/element.mjs';

const types = fileURLToPath(new URL('../../../web/element/talking-head.d.ts', import.meta.url));

const right = `import './talking-head.js';
import type { Expression, TalkingHead } from './talking-head.js';
const head = document.querySelector('talking-head')!;
const made: TalkingHead = document.createElement('talking-head');
head.rate = 180;
head.captions = 'off';
head.still = null;
head.turn = false;
const mood: Expression = { joy: 0.6 };
head.expression = mood;
head.express('joy 0.4, surprise 0.2', { ease: 1 });
head.addEventListener('word', ({ detail }) => detail.text.length + detail.time);
head.addEventListener('sound', ({ detail }) => detail.sound === 'none' && detail.reason === 'no-device');
head.addEventListener('click', (event: MouseEvent) => event.x);
head.speak('Ciao', { lang: 'it', mode: 'replace' }).then(({ reason }) => reason === 'done');
made.remove();
`;

const wrong = `import type {} from './talking-head.js';
const head = document.querySelector('talking-head')!;
head.rate = 'fast';
head.speak();
head.speak('Ciao', { mode: 'now' });
head.faps = {};
head.addEventListener('sound', ({ detail }) => detail.loudness);
`;

test('correct use compiles, wrong use does not', (t) => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-types-'));
  t.after(() => fs.rmSync(folder, { recursive: true }));
  fs.copyFileSync(types, path.join(folder, 'talking-head.d.ts'));
  const files = Object.entries({ right, wrong }).map(([name, text]) => {
    fs.writeFileSync(path.join(folder, `${name}.ts`), text);
    return path.join(folder, `${name}.ts`);
  });
  const options = {
    strict: true, noEmit: true, skipLibCheck: false, skipDefaultLibCheck: true, types: [], target: ts.ScriptTarget.ES2022,
    module: ts.ModuleKind.ESNext, moduleResolution: ts.ModuleResolutionKind.Bundler,
  };
  const found = ts.getPreEmitDiagnostics(ts.createProgram(files, options)).map((problem) => {
    const line = problem.file?.getLineAndCharacterOfPosition(problem.start).line;
    return { at: `${path.basename(problem.file?.fileName ?? '')}:${line + 1}`, says: ts.flattenDiagnosticMessageText(problem.messageText, ' ') };
  });
  assert.deepEqual(found.map(({ at }) => at), [3, 4, 5, 6, 7].map((line) => `wrong.ts:${line}`), JSON.stringify(found));
});

test('declare all attributes, properties and methods', () => {
  const text = fs.readFileSync(types, 'utf8');
  const inherited = ['lang', 'constructor', 'connectedCallback', 'disconnectedCallback', 'connectedMoveCallback', 'adoptedCallback', 'attributeChangedCallback', 'debug', 'debugParts'];
  const names = [...TalkingHead.observedAttributes, ...Object.getOwnPropertyNames(TalkingHead.prototype)].filter((name) => !inherited.includes(name));
  assert.ok(names.length > 20);
  const property = (name) => name.replace(/-(.)/g, (_, letter) => letter.toUpperCase());
  for (const name of names) assert.match(text, new RegExp(`\\b${property(name)}(\\(|:)`), name);
});
