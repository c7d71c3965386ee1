// SPDX-License-Identifier: MIT
// Everything can be imported on a server, without a page and without side effects.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

const web = fileURLToPath(new URL('../../../web/', import.meta.url));
const scripts = (folder) =>
  fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const file = path.join(folder, entry.name);
    return entry.isDirectory() ? scripts(file) : entry.name.endsWith('.mjs') ? [file] : [];
  });

test('each module of the element can be imported without a page', async () => {
  // one is for the audio thread; those in packed/ have WebAssembly in them, which only what bundles them can bring
  const files = [...scripts(path.join(web, 'element')), ...scripts(path.join(web, 'portrait'))].filter((file) => !file.endsWith('worklet.mjs') && path.basename(path.dirname(file)) !== 'packed');
  assert.ok(files.length > 30);
  for (const file of files) await assert.doesNotReject(import(pathToFileURL(file)), file);
});

test('so can the bundle, which then defines nothing', async () => {
  const bundle = path.join(process.env.FACCIA_WEB ?? path.join(web, '../build/web'), 'talking-head.js');
  const { TalkingHead } = await import(pathToFileURL(bundle));
  assert.equal(typeof TalkingHead, 'function');
  assert.equal(globalThis.customElements, undefined);
});

test('in a browser defines the element once, however often the script loads', async (t) => {
  const defined = new Map();
  globalThis.customElements = {
    get: (name) => defined.get(name),
    define(name, element) {
      assert.ok(!defined.has(name));
      defined.set(name, element);
    },
  };
  t.after(() => delete globalThis.customElements);
  const script = new URL('../../../web/element/talking-head.mjs', import.meta.url).href;
  const [first, second] = [await import(`${script}?a`), await import(`${script}?b`)];
  assert.equal(defined.get('talking-head'), first.TalkingHead);
  assert.equal(second.TalkingHead, first.TalkingHead);
});
