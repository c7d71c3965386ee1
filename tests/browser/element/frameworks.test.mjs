// SPDX-License-Identifier: GPL-3.0-or-later
// The element in React 19 (strict mode), Vue 3 and Svelte 5 from npm.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { compile, compileModule } from 'svelte/compiler';
import { build } from '../../../web/node_modules/esbuild/lib/main.js';
import { launch } from '../../lib/browser.mjs';
import { Daemon, root } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

const apps = { react: 'react.jsx', vue: 'vue.js', svelte: 'svelte.svelte.js' };

const svelte = {
  name: 'svelte',
  setup(setup) {
    setup.onLoad({ filter: /\.svelte(\.js)?$/ }, ({ path: file }) => {
      const source = fs.readFileSync(file, 'utf8');
      const make = file.endsWith('.js') ? compileModule : compile;
      return { contents: make(source, { filename: file, generate: 'client', dev: false }).js.code, loader: 'js' };
    });
  },
};

async function bundle(file) {
  const { outputFiles } = await build({
    entryPoints: [path.join(root, 'tests/browser/apps', file)],
    bundle: true, write: false, format: 'esm', jsx: 'automatic', plugins: [svelte], conditions: ['browser'],
    nodePaths: [path.join(root, 'tests/node_modules')], logLevel: 'error',
    define: {
      'process.env.NODE_ENV': '"development"', // strict mode runs effects twice only in development
      __VUE_OPTIONS_API__: 'true', __VUE_PROD_DEVTOOLS__: 'false', __VUE_PROD_HYDRATION_MISMATCH_DETAILS__: 'false',
    },
  });
  return outputFiles[0].text;
}

let daemon, browser, server;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ flags: ['--autoplay-policy=no-user-gesture-required'] });
  server = await servePages({ '/': '<!doctype html><meta charset="utf-8"><title>App</title><link rel="icon" href="data:,"><style>talking-head { inline-size: 9rem; block-size: 12rem }</style><div id="app"></div><script type="module" src="app.js"></script>' });
});
after(async () => {
  await browser?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Properties of the elements, in document order. */
const settings = (page) => page.evaluate(() => [...document.querySelectorAll('talking-head')].map((element) => {
  const { rate, captions, still, polite, life, expression, voice, label } = element;
  return { name: element.dataset.name, rate, captions, still, polite, life, expression, voice, label, lang: element.lang };
}));

for (const [framework, file] of Object.entries(apps))
  test(`${framework}: passes properties, events and method calls; mounts, moves, unmounts and remounts`, async () => {
    server.files['/app.js'] = { body: await bundle(file), type: 'text/javascript' };
    const page = await browser.newPage();
    const problems = [];
    page.on('pageerror', (error) => problems.push(String(error)));
    page.on('console', (message) => message.type() === 'error' && problems.push(`${message.text()} ${message.location().url}`));
    await page.addInitScript(() => {
      window.notes = [];
      window.note = (name, what) => window.notes.push(`${name}: ${what}`);
    });
    await page.goto(server.url);
    await page.waitForFunction(() => window.render);
    const props = {
      src: `${daemon.url.replace('http', 'ws')}/v1/stream`, lang: 'it', quality: 'low', rate: 180, captions: 'off', still: true,
      polite: false, life: 0.5, expression: { joy: 0.5 }, voice: 'espeak:it+f2', label: 'Anna',
    };
    const expected = {
      rate: 180, captions: false, still: true, polite: false, life: 0.5, expression: [{ name: 'joy', intensity: 0.5 }],
      voice: 'espeak:it+f2', label: 'Anna', lang: 'it',
    };

    // Rendered before the script is loaded: frameworks set attributes then, and React omits false ones.
    await page.evaluate((given) => window.render({ names: ['a'], ...given }), { ...props, polite: 'off', expression: 'joy 0.5' });
    await page.addScriptTag({ type: 'module', url: `${daemon.url}/talking-head.js` });
    await page.waitForFunction(() => window.notes.includes('a: ready'), null, { timeout: 60000 });
    assert.deepEqual(await settings(page), [{ name: 'a', ...expected }]);

    // Created after the script is loaded: properties are set before insertion.
    await page.evaluate((given) => window.render({ names: ['a', 'b'], ...given, greeting: 'Sì.' }), props);
    await page.waitForFunction(() => window.notes.includes('b: done'), null, { timeout: 60000 });
    assert.deepEqual(await settings(page), [{ name: 'a', ...expected }, { name: 'b', ...expected }]);
    assert.ok((await page.evaluate(() => window.notes)).includes('b: Sì'), 'a word was heard');

    // Changed and removed properties.
    const { voice: _, life: __, ...fewer } = props;
    await page.evaluate((given) => window.render({ names: ['a', 'b'], ...given, greeting: 'Sì.' }), { ...fewer, rate: 200, captions: true, still: false });
    const changed = { ...expected, rate: 200, captions: true, still: false };
    assert.deepEqual((await settings(page)).map(({ rate, captions, still }) => ({ rate, captions, still })), Array(2).fill({ rate: changed.rate, captions: true, still: false }));
    assert.deepEqual((await settings(page)).map(({ voice, life }) => ({ voice, life })), Array(2).fill({ voice: null, life: null }));
    await page.evaluate((given) => window.render({ names: ['a', 'b'], ...given, greeting: 'Sì.' }), { ...fewer, captions: false });
    assert.equal((await settings(page))[0].captions, false);

    // Moved while speaking: the element stays the same and speaks to the end.
    const end = await page.evaluate(async (given) => {
      const element = document.querySelector('[data-name=a]');
      const speech = element.speak('Uno, due, tre.', { lang: 'it' });
      await new Promise((resolve) => element.addEventListener('word', resolve, { once: true }));
      await window.render({ names: ['b', 'a'], ...given, greeting: 'Sì.' });
      return { same: element === document.querySelectorAll('talking-head')[1], ...(await speech) };
    }, props);
    assert.equal(end.same, true);
    assert.equal(end.reason, 'done');

    // Removed while speaking: the speech ends, and all resources are freed.
    const left = await page.evaluate(async () => {
      const elements = [...document.querySelectorAll('talking-head')];
      const speech = elements[0].speak('Uno, due, tre, quattro, cinque, sei.', { lang: 'it' });
      await new Promise((resolve) => elements[0].addEventListener('word', resolve, { once: true }));
      window.unmount();
      const { reason } = await speech;
      while (elements.some((element) => element.debug().connection !== 'closed')) await new Promise((resolve) => setTimeout(resolve, 20));
      return { reason, count: document.querySelectorAll('talking-head').length, frames: elements[0].debug().drawCalls };
    });
    assert.deepEqual(left, { reason: 'stopped', count: 0, frames: 0 });

    // Mounted again, speaking at once.
    await page.evaluate((given) => window.render({ names: ['c'], ...given, greeting: 'Eccomi.' }), props);
    await page.waitForFunction(() => window.ends.includes('done'), null, { timeout: 60000 });
    assert.deepEqual(await settings(page), [{ name: 'c', ...expected }]);
    assert.deepEqual(problems, []);
    await page.close();
  });
