// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles an application with the npm package using Vite and webpack with default settings: worklet, decoders and avatar renderer are
// copied, found and used. esbuild copies nothing, so there the application names the folder.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { promisify } from 'node:util';
import { build as vite } from 'vite';
import webpack from 'webpack';
import { build as esbuild } from '../../../web/node_modules/esbuild/lib/main.js';
import { launch } from '../../lib/browser.mjs';
import { models } from '../../lib/built-heads.mjs';
import { build, Daemon, root } from '../../lib/daemon.mjs';
import { packed } from '../../lib/packed-avatars.mjs';
import { servePages } from '../../lib/page-server.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bundlers-'));
const dist = path.join(folder, 'node_modules/@faccia/talking-head/dist');
const html = (script) => `<!doctype html><html lang="en"><meta charset="utf-8"><title>App</title><link rel="icon" href="data:,"><div id="app"></div><script type="module" src="${script}"></script></html>`;
const TYPES = { '.js': 'text/javascript', '.html': 'text/html; charset=utf-8', '.glb': 'model/gltf-binary' };

/** Each bundles the application's main.js into the folder `out`, with an index.html. */
const bundlers = {
  async vite(out) {
    await vite({ root: folder, configFile: false, logLevel: 'error', build: { outDir: out } });
  },
  async webpack(out) {
    const stats = await promisify(webpack)({ mode: 'production', context: folder, entry: './main.js', output: { path: out, filename: 'main.js', assetModuleFilename: '[name]-[hash][ext]' } });
    assert.deepEqual([...stats.toJson().errors, ...stats.toJson().warnings].filter(({ message }) => !/size/.test(message)), []);
    fs.writeFileSync(path.join(out, 'index.html'), html('main.js'));
  },
  async esbuild(out) {
    await esbuild({
      stdin: { contents: "import './main.js'; import { setCompanions } from '@faccia/talking-head'; setCompanions('/faccia/');", resolveDir: folder },
      bundle: true, minify: true, format: 'esm', outfile: path.join(out, 'main.js'), logLevel: 'error',
    });
    fs.cpSync(dist, path.join(out, 'faccia'), { recursive: true });
    fs.writeFileSync(path.join(out, 'index.html'), html('main.js'));
  },
};
const COMPANIONS = ['talking-head-worklet.js', 'opus-decoder.js', 'talking-head-avatar.js', 'talking-head-draco.js', 'talking-head-basis.js'];

let daemon, browser, avatar;
before(async () => {
  execFileSync('node', [path.join(root, 'web/package/pack.mjs'), path.dirname(dist), process.env.FACCIA_WEB ?? path.join(build, 'web')]);
  fs.writeFileSync(path.join(folder, 'package.json'), '{"private":true,"type":"module"}');
  fs.writeFileSync(path.join(folder, 'main.js'), "import '@faccia/talking-head';\nwindow.bundled = true;\n");
  fs.writeFileSync(path.join(folder, 'index.html'), html('/main.js'));
  avatar = await packed(fs.readFileSync(path.join(models, 'heads/mara.glb')));
  daemon = await Daemon.start();
  browser = await launch({ flags: ['--autoplay-policy=no-user-gesture-required'] });
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

for (const [name, bundle] of Object.entries(bundlers))
  test(`${name}: bundles every file that the element fetches, and no unused one`, async () => {
    const out = path.join(folder, `out-${name}`);
    fs.mkdirSync(out);
    await bundle(out);
    // a policy that allows only served scripts, so bundlers must not inline files as data: URLs
    const headers = { 'content-security-policy': `script-src 'self' 'wasm-unsafe-eval'` };
    const files = { '/mara.glb': { body: avatar, type: TYPES['.glb'] } };
    for (const entry of fs.readdirSync(out, { recursive: true })) {
      const file = path.join(out, entry);
      if (fs.statSync(file).isFile()) files[`/${entry}`] = { body: fs.readFileSync(file), type: TYPES[path.extname(entry)] ?? 'application/octet-stream', headers };
    }
    files['/'] = files['/index.html'];
    const server = await servePages(files);
    const page = await browser.newPage();
    const problems = [];
    page.on('pageerror', (error) => problems.push(String(error)));
    page.on('console', (message) => ['error', 'warning'].includes(message.type()) && /talking-head|Failed|policy/i.test(message.text()) && problems.push(message.text()));
    await page.addInitScript(() => delete window.AudioDecoder); // so that the package's own decoder is loaded
    try {
      await page.goto(server.url);
      await page.waitForFunction(() => window.bundled);
      const seen = await page.evaluate(async (src) => {
        const element = document.createElement('talking-head');
        for (const [key, value] of Object.entries({ src, lang: 'it', quality: 'low', avatar: '/mara.glb' })) element.setAttribute(key, value);
        element.style = 'inline-size: 9rem; block-size: 12rem';
        const errors = [];
        element.addEventListener('error', ({ detail }) => errors.push(`${detail?.code}: ${detail?.message}`));
        const ready = new Promise((resolve) => element.addEventListener('ready', resolve, { once: true }));
        document.querySelector('#app').append(element);
        await ready;
        const end = await element.speak('Uno, due, tre.');
        return { errors, reason: end.reason, sound: element.debug().sound, instead: element.debugParts().player.reason ?? null };
      }, `${daemon.url.replace('http', 'ws')}/v1/stream`);
      assert.deepEqual(seen, { errors: [], reason: 'done', sound: 'on', instead: null }, 'spoken by the worklet, and by nothing in its place');
      for (const file of COMPANIONS) {
        const named = new RegExp(`/${file.replace('.js', '')}(-[^/]+)?\\.js$`); // the name may have a hash
        const places = Object.keys(files).filter((place) => named.test(place));
        assert.ok(places.length, `${file} was not copied`);
        const fetched = () => places.some((place) => server.served.has(place));
        for (let waited = 0; !fetched() && waited < 20000; waited += 100) await sleep(100);
        assert.ok(fetched(), `${file} was not fetched from ${places}`);
      }
      assert.deepEqual(problems, []);
    } finally {
      await page.close();
      await server.close();
    }
  });
